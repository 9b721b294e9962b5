// `raybench export`: loads a result folder and hands it to one of the formats.
#define _POSIX_C_SOURCE 200809L
#include "bench/export/export.h"

#include "base/file.h"
#include "cli/commands.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--format", "google-benchmark|benchfmt|hyperfine|scaling|markdown", RB_OPTION_TEXT,
     offsetof(struct rb_arguments, bench.format), 0, 0, "default: markdown"},
    {"-o", "FILE", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "file to write; default: standard output"},
    {.name = NULL},
};

const struct rb_command rb_command_export = {
    .name = "export",
    .summary = "write a result for other tools, or as tables",
    .synopsis = "RESULT [options]",
    .text =
        "RESULT is a folder that raybench bench made, such as results/latest.\n\n"
        "  google-benchmark  JSON that Google Benchmark's compare.py reads\n"
        "  benchfmt          Go's benchmark format, which benchstat reads\n"
        "  hyperfine         JSON as of hyperfine --export-json: the times of whole frames\n"
        "  scaling           how time per ray grows with the primitives of generated scenes:\n"
        "                    ns for ten times as many, power of the number, R^2 of either line\n"
        "  markdown          tables to read: frames, then time per ray by kernel and bounce\n\n"
        "Every process that measured counts as one sample, the median of its repetitions; in\n"
        "hyperfine's format every frame does. Kernels with a bounce are given per ray, all else\n"
        "per frame. What has no time is left out, and said so on standard error.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

static const struct rb_export_format formats[] = {
    {"markdown", false, rb_export_markdown}, {"google-benchmark", true, rb_export_google},
    {"benchfmt", true, rb_export_benchfmt},  {"hyperfine", true, rb_export_hyperfine},
    {"scaling", false, rb_export_scaling},
};

static const struct rb_export_format *find_format(const char *name)
{
    if (!name)
        return &formats[0];
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strcmp(formats[i].name, name) == 0)
            return &formats[i];
    return NULL;
}

static void put_escaped(FILE *out, const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        fprintf(out, isalnum(*c) || strchr("+-._", *c) ? "%c" : "%%%02X", *c);
}

void rb_export_put_name(FILE *out, const char *const key[RB_KEY_COUNT], char colon)
{
    static const char *const usual[RB_KEY_COUNT] = {
        [RB_KEY_DEPTH] = "5",
        [RB_KEY_AA] = "1",
        [RB_KEY_LIGHT_SAMPLES] = "1",
        [RB_KEY_TILE] = "64",
    };
    static const char *const names[RB_KEY_COUNT] = {
        [RB_KEY_SCENE] = "scene",     [RB_KEY_DEPTH] = "depth",
        [RB_KEY_AA] = "aa",           [RB_KEY_LIGHT_SAMPLES] = "light_samples",
        [RB_KEY_TILE] = "tile",       [RB_KEY_VARIANT] = "variant",
        [RB_KEY_THREADS] = "threads", [RB_KEY_BOUNCE] = "bounce",
    };
    bool square = strcmp(key[RB_KEY_WIDTH], "512") == 0 && strcmp(key[RB_KEY_HEIGHT], "512") == 0;
    for (int i = 0; i < RB_KEY_COUNT; i++) {
        if (i == RB_KEY_WIDTH && !square)
            fprintf(out, "/size%c%sx%s", colon, key[RB_KEY_WIDTH], key[RB_KEY_HEIGHT]);
        if (!names[i] || !key[i][0] || (usual[i] && strcmp(key[i], usual[i]) == 0))
            continue;
        fprintf(out, "/%s%c", names[i], colon);
        put_escaped(out, key[i]);
    }
}

char *rb_export_name(const char *const key[RB_KEY_COUNT], const char *suffix)
{
    char *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    if (!stream)
        return NULL;
    fputs(key[RB_KEY_KERNEL], stream);
    rb_export_put_name(stream, key, ':');
    fputs(suffix, stream);
    bool whole = !ferror(stream);
    if (fclose(stream) == 0 && whole)
        return text;
    free(text);
    return NULL;
}

// What the numbers lack goes to standard error, a line for each cell.
static void tell_omissions(const struct rb_export *result)
{
    if (result->unfinished)
        fprintf(stderr, "raybench: the run is not finished: what it has measured so far\n");
    const struct rb_export_omission *omission = result->omissions.data;
    for (size_t i = 0; i < result->omissions.count; i++, omission++) {
        fprintf(stderr, "raybench: left out: %s", omission->key[RB_KEY_KERNEL]);
        rb_export_put_name(stderr, omission->key, ':');
        if (omission->count > 1)
            fprintf(stderr, " and %zu more", omission->count - 1);
        fprintf(stderr, ": %s\n", omission->why);
    }
}

static enum rb_status write_file(const struct rb_export *result,
                                 const struct rb_export_format *format, const char *path,
                                 struct rb_error *error)
{
    struct rb_output output;
    *error = (struct rb_error){0};
    if (result->series.count == 0)
        return rb_error_set(error, RB_INVALID, "nothing in this result has a time");
    enum rb_status status = rb_output_open(&output, path, error);
    if (status)
        return status;
    status = format->write(result, output.stream, error);
    if (status == RB_OK)
        return rb_output_commit(&output, error);
    rb_output_discard(&output);
    return status;
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_error error = {0};
    struct rb_export result;
    const struct rb_export_format *format = find_format(arguments->bench.format);
    if (!format) {
        rb_error_set(&error, RB_INVALID, "there is no format '%s' (see raybench export --help)",
                     arguments->bench.format);
        return rb_report(RB_INVALID, &error);
    }
    enum rb_status status =
        rb_export_load(arguments->positional[0], format->wants_samples, &result, &error);
    if (status)
        return rb_report(status, &error);
    tell_omissions(&result);
    status = write_file(&result, format, arguments->output ? arguments->output : "-", &error);
    rb_export_free(&result);
    return status ? rb_report(status, &error) : 0;
}
