#include "bench/run/samples_file.h"

#include "bench/data/csv_read.h"
#include "bench/run/columns.h"

#include <math.h>
#include <string.h>

// A line is about a stage at a bounce, a stage without rays over all bounces, or the frame.
static bool is_frame(const struct rb_line *line)
{
    return line->counts == NULL;
}

static struct rb_value process(const struct rb_line *line)
{
    return rb_integer(line->sample->process);
}

static struct rb_value repetition(const struct rb_line *line)
{
    return rb_integer(line->sample->repetition);
}

static struct rb_value kernel(const struct rb_line *line)
{
    return rb_text(line->kernel);
}

static struct rb_value bounce(const struct rb_line *line)
{
    return line->bounce >= 0 ? rb_integer(line->bounce) : rb_none();
}

static struct rb_value rays(const struct rb_line *line)
{
    return rb_integer(
        (int64_t)(is_frame(line) ? rb_sample_rays(line->sample) : line->counts->rays));
}

static struct rb_value ns(const struct rb_line *line)
{
    if (!rb_sample_has_stages(line->sample))
        return rb_none();
    return rb_integer(
        (int64_t)(is_frame(line) ? rb_sample_busy_ns(line->sample) : line->counts->ns));
}

static struct rb_value calls(const struct rb_line *line)
{
    return is_frame(line) ? rb_none() : rb_integer((int64_t)line->counts->calls);
}

// The other columns are the frame's alone.
#define FRAME_COLUMN(name, value)                                                                  \
    static struct rb_value name(const struct rb_line *line)                                        \
    {                                                                                              \
        return is_frame(line) ? (value) : rb_none();                                               \
    }
FRAME_COLUMN(wall_ns, rb_integer((int64_t)line->sample->wall_ns))
FRAME_COLUMN(busy_max_ns, rb_sample_has_stages(line->sample)
                              ? rb_integer((int64_t)line->sample->busy_max_ns)
                              : rb_none())
FRAME_COLUMN(build_ns, rb_integer((int64_t)line->sample->build_ns))
FRAME_COLUMN(peak_memory_bytes, rb_integer((int64_t)line->sample->peak_bytes))
FRAME_COLUMN(tree_bytes, rb_integer((int64_t)line->sample->tree_bytes))
FRAME_COLUMN(cpu, line->sample->cpu < 0 ? rb_none() : rb_integer(line->sample->cpu))
FRAME_COLUMN(context_switches, rb_integer(line->sample->context_switches))
FRAME_COLUMN(migrations,
             line->sample->migrations < 0 ? rb_none() : rb_integer(line->sample->migrations))
FRAME_COLUMN(steal_ms, rb_number(line->sample->steal_ms))
FRAME_COLUMN(image_hash, rb_hash(line->sample->image_hash))
FRAME_COLUMN(hits_hash, rb_hash(line->sample->hits_hash))
FRAME_COLUMN(steady, line->sample->steady < 0 ? rb_none() : rb_integer(line->sample->steady))

const struct rb_column rb_sample_columns[] = {
    RB_KEY_COLUMNS,
    {"process", process},
    {"repetition", repetition},
    {"kernel", kernel},
    {"bounce", bounce},
    {"rays", rays},
    {"ns", ns},
    {"wall_ns", wall_ns},
    {"busy_max_ns", busy_max_ns},
    {"build_ns", build_ns},
    {"peak_memory_bytes", peak_memory_bytes},
    {"tree_bytes", tree_bytes},
    {"cpu", cpu},
    {"context_switches", context_switches},
    {"migrations", migrations},
    {"steal_ms", steal_ms},
    {"image_hash", image_hash},
    {"hits_hash", hits_hash},
    {"calls", calls},
    {"steady", steady},
    {.name = NULL},
};

static void write_stage(FILE *out, struct rb_line *line, enum rb_stage stage)
{
    line->kernel = rb_stage_names[stage];
    struct rb_sample_stage all = {0};
    for (int b = 0; b < RB_BOUNCE_MAX; b++) {
        const struct rb_sample_stage *counts = &line->sample->stage[stage][b];
        all.ns += counts->ns;
        all.calls += counts->calls;
        line->bounce = b;
        line->counts = counts;
        if (stage < RB_KERNEL_COUNT && counts->rays)
            rb_columns_csv_row(out, rb_sample_columns, line);
    }
    line->bounce = -1;
    line->counts = &all;
    if (stage >= RB_KERNEL_COUNT)
        rb_columns_csv_row(out, rb_sample_columns, line);
    line->counts = NULL;
}

void rb_samples_write(FILE *out, const struct rb_cell *cell, const struct rb_sample *sample)
{
    struct rb_line line = {.cell = cell, .sample = sample};
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        write_stage(out, &line, (enum rb_stage)stage);
    line.kernel = "frame";
    line.bounce = -1;
    rb_columns_csv_row(out, rb_sample_columns, &line);
}

// Columns by position, as the file has all of ours in our order, or is refused.
enum { KEY_COLUMNS = 9, PROCESS = KEY_COLUMNS, REPETITION, KERNEL, BOUNCE, RAYS, NS, WALL_NS };
enum { BUSY_MAX_NS = WALL_NS + 1, BUILD_NS, PEAK, TREE, CPU, SWITCHES, MIGRATIONS, STEAL, IMAGE };
enum { HITS = IMAGE + 1, CALLS, STEADY };

