#include "bench/gate/moved.h"

#include "bench/compare/compare_print.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t NO_ROW = (size_t)-1;

static bool is_frame(const struct rb_csv *figures, size_t row)
{
    return strcmp(rb_csv_text(figures, row, RB_KEY_KERNEL), "frame") == 0;
}

static bool same_fields(const struct rb_csv *a, size_t i, const struct rb_csv *b, size_t j,
                        int first, int end)
{
    bool same = true;
    for (int c = first; c < end && same; c++)
        same = strcmp(rb_csv_text(a, i, c), rb_csv_text(b, j, c)) == 0;
    return same;
}

// The row of `in` about the same place.
static size_t find(const struct rb_csv *in, const struct rb_csv *figures, size_t row)
{
    for (size_t i = 0; i < in->row_count; i++)
        if (same_fields(figures, row, in, i, 0, RB_KEY_COUNT))
            return i;
    return NO_ROW;
}

static size_t find_frame(const struct rb_csv *in, const struct rb_csv *figures, size_t row)
{
    for (size_t i = 0; i < in->row_count; i++)
        if (is_frame(in, i) && same_fields(figures, row, in, i, 0, RB_KEY_CELL))
            return i;
    return NO_ROW;
}

static void label(const struct rb_csv *figures, size_t row, struct rb_gate_row *place,
                  char text[RB_CELL_LABEL_MAX])
{
    *place = (struct rb_gate_row){.bounce = -1, .cell = {.image_hash = ""}};
    for (int i = 0; i < RB_KEY_CELL; i++)
        place->cell.key[i] = rb_csv_text(figures, row, i);
    place->kernel = rb_csv_text(figures, row, RB_KEY_KERNEL);
    if (rb_csv_text(figures, row, RB_KEY_BOUNCE)[0])
        place->bounce = atoi(rb_csv_text(figures, row, RB_KEY_BOUNCE));
    rb_compare_label(&place->cell, 0, text);
}

static enum rb_status refuse(const struct rb_csv *figures, size_t row, const char *what,
                             struct rb_error *error)
{
    struct rb_gate_row place;
    char text[RB_CELL_LABEL_MAX];
    label(figures, row, &place, text);
    rb_csv_place(figures, row, -1, error);
    return rb_error_set(error, RB_INVALID, "%.120s, %.16s: %s", text, place.kernel, what);
}

// What a cell's line of work says: whether its figures can be compared at all.
static enum rb_status check_work(const struct rb_csv *base, size_t b, const struct rb_csv *head,
                                 size_t h, bool *comparable, struct rb_gate_report *report,
                                 struct rb_error *error)
{
    struct rb_gate_row place;
    char text[RB_CELL_LABEL_MAX];
    label(base, b, &place, text);
    *comparable = false;
    if (!rb_csv_text(head, h, RB_FIGURES_SCENE_HASH)[0]) {
        rb_gate_report_note(report, "not compared: %.200s cannot run here", text);
        return RB_OK;
    }
    if (!same_fields(base, b, head, h, RB_FIGURES_SCENE_HASH, RB_FIGURES_MADE_BY))
        return refuse(base, b,
                      "another scene, image or hits: this is not the same work. If that is meant, "
                      "run make baseline",
                      error);
    *comparable = same_fields(base, b, head, h, RB_FIGURES_MADE_BY, RB_FIGURES_FIRST);
    if (!*comparable)
        rb_gate_report_note(report,
                            "not compared: %.200s: simulated by another compiler or simulator or "
                            "with other flags; hold it against a program with --against",
                            text);
    return RB_OK;
}

static enum rb_moved judge(double base, double head, double rays, int figure)
{
    struct rb_figure_rule rule = rb_figure_rule(figure);
    double may = fmax(rule.share * base, fmax(rule.per_ray * rays, rule.events));
    if (fabs(head - base) <= may)
        return RB_MOVED_NOT;
    return head > base ? RB_MOVED_WORSE : RB_MOVED_BETTER;
}

// A figure that neither side has is none; one that only one side has is no figure of the same run.
static enum rb_status compare_figure(const struct rb_csv *base, size_t b, const struct rb_csv *head,
                                     size_t h, int figure, const struct rb_waivers *waivers,
                                     struct rb_gate_report *report, struct rb_error *error)
{
    int column = RB_FIGURES_FIRST + figure;
    char text[RB_CELL_LABEL_MAX];
    struct rb_gate_row row;
    uint64_t was, is;
    bool had = rb_csv_word(base, b, column, &was, 10), has = rb_csv_word(head, h, column, &is, 10);
    if (!had || !has)
        return had == has && !rb_csv_text(base, b, column)[0]
                   ? RB_OK
                   : refuse(base, b, "not measured on both sides", error);
    label(base, b, &row, text);
    row.figure = rb_figure_rule(figure).name;
    row.mode = figure < RB_FIGURE_SIMULATED ? "count" : "simulate";
    row.base = (double)was;
    row.head = (double)is;
    row.ratio = was == is ? 1 : row.head / row.base; // infinite where there was nothing
    row.low = row.high = row.floor = (double)NAN;
    row.moved = judge(row.base, row.head, rb_csv_number(base, b, RB_FIGURES_FIRST), figure);
    rb_waivers_apply(waivers, &row);
    rb_gate_report_add(report, &row, row.moved != RB_MOVED_NOT);
    return RB_OK;
}

static enum rb_status compare_place(const struct rb_csv *base, size_t b, const struct rb_csv *head,
                                    const struct rb_waivers *waivers, struct rb_gate_report *report,
                                    struct rb_error *error)
{
    enum rb_status status = RB_OK;
    size_t h = find(head, base, b);
    if (h == NO_ROW)
        return refuse(base, b, "is not in this run", error);
    for (int figure = 0; figure < RB_FIGURE_COUNT && !status; figure++)
        status = compare_figure(base, b, head, h, figure, waivers, report, error);
    return status;
}

// Whatever this run has must have something to stand against.
static enum rb_status check_known(const struct rb_csv *base, const struct rb_csv *head,
                                  struct rb_error *error)
{
    for (size_t h = 0; h < head->row_count; h++)
        if (find(base, head, h) == NO_ROW)
            return refuse(head, h, "is not in the baseline; add it with make baseline", error);
    return RB_OK;
}

enum rb_status rb_figures_compare(const struct rb_csv *base, const struct rb_csv *head,
                                  const struct rb_waivers *waivers, struct rb_gate_report *report,
                                  size_t *left_out, struct rb_error *error)
{
    bool comparable = false;
    enum rb_status status = base->row_count ? check_known(base, head, error)
                                            : rb_error_set(error, RB_INVALID, "nothing is in it");
    for (size_t b = 0; b < base->row_count && !status; b++) {
        size_t frame = find_frame(head, base, b);
        if (frame == NO_ROW)
            return refuse(base, b, "is not in this run: what it measures has changed", error);
        if (is_frame(base, b)) {
            status = check_work(base, b, head, frame, &comparable, report, error);
            *left_out += !comparable;
        } else if (comparable) {
            status = compare_place(base, b, head, waivers, report, error);
        }
    }
    return status;
}
