#define _POSIX_C_SOURCE 200809L
#include "bench/gate/figures.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"
#include "bench/data/csv_write.h"
#include "bench/machine/env_build.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

// Counts are exact. Of what is simulated, the same program laid out otherwise has other conflict
// misses: a handful, which weigh where there are few rays.
struct rb_figure_rule rb_figure_rule(int figure)
{
    static const struct rb_figure_rule simulated[] = {
        [RB_FIGURE_INSTRUCTIONS - RB_FIGURE_SIMULATED] = {"instructions", 0.005, 1, 1000},
        [RB_FIGURE_L1_MISSES - RB_FIGURE_SIMULATED] = {"l1_misses", 0.02, 0.01, 64},
        [RB_FIGURE_LL_MISSES - RB_FIGURE_SIMULATED] = {"ll_misses", 0.05, 0.01, 64},
    };
    struct rb_figure_rule exact = {.name = "rays"};
    if (figure >= RB_FIGURE_SIMULATED)
        return simulated[figure - RB_FIGURE_SIMULATED];
    if (figure >= RB_FIGURE_COUNTERS)
        exact.name = figure == RB_FIGURE_STACK_MAX ? "stack_max"
                                                   : rb_counter_names[figure - RB_FIGURE_COUNTERS];
    return exact;
}

static const char *const work_columns[] = {"scene_hash", "image_hash", "hits_hash", "made_by"};

static void put_header(FILE *out)
{
    for (int i = 0; i < RB_KEY_COUNT; i++)
        fprintf(out, "%s,", rb_key_names[i]);
    for (size_t i = 0; i < sizeof work_columns / sizeof *work_columns; i++)
        fprintf(out, "%s,", work_columns[i]);
    for (int i = 0; i < RB_FIGURE_COUNT; i++)
        fprintf(out, "%s%s", rb_figure_rule(i).name, i + 1 < RB_FIGURE_COUNT ? "," : "\n");
}

static void put_cell(FILE *out, const struct rb_cell *cell)
{
    const struct rb_settings *s = &cell->settings;
    rb_csv_put_text(out, cell->reference->scene_name);
    fprintf(out, ",%d,%d,%d,%d,%d,%d,%s,%d,", s->width, s->height, s->depth, s->aa,
            s->light_samples, s->tile, cell->variant->name, s->threads);
}

// Appends those of the flags that decide what code there is: -O, -f, -m, -std and definitions, but
// not those of the Makefile, which say what libraries were found.
static void put_flags(char *text, size_t size)
{
    size_t used = strlen(text);
    for (const char *word = rb_env_flags; *word; word += strspn(word, " ")) {
        size_t length = strcspn(word, " ");
        bool counts = word[0] == '-' && length > 1 && strchr("OfmsD", word[1]);
        if (counts && strncmp(word, "-DRB_", 5) != 0 && used + length + 1 < size)
            used += (size_t)snprintf(text + used, size - used, " %.*s", (int)length, word);
        word += length;
    }
}

// Compiler and flags decide what is simulated, and so do the caches.
static void put_maker(FILE *out, const struct rb_cell *cell)
{
    char simulated[RB_SIMULATED_TEXT], text[1024] = "";
    if (cell->simulated) {
        rb_simulated_describe(cell->simulated, simulated);
        snprintf(text, sizeof text, "%s; %s;", rb_env_compiler, simulated);
        put_flags(text, sizeof text);
    }
    rb_csv_put_text(out, text);
}

static void put_frame(FILE *out, const struct rb_cell *cell)
{
    const struct rb_reference *reference = cell->reference;
    uint64_t hits = cell->simulated ? cell->simulated->hits_hash : reference->hits_hash;
    put_cell(out, cell);
    fprintf(out, "frame,,");
    if (cell->state == RB_CELL_UNAVAILABLE)
        fprintf(out, ",,,");
    else
        fprintf(out, "%016" PRIx64 ",%016" PRIx64 ",%016" PRIx64 ",", reference->scene_hash,
                reference->image_hash, hits);
    put_maker(out, cell);
    for (int i = 0; i < RB_FIGURE_COUNT; i++)
        fputc(',', out);
    fputc('\n', out);
}

// False where it was not counted or simulated.
static bool find_figure(const struct rb_cell *cell, int stage, int bounce, int figure,
                        uint64_t *value)
{
    const struct rb_counts *counts = cell->counted ? &cell->counted->table.at[stage][bounce] : NULL;
    const struct rb_simulated_place *place =
        cell->simulated ? &cell->simulated->place[stage][bounce] : NULL;
    const uint64_t *events = place ? place->events : NULL;
    if (figure == RB_FIGURE_RAYS)
        *value = counts ? cell->counted->sample.stage[stage][bounce].rays : place->rays;
    else if (figure == RB_FIGURE_INSTRUCTIONS && place)
        *value = events[RB_SIM_IR];
    else if (figure == RB_FIGURE_L1_MISSES && place)
        *value = events[RB_SIM_D1MR] + events[RB_SIM_D1MW];
    else if (figure == RB_FIGURE_LL_MISSES && place)
        *value = events[RB_SIM_DLMR] + events[RB_SIM_DLMW] + events[RB_SIM_ILMR];
    else if (figure == RB_FIGURE_STACK_MAX && counts)
        *value = counts->stack_max;
    else if (figure < RB_FIGURE_STACK_MAX && counts)
        *value = counts->of[figure - RB_FIGURE_COUNTERS];
    else
        return false;
    return true;
}

