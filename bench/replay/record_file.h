// Files of recorded rays: what the kernels got and gave in one frame, batch by batch.
//
// Version 1, little-endian, nothing aligned. Machines of the other byte order are refused.
//
//   header    384 bytes
//     0  char[8] "RBRAYS\r\n"      8  u32 version       12  u32 bytes of the header
//    16  u64 hash of the scene    24  u32 width, height, depth, aa, light_samples, tile, phong, spd
//    56  f64 light_size, light_scale, ambient           80  u64 seed
//    88  char[32] row that has recorded    120  char[256] scene, as raybench takes it; padded by 0
//   376  u64 checksum of the bytes before
//   chunk     56 bytes, and arrays
//     0  u32 kind: 0 rays, 1 shadow rays, 2 end         4  u32 class (enum rb_ray_class)
//     8  u32 bounce               12  u32 count of rays
//    16  u32 x0, y0, x1, y1, sample: the span of the image that the batch serves
//    36  u32 0                    40  u64 checksum of the arrays
//    48  u64 checksum of the bytes before, begun with the number of the chunk in the file
//    rays:        f32 ox oy oz dx dy dz weight, u32 pixel path self, u64 media (of struct rb_rays),
//                 then their hits: f32 t u v, u32 prim
//    shadow rays: f32 ox oy oz dx dy dz r g b distance, u32 pixel self, u8 occluded
//    end:         count 1; u64 chunks before it, hash of the image, hash of the hits, as
//                 `raybench render --hash` prints them. Nothing follows.
//   One array of `count` elements after the other. Chunks of the image come as struct rb_observer
//   says: shadow rays follow the rays they start from. Those of other classes come in between.
//
// A checksum folds 64-bit words with rb_hash_word, beginning with the number of bytes (or what is
// said above), the last word padded by 0. It finds damage, not forgery: whoever uses batches has to
// check them (render/replay.h).
#ifndef RB_REPLAY_RECORD_FILE_H
#define RB_REPLAY_RECORD_FILE_H

#include "base/file.h"
#include "base/memory.h"
#include "measure/probe.h"
#include "render/batch.h"
#include "render/settings.h"

enum { RB_RECORD_VERSION = 1, RB_RECORD_SCENE_MAX = 256, RB_RECORD_ROW_MAX = 32 };

// Where rays come from: the image itself, or every primary hit (bench/replay/classes.h).
enum rb_ray_class {
    RB_CLASS_IMAGE,
    RB_CLASS_DIFFUSE,
    RB_CLASS_REFLECTION,
    RB_CLASS_REFRACTION,
    RB_CLASS_SHADOW,
    RB_CLASS_COUNT
};
extern const char *const rb_ray_class_names[RB_CLASS_COUNT];

struct rb_record_header {
    char scene[RB_RECORD_SCENE_MAX];
    char row[RB_RECORD_ROW_MAX];
    uint64_t scene_hash;
    struct rb_settings settings; // complete, but for threads: 0
};

// What is in a file.
struct rb_record_contents {
    struct {
        uint64_t batches, rays;
    } of[RB_CLASS_COUNT][RB_BATCH_KIND_COUNT][RB_BOUNCE_MAX];
    uint64_t chunks, image_hash, hits_hash;
};

// Writing. Not thread-safe.
struct rb_record_writer {
    struct rb_output output;
    struct rb_record_contents contents;
    char *buffer; // of a batch
};

// RB_FAILED if the file cannot be opened, or without memory; nothing is left to discard then.
enum rb_status rb_record_create(struct rb_record_writer *writer, const char *path,
                                const struct rb_record_header *header, struct rb_error *error);

// Appends a batch. Errors of the disk show when the file is finished.
void rb_record_put(struct rb_record_writer *writer, enum rb_ray_class ray_class,
                   const struct rb_batch *batch);

// The file then has its name; on RB_FAILED, or after rb_record_discard, there is none.
enum rb_status rb_record_finish(struct rb_record_writer *writer, uint64_t image_hash,
                                uint64_t hits_hash, struct rb_error *error);
void rb_record_discard(struct rb_record_writer *writer);

// Which batches to keep: those of a class and a kernel (shade wants rays and shadow rays), at one
// bounce or, if it is -1, at all.
struct rb_record_choice {
    enum rb_ray_class ray_class;
    enum rb_stage kernel;
    int bounce;
};

// A file read: all it says about itself, and the batches chosen, in the order of the file.
// Zero-initialise; release with rb_record_free, also after a failure.
struct rb_record {
    struct rb_record_header header;
    struct rb_record_contents contents;
    struct rb_array batches; // of struct rb_batch
};

// Reads a file. With `choice` NULL no batch is kept, but everything is read and its checksum held
// against it; else what is not chosen is skipped. Memory: the batches kept. RB_INVALID for what
// cannot be opened or is not such a file, whole and undamaged; RB_FAILED if reading fails or memory
// is short.
enum rb_status rb_record_read(const char *path, const struct rb_record_choice *choice,
                              struct rb_record *record, struct rb_error *error);
void rb_record_free(struct rb_record *record);

#endif
