#include "bench/history/log.h"

#include "base/file.h"
#include "bench/compare/compare_print.h"
#include "bench/compare/process_times.h"
#include "bench/data/json.h"
#include "bench/data/json_read.h"
#include "bench/data/stats.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SCHEMA_VERSION = 1, KEY_TEXT_MAX = 256 };

static enum rb_status refuse(struct rb_error *error, const char *what)
{
    error->column = 1;
    return rb_error_set(error, RB_INVALID, "%s: not a line of a history of this version", what);
}

// The name of a course from the members of the line.
static bool read_course(const char *line, struct rb_log_entry *entry)
{
    char keys[RB_KEY_CELL][KEY_TEXT_MAX], label[RB_CELL_LABEL_MAX], host[128], cpu[128];
    struct rb_timed_cell cell = {.image_hash = ""};
    bool whole = true;
    for (int i = 0; i < RB_KEY_CELL; i++) {
        whole &= rb_json_get_text(rb_json_find(line, rb_key_names[i]), keys[i], sizeof keys[i]);
        cell.key[i] = keys[i];
    }
    whole &= rb_json_get_text(rb_json_find(line, "host"), host, sizeof host);
    whole &= rb_json_get_text(rb_json_find(line, "cpu_model"), cpu, sizeof cpu);
    rb_compare_label(&cell, 0, label);
    snprintf(entry->course, sizeof entry->course, "%.400s, %s, on %.100s, %.100s", label,
             entry->kernel, host, cpu);
    snprintf(entry->scene, sizeof entry->scene, "%s", keys[RB_KEY_SCENE]);
    snprintf(entry->variant, sizeof entry->variant, "%.63s", keys[RB_KEY_VARIANT]);
    return whole;
}

static enum rb_status read_line(const char *line, struct rb_log_entry *entry,
                                struct rb_error *error)
{
    enum rb_status status = rb_json_check(line, error);
    if (status)
        return status;
    if (rb_json_get_number(rb_json_find(line, "schema_version")) != SCHEMA_VERSION)
        return refuse(error, "schema_version");
    bool whole =
        rb_json_get_text(rb_json_find(line, "kernel"), entry->kernel, sizeof entry->kernel) &&
        rb_json_get_text(rb_json_find(line, "session"), entry->session, sizeof entry->session) &&
        read_course(line, entry);
    rb_json_get_text(rb_json_find(line, "commit"), entry->commit, sizeof entry->commit);
    entry->ms = rb_json_get_number(rb_json_find(line, "ms"));
    entry->low = rb_json_get_number(rb_json_find(line, "ms_lo"));
    entry->high = rb_json_get_number(rb_json_find(line, "ms_hi"));
    return whole && entry->ms > 0 && isfinite(entry->ms) ? RB_OK : refuse(error, "a member");
}

static int compare(const void *a, const void *b)
{
    const struct rb_log_entry *x = a, *y = b;
    int by = strcmp(x->course, y->course);
    return by ? by : (x->order > y->order) - (x->order < y->order);
}

enum rb_status rb_log_read(const char *path, struct rb_array *entries, struct rb_error *error)
{
    char *text = NULL;
    size_t size = 0;
    if (access(path, F_OK) != 0)
        return RB_OK;
    enum rb_status status = rb_file_read(path, &text, &size, error);
    if (!status && strlen(text) != size)
        status = rb_error_set(error, RB_INVALID, "NUL byte: this is no text file");
    unsigned long number = 0;
    for (char *line = text, *next; !status && *line; line = next) {
        struct rb_log_entry entry = {.order = number};
        char *end = strchr(line, '\n');
        next = end ? end + 1 : line + strlen(line);
        if (end)
            *end = '\0';
        status = read_line(line, &entry, error);
        error->line = ++number;
        if (!status && !rb_array_push(entries, &entry, sizeof entry))
            status = rb_error_memory(error, "the history");
    }
    rb_free(text);
    if (status)
        return status;
    *error = (struct rb_error){0};
    if (entries->count)
        qsort(entries->data, entries->count, sizeof(struct rb_log_entry), compare);
    return RB_OK;
}

// What env.json tells about a run.
struct run {
    char session[128], commit[64], host[128], cpu[128];
    struct rb_timings timings;
    struct rb_process_times times;
};

