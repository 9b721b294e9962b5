#include "bench/compare/comparison.h"

#include "base/memory.h"
#include "bench/compare/process_times.h"
#include "bench/data/names.h"
#include "kernels/kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_keys(const void *a, const void *b)
{
    return rb_cell_compare(*(const struct rb_timed_cell *const *)a,
                           *(const struct rb_timed_cell *const *)b, 0);
}

// The cells of one side that are asked for, in order.
static enum rb_status select_cells(const struct rb_compare_side *side, const char *scenes,
                                   struct rb_array *selected, struct rb_error *error)
{
    for (size_t i = 0; i < side->samples->cell_count; i++) {
        const struct rb_timed_cell *cell = &side->samples->cells[i];
        if (!rb_names_match(scenes, cell->key[RB_KEY_SCENE]) ||
            (side->variant && strcmp(side->variant, cell->key[RB_KEY_VARIANT]) != 0))
            continue;
        if (!rb_array_push(selected, &cell, sizeof cell))
            return rb_error_memory(error, "the comparison");
    }
    if (selected->count)
        qsort(selected->data, selected->count, sizeof(struct rb_timed_cell *), compare_keys);
    return RB_OK;
}

static bool same_image(const struct rb_timed_cell *a, const struct rb_timed_cell *b)
{
    return !a->images_differ && !b->images_differ &&
           (!a->image_hash[0] || !b->image_hash[0] || strcmp(a->image_hash, b->image_hash) == 0);
}

// Cells that both sides have become pairs; the others are listed by side.
static enum rb_status match_cells(const struct rb_array selected[2], unsigned skip,
                                  struct rb_array *pairs, struct rb_array only[2],
                                  struct rb_error *error)
{
    const struct rb_timed_cell *const *a = selected[0].data, *const *b = selected[1].data;
    bool pushed = true;
    for (size_t i = 0, j = 0; pushed && (i < selected[0].count || j < selected[1].count);) {
        int by = i == selected[0].count   ? 1
                 : j == selected[1].count ? -1
                                          : rb_cell_compare(a[i], b[j], skip);
        if (by == 0) {
            struct rb_compare_cell pair = {a[i], b[j], same_image(a[i], b[j]), 0, 0};
            pushed = rb_array_push(pairs, &pair, sizeof pair);
        } else {
            pushed = rb_array_push(&only[by > 0], by < 0 ? &a[i] : &b[j], sizeof *a);
        }
        i += by <= 0;
        j += by >= 0;
    }
    return pushed ? RB_OK : rb_error_memory(error, "the comparison");
}

static enum rb_verdict judge(const struct rb_median *ratio)
{
    if (isnan(ratio->low))
        return RB_VERDICT_TOO_FEW;
    if (ratio->low > 1)
        return RB_VERDICT_SLOWER;
    return ratio->high < 1 ? RB_VERDICT_FASTER : RB_VERDICT_UNRESOLVED;
}

// The times of a row go to `work`; returns whether both sides have any.
static bool row_times(const struct rb_compare_side sides[2], const struct rb_compare_cell *cell,
                      const struct rb_compare_options *options, const struct rb_compare_row *row,
                      struct rb_process_times *work)
{
    double quantile = options->quantile > 0 ? options->quantile : RB_TIME_QUANTILE;
    const struct rb_timings *a = sides[0].samples, *b = sides[1].samples;
    size_t a_cell = (size_t)(cell->a - a->cells), b_cell = (size_t)(cell->b - b->cells);
    rb_process_times_fill(work, rb_timings_find(a, a_cell, row->kernel, row->bounce),
                          rb_timings_find(b, b_cell, row->kernel, row->bounce), quantile,
                          options->paired);
    return work->counts[0] && work->counts[1];
}

static void estimate(const struct rb_process_times *work, bool paired, double level,
                     struct rb_compare_row *row)
{
    double *a = work->times[0], *b = work->times[1];
    row->a_count = work->counts[0];
    row->b_count = work->counts[1];
    row->ratio = paired ? rb_stats_paired_ratio(a, b, row->a_count, level)
                        : rb_stats_independent_ratio(a, row->a_count, b, row->b_count, level);
    row->verdict = judge(&row->ratio);
    row->a_ns = rb_stats_quantile(a, row->a_count, 0.5);
    row->b_ns = rb_stats_quantile(b, row->b_count, 0.5);
}

static bool wants_kernel(const struct rb_compare_options *options, int kernel)
{
    const struct rb_timed_kernel *k = &rb_timed_kernels[kernel];
    return options->kernels ? rb_names_match(options->kernels, k->name) : k->usual;
}

// Adds the rows of a cell for which both sides have times, not yet estimated.
static bool list_rows(const struct rb_compare_side sides[2],
                      const struct rb_compare_options *options, struct rb_process_times *work,
                      struct rb_compare_cell *cell, struct rb_array *rows)
{
    bool pushed = true;
    cell->first_row = rows->count;
    for (int kernel = 0; kernel < RB_TIMED_KERNELS && cell->same_image; kernel++) {
        bool bounces = options->bounces && rb_timed_kernels[kernel].has_bounces;
        for (int bounce = RB_ALL_BOUNCES; bounce < (bounces ? RB_DEPTH_MAX : 0); bounce++) {
            struct rb_compare_row row = {.kernel = kernel, .bounce = bounce};
            if (wants_kernel(options, kernel) && row_times(sides, cell, options, &row, work))
                pushed &= rb_array_push(rows, &row, sizeof row);
        }
    }
    cell->row_count = rows->count - cell->first_row;
    return pushed;
}

