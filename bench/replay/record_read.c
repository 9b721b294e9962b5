#define _POSIX_C_SOURCE 200809L
#include "bench/replay/record_format.h"

#include <errno.h>
#include <string.h>

struct reader {
    FILE *stream;
    const struct rb_record_choice *choice; // NULL: none, and check everything
    struct rb_record *record;
    char *buffer;
    struct rb_error *error;
};

// Fills `bytes`. The end of the file is an error, too.
static enum rb_status take(struct reader *reader, void *bytes, size_t size)
{
    if (fread(bytes, 1, size, reader->stream) == size)
        return RB_OK;
    if (ferror(reader->stream))
        return rb_error_set(reader->error, RB_FAILED, "cannot read: %s", strerror(errno));
    return rb_error_set(reader->error, RB_INVALID, "the record is cut short; record it again");
}

static enum rb_status damaged(struct reader *reader)
{
    return rb_error_set(reader->error, RB_INVALID, "the record is damaged; record it again");
}

static enum rb_status read_header(struct reader *reader)
{
    unsigned char bytes[RB_RECORD_HEADER_BYTES];
    uint32_t version, size;
    struct rb_record_header *header = &reader->record->header;
    size_t start = fread(bytes, 1, 16, reader->stream);
    if (start < 16 || memcmp(bytes, rb_record_magic, sizeof rb_record_magic) != 0)
        return ferror(reader->stream)
                   ? rb_error_set(reader->error, RB_FAILED, "cannot read: %s", strerror(errno))
                   : rb_error_set(reader->error, RB_INVALID,
                                  "not a file of rays, such as raybench record writes");
    memcpy(&version, bytes + 8, sizeof version);
    memcpy(&size, bytes + 12, sizeof size);
    if (version != RB_RECORD_VERSION)
        return rb_error_set(reader->error, RB_INVALID,
                            "version %lu of the format; this program reads version %d: "
                            "record it again",
                            (unsigned long)version, RB_RECORD_VERSION);
    enum rb_status status = take(reader, bytes + 16, sizeof bytes - 16);
    if (status)
        return status;
    if (size != sizeof bytes || !rb_record_header_fields(bytes, false, header) ||
        !memchr(header->scene, 0, sizeof header->scene) ||
        !memchr(header->row, 0, sizeof header->row) || strcmp(header->scene, "-") == 0)
        return damaged(reader); // standard input is never recorded, and must not be waited for
    return RB_OK;
}

static bool is_chosen(const struct rb_record_choice *choice, const struct rb_record_chunk *chunk)
{
    if (!choice || chunk->ray_class != choice->ray_class ||
        (choice->bounce >= 0 && chunk->bounce != (uint32_t)choice->bounce))
        return false;
    if (choice->kernel == RB_STAGE_GENERATE && chunk->bounce != 0)
        return false;
    if (choice->kernel == RB_STAGE_SHADE)
        return true;
    return chunk->kind ==
           (choice->kernel == RB_STAGE_TRACE_SHADOW ? RB_BATCH_SHADOWS : RB_BATCH_RAYS);
}

// The bytes of the buffer become a batch.
static enum rb_status keep(struct reader *reader, const struct rb_record_chunk *chunk)
{
    struct rb_batch batch;
    enum rb_status status =
        rb_batch_alloc(&batch, (enum rb_batch_kind)chunk->kind, chunk->count, reader->error);
    if (status)
        return status;
    batch.bounce = (int)chunk->bounce;
    batch.span = chunk->span;
    rb_record_pack(&batch, reader->buffer, false);
    if (rb_array_push(&reader->record->batches, &batch, sizeof batch))
        return RB_OK;
    rb_batch_free(&batch);
    return rb_error_memory(reader->error, "the rays");
}

static enum rb_status read_batch(struct reader *reader, const struct rb_record_chunk *chunk)
{
    if (chunk->kind >= RB_BATCH_KIND_COUNT || chunk->ray_class >= RB_CLASS_COUNT ||
        chunk->bounce >= RB_BOUNCE_MAX || chunk->count > RB_RECORD_COUNT_MAX)
        return damaged(reader);
    size_t size = chunk->count * rb_record_ray_bytes((enum rb_batch_kind)chunk->kind);
    bool chosen = is_chosen(reader->choice, chunk);
    rb_record_count(&reader->record->contents, chunk);
    if (reader->choice && !chosen && fseeko(reader->stream, (off_t)size, SEEK_CUR) == 0)
        return RB_OK; // beyond the end, the next chunk is missing; in a pipe, it is read
    enum rb_status status = take(reader, reader->buffer, size);
    if (status == RB_OK && rb_record_checksum(size, reader->buffer, size) != chunk->checksum)
        status = damaged(reader);
    return status == RB_OK && chosen ? keep(reader, chunk) : status;
}

static enum rb_status read_end(struct reader *reader, const struct rb_record_chunk *chunk)
{
    struct rb_record_contents *contents = &reader->record->contents;
    uint64_t end[3];
    enum rb_status status = take(reader, end, sizeof end);
    if (status)
        return status;
    if (rb_record_checksum(sizeof end, end, sizeof end) != chunk->checksum ||
        end[0] != contents->chunks || getc(reader->stream) != EOF)
        return damaged(reader);
    contents->image_hash = end[1];
    contents->hits_hash = end[2];
    return RB_OK;
}

static enum rb_status read_all(struct reader *reader)
{
    unsigned char bytes[RB_RECORD_CHUNK_BYTES];
    struct rb_record_chunk chunk = {.kind = 0};
    reader->buffer = rb_alloc(RB_RECORD_COUNT_MAX, rb_record_ray_bytes(RB_BATCH_RAYS));
    if (!reader->buffer)
        return rb_error_memory(reader->error, "the record");
    enum rb_status status = read_header(reader);
    while (status == RB_OK) {
        status = take(reader, bytes, sizeof bytes);
        if (status)
            break;
        if (!rb_record_chunk_fields(bytes, false, reader->record->contents.chunks, &chunk))
            return damaged(reader);
        if (chunk.kind == RB_RECORD_END)
            return read_end(reader, &chunk);
        status = read_batch(reader, &chunk);
    }
    return status;
}

enum rb_status rb_record_read(const char *path, const struct rb_record_choice *choice,
                              struct rb_record *record, struct rb_error *error)
{
    struct reader reader = {.choice = choice, .record = record, .error = error};
    *record = (struct rb_record){.batches = {0}};
    snprintf(error->file, sizeof error->file, "%.255s", path);
    if (!rb_record_machine_fits())
        return rb_error_set(error, RB_FAILED, "files of rays need a little-endian machine");
    reader.stream = fopen(path, "rb");
    if (!reader.stream)
        return rb_error_set(error, RB_INVALID, "cannot open: %s", strerror(errno));
    enum rb_status status = read_all(&reader);
    fclose(reader.stream);
    rb_free(reader.buffer);
    if (status)
        rb_record_free(record);
    return status;
}

void rb_record_free(struct rb_record *record)
{
    struct rb_batch *batches = record->batches.data;
    for (size_t i = 0; i < record->batches.count; i++)
        rb_batch_free(&batches[i]);
    rb_array_release(&record->batches);
}