static enum rb_status load_run(const char *folder, struct run *run, struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX], *text;
    snprintf(path, sizeof path, "%s/env.json", folder);
    enum rb_status status = rb_json_load(path, &text, error);
    if (status)
        return status;
    rb_json_get_text(rb_json_find(text, "session"), run->session, sizeof run->session);
    rb_json_get_text(rb_json_find(text, "git.commit"), run->commit, sizeof run->commit);
    rb_json_get_text(rb_json_find(text, "host.name"), run->host, sizeof run->host);
    rb_json_get_text(rb_json_find(text, "host.cpu_model"), run->cpu, sizeof run->cpu);
    rb_free(text);
    if (!run->session[0])
        return rb_error_set(error, RB_INVALID, "no session: not the env.json of a run");
    status = rb_timings_load(folder, &run->timings, error);
    if (!status && run->timings.unfinished)
        return rb_error_set(error, RB_INVALID,
                            "the run has not ended; see raybench bench --resume");
    if (!status && !rb_process_times_make(&run->times, run->timings.count, run->timings.count))
        status = rb_error_memory(error, "the history");
    return status;
}

static void put_line(FILE *out, const struct run *run, const struct rb_timed_cell *cell, int kernel,
                     const struct rb_median *ms, size_t processes)
{
    struct rb_json json = {.out = out, .line = true};
    rb_json_object(&json, NULL);
    rb_json_integer(&json, "schema_version", SCHEMA_VERSION);
    rb_json_string(&json, "session", run->session);
    rb_json_string(&json, "commit", run->commit[0] ? run->commit : NULL);
    rb_json_string(&json, "host", run->host);
    rb_json_string(&json, "cpu_model", run->cpu);
    for (int i = 0; i < RB_KEY_CELL; i++)
        rb_json_string(&json, rb_key_names[i], cell->key[i]);
    rb_json_string(&json, "kernel", rb_timed_kernels[kernel].name);
    rb_json_number(&json, "ms", ms->value);
    rb_json_number(&json, "ms_lo", ms->low);
    rb_json_number(&json, "ms_hi", ms->high);
    rb_json_integer(&json, "processes", (int64_t)processes);
    rb_json_string(&json, "image_hash", cell->image_hash);
    rb_json_end_object(&json);
}

static void put_run(FILE *out, struct run *run)
{
    for (size_t cell = 0; cell < run->timings.cell_count; cell++)
        for (int kernel = 0; kernel < RB_TIMED_KERNELS; kernel++) {
            struct rb_timing_range range =
                rb_timings_find(&run->timings, cell, kernel, RB_ALL_BOUNCES);
            if (!rb_timed_kernels[kernel].usual || !range.count)
                continue;
            rb_process_times_fill(&run->times, range, range, 0.5, true);
            size_t count = run->times.counts[0];
            struct rb_median ns = rb_stats_median_at(run->times.times[0], count, 0.95);
            ns = (struct rb_median){ns.value * 1e-6, ns.low * 1e-6, ns.high * 1e-6, ns.level};
            if (ns.value > 0)
                put_line(out, run, &run->timings.cells[cell], kernel, &ns, count);
        }
}

static bool has_session(const struct rb_array *entries, const char *session)
{
    const struct rb_log_entry *known = entries->data;
    for (size_t i = 0; i < entries->count; i++)
        if (strcmp(known[i].session, session) == 0)
            return true;
    return false;
}

enum rb_status rb_log_append(const char *path, const struct rb_array *entries, const char *folder,
                             bool *added, struct rb_error *error)
{
    static const struct run nothing;
    struct run run = nothing;
    *added = false;
    enum rb_status status = load_run(folder, &run, error);
    if (!status && !has_session(entries, run.session)) {
        FILE *out = fopen(path, "a");
        if (out)
            put_run(out, &run);
        *error = (struct rb_error){0};
        snprintf(error->file, sizeof error->file, "%.255s", path);
        *added = out && fflush(out) == 0 && !ferror(out);
        if (!*added)
            status = rb_error_set(error, RB_FAILED, "cannot write: %s", strerror(errno));
        if (out)
            fclose(out);
    }
    rb_process_times_free(&run.times);
    rb_timings_free(&run.timings);
    return status;
}
