// Files of recorded rays: what is written is read, and whatever is damaged is refused.
#define _XOPEN_SOURCE 700
#include "bench/replay/record.h"
#include "base/hash.h"
#include "base/memory.h"
#include "tests/unit/tap.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/raybench-record-XXXXXX";

// Small enough for every byte to be tried: 16 pixels, three bounces.
static int record(const char *file, const char *classes)
{
    struct rb_arguments arguments = {
        .positional = {"mount2"},
        .positional_count = 1,
        .settings = {.width = 5, .height = 3, .depth = 3, .aa = 2, .ambient = 0.25, .seed = 9},
        .output = file,
        .quiet = true,
        .bench = {.classes = classes},
    };
    return rb_command_record.run(&arguments);
}

static enum rb_status read_all(struct rb_record *record, struct rb_error *error)
{
    *error = (struct rb_error){0};
    return rb_record_read(path, NULL, record, error);
}

static void check_header(const struct rb_record *record)
{
    const struct rb_settings *s = &record->header.settings;
    ok(strcmp(record->header.scene, "mount2") == 0 && strcmp(record->header.row, "bvh") == 0,
       "scene and row are kept");
    ok(s->width == 5 && s->height == 3 && s->depth == 3 && s->aa == 2 && s->light_samples == 1 &&
           s->tile == 64 && s->seed == 9 && s->ambient > 0.24 && s->light_scale > 0 && !s->phong,
       "so are the settings, complete");
    ok(record->contents.image_hash && record->contents.hits_hash && record->header.scene_hash,
       "and the hashes");
}

// Reads one choice and counts it against the contents.
static void check_choice(enum rb_ray_class ray_class, enum rb_stage kernel, int bounce, bool rays,
                         bool shadows)
{
    const struct rb_record_choice choice = {ray_class, kernel, bounce};
    struct rb_record record;
    struct rb_error error = {0};
    uint64_t found = 0, expected = 0;
    bool kinds = true;
    ok(rb_record_read(path, &choice, &record, &error) == RB_OK, "%s %s %d: read",
       rb_ray_class_names[ray_class], rb_stage_names[kernel], bounce);
    for (int b = 0; b < RB_BOUNCE_MAX; b++)
        if (bounce < 0 || b == bounce) {
            expected += rays ? record.contents.of[ray_class][RB_BATCH_RAYS][b].rays : 0;
            expected += shadows ? record.contents.of[ray_class][RB_BATCH_SHADOWS][b].rays : 0;
        }
    for (size_t i = 0; i < record.batches.count; i++) {
        const struct rb_batch *batch = &((struct rb_batch *)record.batches.data)[i];
        found += rb_batch_count(batch);
        kinds = kinds && (batch->kind == RB_BATCH_RAYS ? rays : shadows) &&
                (bounce < 0 || batch->bounce == bounce);
    }
    ok(found == expected && found && kinds, "these batches and no others");
    rb_record_free(&record);
}

// Every shorter file, and one that is longer, is refused in words.
static void check_truncation(long size)
{
    struct rb_record record;
    struct rb_error error;
    FILE *file = fopen(path, "ab");
    fputc(0, file);
    fclose(file);
    ok(read_all(&record, &error) == RB_INVALID && strstr(error.text, "damaged"),
       "a byte too many: %s", error.text);
    long accepted = 0, silent = 0;
    for (long length = size - 1; length >= 0; length--) {
        if (truncate(path, length) != 0)
            break;
        accepted += read_all(&record, &error) != RB_INVALID;
        silent += strlen(error.text) < 10;
    }
    ok(accepted == 0, "cut anywhere, it is refused (%ld not)", accepted);
    ok(silent == 0, "and says why: %s", error.text);
}

// Every byte changed. Where only some batches are read, damage to others may go unnoticed.
static void check_flips(long size)
{
    const struct rb_record_choice choice = {RB_CLASS_IMAGE, RB_STAGE_SHADE, 1};
    struct rb_record record;
    struct rb_error error = {0};
    FILE *file = fopen(path, "r+b");
    long accepted = 0, wrong = 0, noticed = 0;
    for (long at = 0; at < size; at++) {
        fseek(file, at, SEEK_SET);
        int byte = getc(file);
        fseek(file, at, SEEK_SET);
        putc(byte ^ 1 << at % 8, file);
        fflush(file);
        accepted += read_all(&record, &error) != RB_INVALID;
        enum rb_status status = rb_record_read(path, &choice, &record, &error);
        wrong += status == RB_FAILED;
        noticed += status == RB_INVALID;
        rb_record_free(&record);
        fseek(file, at, SEEK_SET);
        putc(byte, file);
        fflush(file);
    }
    fclose(file);
    ok(accepted == 0, "no changed bit is overlooked (%ld of %ld were)", accepted, size);
    ok(wrong == 0 && noticed > 0 && noticed < size, "nor one in what is read of it, %ld", noticed);
}

