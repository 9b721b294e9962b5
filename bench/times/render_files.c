#define _POSIX_C_SOURCE 200809L
#include "bench/times/render_files.h"

#include "base/file.h"
#include "base/memory.h"
#include "bench/times/render_report.h"

#include <stdlib.h>
#include <string.h>

#define CSV_NAME      "table1.csv"
#define MARKDOWN_NAME "table1.md"

static void set_file(struct rb_error *error, const char *path)
{
    snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, path);
}

static enum rb_status join(char path[RB_RENDER_FILE_PATH_MAX], const char *folder, const char *name,
                           struct rb_error *error)
{
    int length = snprintf(path, RB_RENDER_FILE_PATH_MAX, "%s/%s", folder, name);
    return length < RB_RENDER_FILE_PATH_MAX
               ? RB_OK
               : rb_error_set(error, RB_INVALID, "the name of the folder is too long");
}

enum rb_status rb_render_files_csv_path(const char *folder, char path[RB_RENDER_FILE_PATH_MAX],
                                        struct rb_error *error)
{
    return join(path, folder, CSV_NAME, error);
}

// The next file of the set, and a stream for its text; NULL without memory.
static FILE *begin(struct rb_render_files *files)
{
    struct rb_render_file *file = &files->files[files->count];
    FILE *out = open_memstream(&file->text, &file->length);
    files->count += out != NULL;
    return out;
}

static enum rb_status end(FILE *out, struct rb_error *error)
{
    bool whole = !ferror(out);
    return fclose(out) == 0 && whole ? RB_OK : rb_error_memory(error, "the render-time table");
}

static enum rb_status make(struct rb_render_files *files, const struct rb_render_table *table,
                           const char *folder, const char *name,
                           void write(FILE *out, const struct rb_render_table *table),
                           struct rb_error *error)
{
    enum rb_status status = join(files->files[files->count].path, folder, name, error);
    if (status)
        return status;
    FILE *out = begin(files);
    if (!out)
        return rb_error_memory(error, "the render-time table");
    write(out, table);
    return end(out, error);
}

static enum rb_status make_readme(struct rb_render_files *files,
                                  const struct rb_render_table *table, const char *path,
                                  struct rb_error *error)
{
    struct rb_render_file *file = &files->files[files->count];
    char *text;
    size_t length;
    if (snprintf(file->path, sizeof file->path, "%s", path) >= (int)sizeof file->path)
        return rb_error_set(error, RB_INVALID, "the name of the README is too long");
    enum rb_status status = rb_file_read(path, &text, &length, error);
    if (status)
        return status;
    FILE *out = begin(files);
    if (!out) {
        rb_free(text);
        return rb_error_memory(error, path);
    }
    status = rb_render_report_readme(out, text, length, table, error);
    if (status)
        set_file(error, path);
    rb_free(text);
    enum rb_status ended = end(out, error);
    return status ? status : ended;
}

enum rb_status rb_render_files_make(struct rb_render_files *files,
                                    const struct rb_render_table *table, const char *folder,
                                    const char *readme, struct rb_error *error)
{
    *files = (struct rb_render_files){0};
    enum rb_status status = make(files, table, folder, CSV_NAME, rb_render_table_write, error);
    if (status == RB_OK)
        status = make(files, table, folder, MARKDOWN_NAME, rb_render_report_markdown, error);
    if (status == RB_OK && readme)
        status = make_readme(files, table, readme, error);
    if (status)
        rb_render_files_free(files);
    return status;
}

void rb_render_files_free(struct rb_render_files *files)
{
    for (int i = 0; i < files->count; i++)
        free(files->files[i].text); // of open_memstream
    files->count = 0;
}

enum rb_status rb_render_files_save(const struct rb_render_files *files, struct rb_error *error)
{
    for (int i = 0; i < files->count; i++) {
        const struct rb_render_file *file = &files->files[i];
        struct rb_output output;
        enum rb_status status = rb_output_open(&output, file->path, error);
        if (status)
            return status;
        fwrite(file->text, 1, file->length, output.stream);
        status = rb_output_commit(&output, error);
        if (status)
            return status;
    }
    return RB_OK;
}

enum rb_status rb_render_files_probe(const struct rb_render_files *files, struct rb_error *error)
{
    for (int i = 0; i < files->count; i++) {
        struct rb_output output;
        enum rb_status status = rb_output_open(&output, files->files[i].path, error);
        if (status)
            return status;
        rb_output_discard(&output);
    }
    return RB_OK;
}

// Line of the first byte in which the texts differ; 0 if they are the same.
static unsigned long first_difference(const char *a, size_t a_length, const char *b,
                                      size_t b_length)
{
    unsigned long line = 1;
    size_t length = a_length < b_length ? a_length : b_length;
    for (size_t i = 0; i < length; i++) {
        if (a[i] != b[i])
            return line;
        line += a[i] == '\n';
    }
    return a_length == b_length ? 0 : line;
}

enum rb_status rb_render_files_check(const struct rb_render_files *files, struct rb_error *error)
{
    for (int i = 0; i < files->count; i++) {
        const struct rb_render_file *file = &files->files[i];
        char *text;
        size_t length;
        enum rb_status status = rb_file_read(file->path, &text, &length, error);
        if (status)
            return status;
        error->line = first_difference(file->text, file->length, text, length);
        error->column = 1;
        rb_free(text);
        if (error->line) {
            set_file(error, file->path);
            return rb_error_set(error, RB_INVALID,
                                "not what %s makes of it: stale, or edited; run make table",
                                i ? files->files[0].path : "raybench");
        }
    }
    return RB_OK;
}
