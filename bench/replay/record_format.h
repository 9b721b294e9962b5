// The bytes of files of recorded rays, each structure in one function for both ways, so that
// readers and writers cannot disagree. Private to record_read.c and record_write.c.
#ifndef RB_REPLAY_RECORD_FORMAT_H
#define RB_REPLAY_RECORD_FORMAT_H

#include "bench/replay/record_file.h"
#include "render/queues.h"

#include <stdbool.h>

enum { RB_RECORD_HEADER_BYTES = 384, RB_RECORD_CHUNK_BYTES = 56, RB_RECORD_END_BYTES = 24 };

// The kind of the last chunk, after those of batches.
enum { RB_RECORD_END = RB_BATCH_KIND_COUNT };

// No batch is larger.
enum { RB_RECORD_COUNT_MAX = RB_SHADOW_BATCHES * RB_BATCH_MAX };

extern const char rb_record_magic[8];

struct rb_record_chunk {
    uint32_t kind, ray_class, bounce, count;
    struct rb_span span;
    uint64_t checksum; // of the arrays
};

bool rb_record_machine_fits(void); // its byte order

uint64_t rb_record_checksum(uint64_t hash, const void *bytes, size_t count);

// To bytes or from them. The checksum at the end is written; or false if it is wrong. The first 16
// bytes of the header are left alone.
bool rb_record_header_fields(unsigned char bytes[RB_RECORD_HEADER_BYTES], bool writing,
                             struct rb_record_header *header);
bool rb_record_chunk_fields(unsigned char bytes[RB_RECORD_CHUNK_BYTES], bool writing,
                            uint64_t number, struct rb_record_chunk *chunk);

// Counts a batch among the contents.
void rb_record_count(struct rb_record_contents *contents, const struct rb_record_chunk *chunk);

// Bytes that a ray takes in the arrays of a batch.
size_t rb_record_ray_bytes(enum rb_batch_kind kind);

// The arrays of a batch to `buffer` or from it.
void rb_record_pack(struct rb_batch *batch, char *buffer, bool writing);

#endif
