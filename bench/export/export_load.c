// From the files of a result folder to series: the lines that have a time, each with its samples.
#define _XOPEN_SOURCE 700
#include "bench/export/export_load.h"

#include "base/file.h"
#include "bench/data/json_read.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum rb_status rb_export_columns(const struct rb_csv *csv, const char *const *names, size_t count,
                                 int *columns, struct rb_error *error)
{
    for (size_t i = 0; i < count; i++) {
        columns[i] = rb_csv_column(csv, names[i]);
        if (columns[i] >= 0)
            continue;
        *error = (struct rb_error){.line = 1, .column = 1};
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, csv->path);
        return rb_error_set(error, RB_INVALID, "there is no column '%s'", names[i]);
    }
    return RB_OK;
}

bool rb_export_has_flag(const char *flags, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = flags; *at; at += strspn(at, ";")) {
        size_t here = strcspn(at, ";");
        if (here == length && memcmp(at, word, length) == 0)
            return true;
        at += here;
    }
    return false;
}

enum rb_status rb_export_check_key(const struct rb_csv *csv, size_t row, const int *columns,
                                   size_t count, struct rb_error *error)
{
    for (size_t i = RB_KEY_WIDTH; i < count; i++) {
        uint64_t value;
        const char *text = rb_csv_text(csv, row, columns[i]);
        bool word = i == RB_KEY_VARIANT || i == RB_KEY_KERNEL;
        if (word ? text[0] : (i == RB_KEY_BOUNCE && !text[0]))
            continue;
        if (!word && rb_csv_word(csv, row, columns[i], &value, 10) && value <= INT32_MAX)
            continue;
        rb_csv_place(csv, row, columns[i], error);
        return rb_error_set(error, RB_INVALID, "%s: expected %s", rb_key_names[i],
                            word ? "a name" : "a whole number");
    }
    return RB_OK;
}

bool rb_export_omit(struct rb_export *result, const struct rb_export_series *series,
                    const char *why)
{
    struct rb_export_omission *last = result->omissions.data;
    if (result->omissions.count) {
        last += result->omissions.count - 1;
        bool same = strcmp(last->why, why) == 0;
        for (int i = 0; same && i < RB_KEY_CELL; i++)
            same = strcmp(last->key[i], series->key[i]) == 0;
        last->count += same;
        if (same)
            return true;
    }
    struct rb_export_omission omission = {.why = why, .count = 1};
    memcpy(omission.key, series->key, sizeof omission.key);
    return rb_array_push(&result->omissions, &omission, sizeof omission);
}

// Why a line is left out; NULL if it is not.
static const char *why_not(const struct rb_csv *csv, size_t row,
                           const struct rb_export_table *table)
{
    const char *note = rb_csv_text(csv, row, table->remark[1]);
    if (rb_export_has_flag(rb_csv_text(csv, row, table->remark[0]), "invalid"))
        return note[0] ? note : "invalid";
    for (size_t i = 0; i < table->time_count; i++)
        if (rb_csv_number(csv, row, table->time[i]) >= 0)
            return NULL;
    return note[0] ? note : "no time";
}

// Lines of kernels.csv or frame.csv become series or omissions.
static enum rb_status take_rows(struct rb_export *result, const struct rb_csv *csv,
                                const struct rb_export_table *table, struct rb_error *error)
{
    for (size_t row = 0; row < csv->row_count; row++) {
        struct rb_export_series series = {.row = row};
        for (size_t i = 0; i < RB_KEY_COUNT; i++)
            series.key[i] = rb_csv_text(csv, row, i < table->key_count ? table->key[i] : -1);
        if (table->key_count == RB_KEY_CELL)
            series.key[RB_KEY_KERNEL] = "frame";
        const char *why = why_not(csv, row, table);
        if (why ? !rb_export_omit(result, &series, why)
                : !rb_array_push(&result->series, &series, sizeof series))
            return rb_error_memory(error, "the results");
        if (!why && rb_export_check_key(csv, row, table->key, table->key_count, error))
            return RB_INVALID;
    }
    return RB_OK;
}

