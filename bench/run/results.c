#include "bench/run/results.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>

struct rb_line rb_results_line(const struct rb_cell *cell, enum rb_stage stage, int bounce)
{
    const struct rb_sample *frame = &cell->reference->frame;
    bool own = cell->sample_count && !cell->group_tiles;
    const struct rb_sample_stage *counts =
        own ? &cell->samples[0].stage[stage][bounce] : &frame->stage[stage][bounce];
    struct rb_line line = {.cell = cell, .stage = stage, .bounce = bounce, .counts = counts};
    line.kernel = rb_stage_names[stage];
    line.per_ray = rb_cell_ns_per_ray(cell, stage, bounce);
    line.share = rb_cell_share(cell, stage, bounce);
    line.ns = line.share * rb_cell_busy_ns(cell);
    line.wall_ns = line.share * rb_cell_frame_ns(cell).value;
    return line;
}

typedef void emit_fn(void *user, const struct rb_column *columns, const struct rb_line *line);

static const struct rb_figure no_figure = {
    (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, 0, 0,
};

static void emit_whole(const struct rb_results *results, const struct rb_cell *cell,
                       const char *kernel, double ns, double share, emit_fn *emit, void *user)
{
    const struct rb_line line = {
        .cell = cell,
        .partial = results->partial,
        .probe_ns = results->probe_ns,
        .kernel = kernel,
        .bounce = -1,
        .per_ray = no_figure,
        .ns = ns,
        .share = share,
        .wall_ns = (double)NAN,
    };
    emit(user, rb_kernel_columns, &line);
}

// The kernels at every bounce that has rays, then what has none. Without a time, the rows are there
// with empty times.
static void emit_kernels(const struct rb_results *results, const struct rb_cell *cell,
                         emit_fn *emit, void *user)
{
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            if (cell->reference->frame.stage[stage][bounce].rays == 0)
                continue;
            struct rb_line line = rb_results_line(cell, (enum rb_stage)stage, bounce);
            line.partial = results->partial;
            line.probe_ns = results->probe_ns;
            emit(user, rb_kernel_columns, &line);
        }
    if (!rb_cell_has_time(cell))
        return;
    for (int stage = RB_KERNEL_COUNT; stage < RB_STAGE_COUNT; stage++) {
        double share = rb_cell_share(cell, (enum rb_stage)stage, -1);
        emit_whole(results, cell, rb_stage_names[stage], share * rb_cell_busy_ns(cell), share, emit,
                   user);
    }
    if (cell->variant->accelerator != RB_ACCEL_NONE)
        emit_whole(results, cell, "build", rb_cell_build_ns(cell).value, (double)NAN, emit, user);
    emit_whole(results, cell, "frame", rb_cell_frame_ns(cell).value, (double)NAN, emit, user);
}

static void emit_frame(const struct rb_results *results, const struct rb_cell *cell, emit_fn *emit,
                       void *user)
{
    const struct rb_line line = {
        .cell = cell,
        .partial = results->partial,
        .probe_ns = results->probe_ns,
        .per_ray = rb_cell_frame_ns(cell),
    };
    emit(user, rb_frame_columns, &line);
}

typedef void emit_cell_fn(const struct rb_results *results, const struct rb_cell *cell,
                          emit_fn *emit, void *user);

static void emit_cells(const struct rb_results *results, emit_cell_fn *emit_cell, emit_fn *emit,
                       void *user)
{
    for (int i = 0; i < results->plan->cell_count; i++) {
        const struct rb_cell *cell = &results->plan->cells[i];
        if (cell->side == results->side && cell->reference->made_by)
            emit_cell(results, cell, emit, user);
    }
}

static void to_csv(void *user, const struct rb_column *columns, const struct rb_line *line)
{
    rb_columns_csv_row(user, columns, line);
}

static void to_json(void *user, const struct rb_column *columns, const struct rb_line *line)
{
    rb_columns_json_row(user, columns, line);
}

static void write_kernels(FILE *out, const struct rb_results *results)
{
    rb_columns_csv_header(out, rb_kernel_columns);
    emit_cells(results, emit_kernels, to_csv, out);
}

static void write_frames(FILE *out, const struct rb_results *results)
{
    rb_columns_csv_header(out, rb_frame_columns);
    emit_cells(results, emit_frame, to_csv, out);
}

static void write_env(FILE *out, const struct rb_results *results)
{
    rb_env_write(out, &results->env);
}

static void write_json(FILE *out, const struct rb_results *results)
{
    struct rb_json json = {.out = out};
    rb_json_object(&json, NULL);
    rb_json_integer(&json, "schema_version", RB_SCHEMA_VERSION);
    rb_json_string(&json, "session", results->env.session);
    rb_json_bool(&json, "complete", !results->partial);
    rb_json_string(&json, "command_line", results->env.command_line);
    rb_json_string(&json, "plan", results->plan->text);
    rb_json_number(&json, "probe_ns", results->probe_ns);
    rb_json_array(&json, "references");
    for (int i = 0; i < results->plan->reference_count; i++) {
        const struct rb_reference *reference = &results->plan->references[i];
        rb_json_object(&json, NULL);
        rb_json_string(&json, "scene", reference->scene_name);
        rb_json_hash(&json, "scene_hash", reference->scene_hash);
        rb_json_string(&json, "made_by", reference->made_by);
        rb_json_bool(&json, "cached", reference->cached);
        rb_json_end_object(&json);
    }
    rb_json_end_array(&json);
    rb_json_array(&json, "frames");
    emit_cells(results, emit_frame, to_json, &json);
    rb_json_end_array(&json);
    rb_json_array(&json, "kernels");
    emit_cells(results, emit_kernels, to_json, &json);
    rb_json_end_array(&json);
    rb_json_end_object(&json);
}

enum rb_status rb_results_write(const struct rb_results *results, struct rb_error *error)
{
    static const struct {
        const char *name;
        void (*write)(FILE *out, const struct rb_results *results);
    } files[] = {
        {"kernels.csv", write_kernels},
        {"frame.csv", write_frames},
        {"env.json", write_env},
        {"result.json", write_json},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[RB_OUTPUT_PATH_MAX];
        struct rb_output output;
        snprintf(path, sizeof path, "%s/%s", results->folder, files[i].name);
        enum rb_status status = rb_output_open(&output, path, error);
        if (status)
            return status;
        files[i].write(output.stream, results);
        status = rb_output_commit(&output, error);
        if (status)
            return status;
    }
    return RB_OK;
}