static struct rb_compare_family family(const struct rb_comparison *comparison, bool bounces,
                                       const struct rb_compare_options *options)
{
    struct rb_compare_family family = {0};
    for (size_t i = 0; i < comparison->row_count; i++)
        family.rows += (comparison->rows[i].bounce != RB_ALL_BOUNCES) == bounces;
    family.level = rb_stats_family_level(options->level, family.rows);
    family.needed = rb_stats_median_count(options->paired ? family.level : sqrt(family.level));
    return family;
}

// The level depends on how many rows there are, so all are listed before the first is estimated.
static enum rb_status make_rows(const struct rb_compare_side sides[2],
                                const struct rb_compare_options *options,
                                struct rb_comparison *comparison, struct rb_error *error)
{
    struct rb_process_times work;
    struct rb_array rows = {0};
    bool enough = rb_process_times_make(&work, sides[0].samples->count, sides[1].samples->count);
    for (size_t i = 0; enough && i < comparison->cell_count; i++)
        enough = list_rows(sides, options, &work, &comparison->cells[i], &rows);
    comparison->rows = rows.data;
    comparison->row_count = rows.count;
    comparison->kernels = family(comparison, false, options);
    comparison->bounces = family(comparison, true, options);
    for (size_t i = 0; enough && i < comparison->cell_count; i++) {
        const struct rb_compare_cell *cell = &comparison->cells[i];
        for (size_t r = 0; enough && r < cell->row_count; r++) {
            struct rb_compare_row *row = &comparison->rows[cell->first_row + r];
            row_times(sides, cell, options, row, &work);
            estimate(&work, options->paired, rb_comparison_family(comparison, row)->level, row);
            enough = !isnan(row->ratio.value);
        }
    }
    rb_process_times_free(&work);
    return enough ? RB_OK : rb_error_memory(error, "the comparison");
}

enum rb_status rb_comparison_make(const struct rb_compare_side sides[2],
                                  const struct rb_compare_options *options,
                                  struct rb_comparison *comparison, struct rb_error *error)
{
    struct rb_array selected[2] = {{0}}, only[2] = {{0}}, pairs = {0};
    *comparison = (struct rb_comparison){0};
    comparison->key_skip = sides[0].variant ? 1u << RB_KEY_VARIANT : 0;
    enum rb_status status = RB_OK;
    for (int s = 0; s < 2 && !status; s++)
        status = select_cells(&sides[s], options->scenes, &selected[s], error);
    if (!status)
        status = match_cells(selected, comparison->key_skip, &pairs, only, error);
    for (int s = 0; s < 2; s++) {
        rb_array_release(&selected[s]);
        comparison->only[s] = only[s].data;
        comparison->only_count[s] = only[s].count;
    }
    comparison->cells = pairs.data;
    comparison->cell_count = pairs.count;
    return status ? status : make_rows(sides, options, comparison, error);
}

void rb_comparison_free(struct rb_comparison *comparison)
{
    rb_free(comparison->cells);
    rb_free(comparison->rows);
    rb_free(comparison->only[0]);
    rb_free(comparison->only[1]);
    *comparison = (struct rb_comparison){0};
}

const struct rb_compare_family *rb_comparison_family(const struct rb_comparison *comparison,
                                                     const struct rb_compare_row *row)
{
    return row->bounce == RB_ALL_BOUNCES ? &comparison->kernels : &comparison->bounces;
}

const struct rb_compare_row *rb_comparison_frame(const struct rb_comparison *comparison,
                                                 const struct rb_compare_cell *cell)
{
    for (size_t i = 0; i < cell->row_count; i++)
        if (comparison->rows[cell->first_row + i].kernel == 0)
            return &comparison->rows[cell->first_row + i];
    return NULL;
}

static double frame_ratio(const struct rb_comparison *comparison, size_t cell)
{
    const struct rb_compare_row *frame = rb_comparison_frame(comparison, &comparison->cells[cell]);
    return frame ? frame->ratio.value : (double)NAN;
}

// Are the two cells the same but for the scene, and do both have a ratio?
static bool in_group(const struct rb_comparison *comparison, size_t i, size_t j)
{
    unsigned skip = comparison->key_skip | 1u << RB_KEY_SCENE;
    const struct rb_compare_cell *cells = comparison->cells;
    return rb_cell_compare(cells[i].a, cells[j].a, skip) == 0 &&
           !isnan(frame_ratio(comparison, i)) && !isnan(frame_ratio(comparison, j));
}

bool rb_comparison_next_mean(const struct rb_comparison *comparison, size_t *first,
                             struct rb_compare_mean *mean)
{
    size_t count = comparison->cell_count;
    double *ratios = rb_alloc(count, sizeof *ratios);
    *mean = (struct rb_compare_mean){0};
    for (; ratios && *first < count && mean->scenes < 2; ++*first) {
        bool told = false;
        for (size_t i = 0; i < *first; i++)
            told |= in_group(comparison, i, *first);
        mean->scenes = 0;
        for (size_t i = *first; i < count && !told; i++)
            if (in_group(comparison, *first, i))
                ratios[mean->scenes++] = frame_ratio(comparison, i);
        mean->like = comparison->cells[*first].a;
        mean->ratio = rb_stats_geometric_mean(ratios, mean->scenes);
    }
    rb_free(ratios);
    return mean->scenes >= 2;
}
