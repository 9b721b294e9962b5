#include "bench/replay/record_format.h"

#include <string.h>

enum rb_status rb_record_create(struct rb_record_writer *writer, const char *path,
                                const struct rb_record_header *header, struct rb_error *error)
{
    unsigned char bytes[RB_RECORD_HEADER_BYTES] = {0};
    struct rb_record_header copy = *header;
    uint32_t version = RB_RECORD_VERSION, size = sizeof bytes;
    *writer = (struct rb_record_writer){.buffer = NULL};
    if (!rb_record_machine_fits())
        return rb_error_set(error, RB_FAILED, "files of rays need a little-endian machine");
    memcpy(bytes, rb_record_magic, sizeof rb_record_magic);
    memcpy(bytes + 8, &version, sizeof version);
    memcpy(bytes + 12, &size, sizeof size);
    rb_record_header_fields(bytes, true, &copy);
    writer->buffer = rb_alloc(RB_RECORD_COUNT_MAX, rb_record_ray_bytes(RB_BATCH_RAYS));
    if (!writer->buffer)
        return rb_error_memory(error, "the record");
    enum rb_status status = rb_output_open(&writer->output, path, error);
    if (status == RB_OK)
        fwrite(bytes, 1, sizeof bytes, writer->output.stream);
    else
        rb_record_discard(writer);
    return status;
}

// Writes the chunk with `size` bytes of the buffer as its arrays.
static void put_chunk(struct rb_record_writer *writer, struct rb_record_chunk *chunk, size_t size)
{
    unsigned char bytes[RB_RECORD_CHUNK_BYTES];
    chunk->checksum = rb_record_checksum(size, writer->buffer, size);
    rb_record_chunk_fields(bytes, true, writer->contents.chunks, chunk);
    fwrite(bytes, 1, sizeof bytes, writer->output.stream);
    fwrite(writer->buffer, 1, size, writer->output.stream);
}

void rb_record_put(struct rb_record_writer *writer, enum rb_ray_class ray_class,
                   const struct rb_batch *batch)
{
    struct rb_batch copy = *batch;
    struct rb_record_chunk chunk = {
        .kind = batch->kind,
        .ray_class = ray_class,
        .bounce = (uint32_t)batch->bounce,
        .count = rb_batch_count(batch),
        .span = batch->span,
    };
    rb_record_pack(&copy, writer->buffer, true);
    put_chunk(writer, &chunk, chunk.count * rb_record_ray_bytes(batch->kind));
    rb_record_count(&writer->contents, &chunk);
}

enum rb_status rb_record_finish(struct rb_record_writer *writer, uint64_t image_hash,
                                uint64_t hits_hash, struct rb_error *error)
{
    struct rb_record_chunk chunk = {.kind = RB_RECORD_END, .count = 1};
    const uint64_t end[3] = {writer->contents.chunks, image_hash, hits_hash};
    memcpy(writer->buffer, end, sizeof end);
    put_chunk(writer, &chunk, sizeof end);
    enum rb_status status = rb_output_commit(&writer->output, error);
    rb_record_discard(writer);
    return status;
}

void rb_record_discard(struct rb_record_writer *writer)
{
    rb_output_discard(&writer->output);
    rb_free(writer->buffer);
    writer->buffer = NULL;
}