static enum rb_status check_columns(const struct rb_csv *csv, struct rb_error *error)
{
    for (int c = 0; rb_sample_columns[c].name; c++)
        if (rb_csv_column(csv, rb_sample_columns[c].name) != c) {
            snprintf(error->file, sizeof error->file, "%.255s", csv->path);
            return rb_error_set(error, RB_INVALID, "column %s is not where this version has it",
                                rb_sample_columns[c].name);
        }
    return RB_OK;
}

static uint64_t word(const struct rb_csv *csv, size_t row, int column, int base)
{
    uint64_t value = 0;
    rb_csv_word(csv, row, column, &value, base);
    return value;
}

// Does the row's key say what the columns of the cell say?
static bool is_of(const struct rb_csv *csv, size_t row, const struct rb_cell *cell)
{
    const struct rb_line line = {.cell = cell};
    for (int c = 0; c < KEY_COLUMNS; c++) {
        struct rb_value value = rb_sample_columns[c].of(&line);
        bool same = value.kind == RB_VALUE_TEXT ? strcmp(rb_csv_text(csv, row, c), value.text) == 0
                                                : word(csv, row, c, 10) == (uint64_t)value.integer;
        if (!same)
            return false;
    }
    return true;
}

static struct rb_cell *find_cell(const struct rb_csv *csv, size_t row, struct rb_plan *plan,
                                 int side, struct rb_cell *last)
{
    if (last && is_of(csv, row, last))
        return last;
    for (int i = 0; i < plan->cell_count; i++)
        if (plan->cells[i].side == side && is_of(csv, row, &plan->cells[i]))
            return &plan->cells[i];
    return NULL;
}

static void read_stage(const struct rb_csv *csv, size_t row, struct rb_sample *sample)
{
    uint64_t b = word(csv, row, BOUNCE, 10);
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        if (strcmp(rb_csv_text(csv, row, KERNEL), rb_stage_names[stage]) == 0 && b < RB_BOUNCE_MAX)
            sample->stage[stage][b] = (struct rb_sample_stage){
                word(csv, row, NS, 10), word(csv, row, RAYS, 10), word(csv, row, CALLS, 10)};
}

static void read_frame(const struct rb_csv *csv, size_t row, const struct rb_cell *cell,
                       struct rb_sample *sample)
{
    sample->magic = RB_SAMPLE_MAGIC;
    sample->process = (uint32_t)word(csv, row, PROCESS, 10);
    sample->repetition = (uint32_t)word(csv, row, REPETITION, 10);
    sample->threads = cell->settings.threads;
    sample->cpu = *rb_csv_text(csv, row, CPU) ? (int)word(csv, row, CPU, 10) : -1;
    sample->wall_ns = word(csv, row, WALL_NS, 10);
    sample->busy_max_ns = word(csv, row, BUSY_MAX_NS, 10);
    sample->build_ns = word(csv, row, BUILD_NS, 10);
    sample->peak_bytes = word(csv, row, PEAK, 10);
    sample->tree_bytes = word(csv, row, TREE, 10);
    sample->context_switches = (int64_t)word(csv, row, SWITCHES, 10);
    sample->migrations =
        *rb_csv_text(csv, row, MIGRATIONS) ? (int64_t)word(csv, row, MIGRATIONS, 10) : -1;
    sample->steal_ms = rb_csv_number(csv, row, STEAL);
    sample->image_hash = word(csv, row, IMAGE, 16);
    sample->hits_hash = word(csv, row, HITS, 16);
    sample->steady = *rb_csv_text(csv, row, STEADY) ? word(csv, row, STEADY, 10) != 0 : -1;
}

static enum rb_status read_rows(const struct rb_csv *csv, struct rb_plan *plan, int side,
                                struct rb_error *error)
{
    static struct rb_sample sample; // too large for the stack
    struct rb_cell *cell = NULL;
    sample = (struct rb_sample){0};
    for (size_t row = 0; row < csv->row_count; row++) {
        cell = find_cell(csv, row, plan, side, cell);
        if (!cell) {
            rb_csv_place(csv, row, 0, error);
            return rb_error_set(error, RB_INVALID, "the plan has no such cell");
        }
        if (strcmp(rb_csv_text(csv, row, KERNEL), "frame") != 0) {
            read_stage(csv, row, &sample);
            continue;
        }
        read_frame(csv, row, cell, &sample);
        if (!rb_cell_add(cell, &sample))
            return rb_error_memory(error, "the samples");
        cell->process_count = sample.process + 1;
        sample = (struct rb_sample){0};
    }
    return RB_OK;
}

enum rb_status rb_samples_read(const char *path, struct rb_plan *plan, int side,
                               struct rb_error *error)
{
    struct rb_csv csv;
    bool dropped;
    enum rb_status status = rb_csv_load_partial(path, &csv, &dropped, error);
    if (status)
        return status;
    if (csv.column_count > 0)
        status = check_columns(&csv, error);
    if (status == RB_OK)
        status = read_rows(&csv, plan, side, error);
    rb_csv_free(&csv);
    return status;
}