// Chunks may not change places.
static void check_order(void)
{
    struct rb_record record;
    struct rb_error error;
    char *text;
    size_t size;
    rb_file_read(path, &text, &size, &error);
    // Two batches of one pixel each: equal in size.
    struct rb_record_header header = {.scene = "a", .row = "b"};
    struct rb_record_writer writer;
    struct rb_batch batch;
    ok(rb_record_create(&writer, path, &header, &error) == RB_OK &&
           rb_batch_alloc(&batch, RB_BATCH_SHADOWS, 3, &error) == RB_OK,
       "a record by hand");
    rb_record_put(&writer, RB_CLASS_IMAGE, &batch);
    batch.shadows.distance[1] = 2;
    rb_record_put(&writer, RB_CLASS_IMAGE, &batch);
    ok(rb_record_finish(&writer, 1, 2, &error) == RB_OK && read_all(&record, &error) == RB_OK,
       "can be read");
    rb_record_free(&record);
    rb_batch_free(&batch);
    char *made;
    size_t made_size, chunk = 56 + 3 * 49;
    rb_file_read(path, &made, &made_size, &error);
    FILE *file = fopen(path, "wb");
    fwrite(made, 1, 384, file);
    fwrite(made + 384 + chunk, 1, chunk, file);
    fwrite(made + 384, 1, chunk, file);
    fwrite(made + 384 + 2 * chunk, 1, made_size - 384 - 2 * chunk, file);
    fclose(file);
    ok(made_size == 384 + 2 * chunk + 56 + 24, "sizes are those of the description");
    ok(read_all(&record, &error) == RB_INVALID, "but not with two batches exchanged");
    rb_free(made);
    file = fopen(path, "wb");
    fwrite(text, 1, size, file);
    fclose(file);
    rb_free(text);
}

static void check_mistakes(void)
{
    struct rb_record record;
    struct rb_error error;
    FILE *file = fopen(path, "r+b");
    fseek(file, 8, SEEK_SET);
    putc(99, file);
    fclose(file);
    ok(read_all(&record, &error) == RB_INVALID && strstr(error.text, "version 99"),
       "another version: %s", error.text);
    file = fopen(path, "wb");
    fputs("v\nfrom 1 2 3\nat 0 0 0\n", file);
    fclose(file);
    ok(read_all(&record, &error) == RB_INVALID && strstr(error.text, "not a file of rays"),
       "another kind of file: %s", error.text);
    const struct rb_record_header header = {.scene = "-", .row = "bvh"};
    struct rb_record_writer writer;
    ok(rb_record_create(&writer, path, &header, &error) == RB_OK &&
           rb_record_finish(&writer, 0, 0, &error) == RB_OK &&
           read_all(&record, &error) == RB_INVALID,
       "a scene from standard input: %s", error.text);
    error = (struct rb_error){0};
    ok(rb_record_read("/", NULL, &record, &error) == RB_FAILED, "a folder: %s", error.text);
    ok(rb_record_read("/none/such", NULL, &record, &error) == RB_INVALID, "nothing: %s",
       error.text);
}

// Each allocation failing in turn, while reading and while recording.
static void check_memory(void)
{
    const struct rb_record_choice choice = {RB_CLASS_IMAGE, RB_STAGE_SHADE, -1};
    struct rb_record record;
    struct rb_error error = {0};
    long live = rb_memory_live_count(), n = 1;
    bool clean = true;
    enum rb_status status = RB_FAILED;
    for (; status != RB_OK && n < 1000; n++) {
        rb_memory_fail_at(n);
        status = rb_record_read(path, &choice, &record, &error);
        rb_memory_fail_at(0);
        clean = clean && (status == RB_OK || (status == RB_FAILED && strstr(error.text, "memory")));
        rb_record_free(&record);
        clean = clean && rb_memory_live_count() == live;
    }
    ok(clean && n > 4 && status == RB_OK, "without memory it fails and leaves none behind, %ld", n);
}

int main(void)
{
    struct rb_record record_read;
    struct rb_error error;
    int descriptor = mkstemp(path);
    close(descriptor);
    ok(record(path, "all") == 0, "a record is made");
    ok(read_all(&record_read, &error) == RB_OK, "and read: %s", error.text);
    check_header(&record_read);
    rb_record_free(&record_read);
    FILE *file = fopen(path, "rb");
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    fclose(file);
    note("%ld bytes", size);
    check_choice(RB_CLASS_IMAGE, RB_STAGE_GENERATE, 0, true, false);
    check_choice(RB_CLASS_IMAGE, RB_STAGE_TRACE, -1, true, false);
    check_choice(RB_CLASS_IMAGE, RB_STAGE_TRACE, 1, true, false);
    check_choice(RB_CLASS_IMAGE, RB_STAGE_SHADE, 1, true, true);
    check_choice(RB_CLASS_IMAGE, RB_STAGE_TRACE_SHADOW, 0, false, true);
    check_choice(RB_CLASS_DIFFUSE, RB_STAGE_TRACE, 1, true, false);
    check_choice(RB_CLASS_SHADOW, RB_STAGE_TRACE_SHADOW, 0, false, true);
    check_memory();
    check_order();
    check_flips(size);
    check_truncation(size);
    ok(record(path, "all") == 0, "recorded again");
    check_mistakes();
    unlink(path);
    return done();
}