static void put_place(FILE *out, const struct rb_cell *cell, int stage, int bounce)
{
    uint64_t value;
    find_figure(cell, stage, bounce, RB_FIGURE_RAYS, &value);
    if (value == 0)
        return;
    put_cell(out, cell);
    fprintf(out, "%s,%d,,,,", rb_stage_names[stage], bounce);
    for (int i = 0; i < RB_FIGURE_COUNT; i++) {
        fputc(',', out);
        if (find_figure(cell, stage, bounce, i, &value))
            fprintf(out, "%" PRIu64, value);
    }
    fputc('\n', out);
}

static uint64_t hash_bytes(const char *bytes, size_t count)
{
    uint64_t hash = count;
    for (size_t i = 0; i < count; i++)
        hash = rb_hash_word(hash, (unsigned char)bytes[i]);
    return hash;
}

static void put_lines(FILE *out, const struct rb_run *run)
{
    put_header(out);
    for (int i = 0; i < run->unit_count; i++) {
        const struct rb_cell *cell = &run->plan->cells[i];
        bool known = cell->state == RB_CELL_OPEN && (cell->counted || cell->simulated);
        if (known || cell->state == RB_CELL_UNAVAILABLE)
            put_frame(out, cell);
        for (int stage = 0; stage < RB_KERNEL_COUNT && known; stage++)
            for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
                put_place(out, cell, stage, bounce);
    }
}

enum { END_MAX = RB_FIGURES_COLUMNS + 32 };

// The last line, for the lines before it.
static void make_end(const char *lines, size_t size, char end[END_MAX])
{
    char commas[RB_FIGURES_COLUMNS];
    memset(commas, ',', sizeof commas);
    snprintf(end, END_MAX, "%.*send,,%016" PRIx64 "%.*s\n", RB_KEY_KERNEL, commas,
             hash_bytes(lines, size), RB_FIGURES_COLUMNS - 1 - RB_FIGURES_SCENE_HASH, commas);
}

enum rb_status rb_figures_write(const char *path, const struct rb_run *run, struct rb_error *error)
{
    static struct rb_output output;
    char *lines = NULL, end[END_MAX];
    size_t size = 0;
    FILE *out = open_memstream(&lines, &size);
    if (!out)
        return rb_error_memory(error, "the figures");
    put_lines(out, run);
    if (fclose(out) != 0)
        return rb_error_memory(error, "the figures");
    enum rb_status status = rb_output_open(&output, path, error);
    if (!status) {
        fwrite(lines, 1, size, output.stream);
        make_end(lines, size, end);
        fputs(end, output.stream);
        status = rb_output_commit(&output, error);
    }
    free(lines);
    if (!status)
        *error = (struct rb_error){0};
    return status;
}

static bool is_whole(const char *text, size_t size, const struct rb_csv *figures)
{
    char end[END_MAX];
    size_t last = figures->rows[figures->row_count].offset;
    if (last > size)
        return false; // it has changed while it was read
    make_end(text, last, end);
    return size == last + strlen(end) && memcmp(text + last, end, strlen(end)) == 0;
}

static bool has_columns(const struct rb_csv *figures)
{
    bool same = figures->column_count == RB_FIGURES_COLUMNS;
    for (int i = 0; i < RB_KEY_COUNT; i++)
        same = same && rb_csv_column(figures, rb_key_names[i]) == i;
    for (int i = 0; i < RB_FIGURES_FIRST - RB_KEY_COUNT; i++)
        same = same && rb_csv_column(figures, work_columns[i]) == RB_KEY_COUNT + i;
    for (int i = 0; i < RB_FIGURE_COUNT; i++)
        same = same && rb_csv_column(figures, rb_figure_rule(i).name) == RB_FIGURES_FIRST + i;
    return same;
}

enum rb_status rb_figures_load(const char *path, struct rb_csv *figures, struct rb_error *error)
{
    char *text;
    size_t size;
    *figures = (struct rb_csv){0};
    enum rb_status status = rb_file_read(path, &text, &size, error);
    if (status)
        return RB_INVALID; // whatever the reason: there is nothing to go by
    status = rb_csv_load(path, figures, error);
    if (!status && (figures->row_count == 0 || !has_columns(figures)))
        status = rb_error_set(error, RB_INVALID,
                              "not the figures of this version of raybench; renew a baseline with "
                              "make baseline");
    else if (!status && !is_whole(text, size, figures))
        status = rb_error_set(error, RB_INVALID,
                              "cut short or edited: its last line does not fit the others; renew "
                              "a baseline with make baseline");
    rb_free(text);
    if (status) {
        rb_csv_free(figures);
        return status;
    }
    figures->row_count--; // without the end
    *error = (struct rb_error){0};
    return RB_OK;
}