static enum rb_status find_table(const struct rb_csv *csv, const char *const *times,
                                 size_t key_count, struct rb_export_table *table,
                                 struct rb_error *error)
{
    static const char *const remarks[] = {"flags", "note"};
    table->key_count = key_count;
    table->time_count = times[1] ? 2 : 1;
    if (rb_export_columns(csv, rb_key_names, key_count, table->key, error) ||
        rb_export_columns(csv, times, table->time_count, table->time, error) ||
        rb_export_columns(csv, remarks, 2, table->remark, error))
        return RB_INVALID;
    return RB_OK;
}

// A file that must be there in a result folder.
static enum rb_status load_csv(const char *folder, const char *name, struct rb_csv *csv,
                               struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    enum rb_status status = rb_csv_load(path, csv, error);
    if (status == RB_FAILED && access(path, F_OK) != 0)
        return rb_error_set(error, RB_INVALID, "missing, so this is no result of raybench bench");
    return status;
}

static enum rb_status load_samples(const char *folder, struct rb_export *result,
                                   struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX], part[RB_OUTPUT_PATH_MAX];
    snprintf(path, sizeof path, "%s/samples.csv", folder);
    snprintf(part, sizeof part, "%s/samples.csv.part", folder);
    result->unfinished = access(path, F_OK) != 0 && access(part, F_OK) == 0;
    bool dropped;
    enum rb_status status = result->unfinished
                                ? rb_csv_load_partial(part, &result->samples, &dropped, error)
                                : load_csv(folder, "samples.csv", &result->samples, error);
    return status ? status : rb_export_take_samples(result, error);
}

static enum rb_status load_env(const char *folder, struct rb_export *result, struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX];
    snprintf(path, sizeof path, "%s/env.json", folder);
    return access(path, F_OK) == 0 ? rb_json_load(path, &result->env, error) : RB_OK;
}

// 20261123T102031Z-... -> 2026-11-23T10:20:31Z
static void read_stamp(const char *folder, char stamp[32])
{
    static const char shape[] = "ddddddddTddddddZ-";
    char *real = realpath(folder, NULL);
    const char *name = real ? strrchr(real, '/') : NULL;
    name = name ? name + 1 : "";
    size_t i = 0;
    while (shape[i] && (shape[i] == 'd' ? isdigit((unsigned char)name[i]) : name[i] == shape[i]))
        i++;
    stamp[0] = '\0';
    if (!shape[i])
        snprintf(stamp, 32, "%.4s-%.2s-%.2sT%.2s:%.2s:%.2sZ", name, name + 4, name + 6, name + 9,
                 name + 11, name + 13);
    free(real);
}

static enum rb_status load(const char *folder, bool wants_samples, struct rb_export *result,
                           struct rb_error *error)
{
    static const char *const kernel_times[] = {"ns_per_ray", "ns_per_pixel"};
    static const char *const frame_times[] = {"frame_ms", NULL};
    struct rb_export_table table;
    struct stat info;
    snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, folder);
    if (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
        return rb_error_set(error, RB_INVALID, "there is no such folder of results");
    read_stamp(folder, result->stamp);
    enum rb_status status = load_csv(folder, "kernels.csv", &result->kernels, error);
    if (status == RB_OK)
        status = load_env(folder, result, error);
    if (status)
        return status;
    status = find_table(&result->kernels, kernel_times, RB_KEY_COUNT, &table, error);
    if (wants_samples) {
        status = status ? status : take_rows(result, &result->kernels, &table, error);
        return status ? status : load_samples(folder, result, error);
    }
    if (status == RB_OK)
        status = load_csv(folder, "frame.csv", &result->frames, error);
    if (status == RB_OK)
        status = find_table(&result->frames, frame_times, RB_KEY_CELL, &table, error);
    return status ? status : take_rows(result, &result->frames, &table, error);
}

enum rb_status rb_export_load(const char *folder, bool wants_samples, struct rb_export *result,
                              struct rb_error *error)
{
    *result = (struct rb_export){0};
    *error = (struct rb_error){0};
    enum rb_status status = load(folder, wants_samples, result, error);
    if (status)
        rb_export_free(result);
    return status;
}

void rb_export_free(struct rb_export *result)
{
    rb_csv_free(&result->kernels);
    rb_csv_free(&result->frames);
    rb_csv_free(&result->samples);
    rb_array_release(&result->series);
    rb_array_release(&result->omissions);
    rb_array_release(&result->pool);
    rb_free(result->scratch);
    rb_free(result->env);
    *result = (struct rb_export){0};
}
