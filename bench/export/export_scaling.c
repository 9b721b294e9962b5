// How the time per ray grows with the primitives of scenes that one generator has made, balls2,
// balls3, ...: a straight line through the times over the logarithm of the number, and, to tell how
// far from one they are, one through the logarithms of both, whose slope is the power of the number
// that times grow with. Least squares; a tree that doubles adds a level, so the first should fit.
#include "bench/export/export_load.h"

#include <math.h>
#include <string.h>

enum { POINTS_MAX = 64, POINTS_LEAST = 3 };

struct tables {
    const struct rb_export *result;
    int primitives;                    // column of frame.csv
    int ns_per_ray, key[RB_KEY_COUNT]; // columns of kernels.csv
};

// Times of one kernel over the scenes of one generator.
struct curve {
    double primitives[POINTS_MAX], ns[POINTS_MAX];
    int count;
};

struct fit {
    double slope, share; // share of the variance that the line explains, R^2
};

static struct fit fit_line(const double *x, const double *y, int count)
{
    double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
    for (int i = 0; i < count; i++)
        mx += x[i] / count, my += y[i] / count;
    for (int i = 0; i < count; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
        yy += (y[i] - my) * (y[i] - my);
    }
    return (struct fit){xy / xx, yy > 0 ? xy * xy / (xx * yy) : (double)NAN};
}

static const char *text(const struct tables *t, size_t row, enum rb_key key)
{
    return rb_csv_text(&t->result->kernels, row, t->key[key]);
}

// The name of the generator: all but the size. 0 where there is none.
static int family(const char *scene)
{
    size_t length = strcspn(scene, "0123456789"), digits = strspn(scene + length, "0123456789");
    return digits && !scene[length + digits] ? (int)length : 0;
}

// Do two lines differ in the size of the scene alone?
static bool alike(const struct tables *t, size_t a, size_t b)
{
    int length = family(text(t, a, RB_KEY_SCENE));
    bool same = length == family(text(t, b, RB_KEY_SCENE)) &&
                memcmp(text(t, a, RB_KEY_SCENE), text(t, b, RB_KEY_SCENE), (size_t)length) == 0;
    for (int i = RB_KEY_WIDTH; same && i < RB_KEY_COUNT; i++)
        same = strcmp(text(t, a, (enum rb_key)i), text(t, b, (enum rb_key)i)) == 0;
    return same;
}

// NaN where the frame of the line has no time.
static double primitives_of(const struct tables *t, size_t row)
{
    const struct rb_export_series *series = t->result->series.data;
    for (size_t f = 0; f < t->result->series.count; f++) {
        bool same = true;
        for (int i = 0; same && i < RB_KEY_CELL; i++)
            same = strcmp(series[f].key[i], text(t, row, (enum rb_key)i)) == 0;
        if (same)
            return rb_csv_number(&t->result->frames, series[f].row, t->primitives);
    }
    return (double)NAN;
}

// The lines like `first`; none if it is not the first of them.
static void gather(const struct tables *t, size_t first, struct curve *curve)
{
    curve->count = 0;
    for (size_t row = 0; row < t->result->kernels.row_count; row++) {
        if (!alike(t, first, row))
            continue;
        if (row < first)
            return;
        double primitives = primitives_of(t, row);
        double ns = rb_csv_number(&t->result->kernels, row, t->ns_per_ray);
        if (!(primitives > 0 && ns > 0) || curve->count == POINTS_MAX)
            continue;
        curve->primitives[curve->count] = primitives;
        curve->ns[curve->count++] = ns;
    }
}

static void put_curve(const struct tables *t, size_t row, const struct curve *curve, FILE *out)
{
    double decades[POINTS_MAX], powers[POINTS_MAX];
    int last = curve->count - 1;
    for (int i = 0; i < curve->count; i++)
        decades[i] = log10(curve->primitives[i]), powers[i] = log10(curve->ns[i]);
    struct fit line = fit_line(decades, curve->ns, curve->count);
    struct fit power = fit_line(decades, powers, curve->count);
    fprintf(out,
            "%-8.*s %-16s %7s %-12s %6s %9.0f to %8.0f %8.4g to %8.4g %8.4g %5.2f %6.3f %5.2f\n",
            family(text(t, row, RB_KEY_SCENE)), text(t, row, RB_KEY_SCENE),
            text(t, row, RB_KEY_VARIANT), text(t, row, RB_KEY_THREADS), text(t, row, RB_KEY_KERNEL),
            text(t, row, RB_KEY_BOUNCE), curve->primitives[0], curve->primitives[last],
            curve->ns[0], curve->ns[last], line.slope, line.share, power.slope, power.share);
}

enum rb_status rb_export_scaling(const struct rb_export *result, FILE *out, struct rb_error *error)
{
    static const char *const primitives = "primitives", *const ns_per_ray = "ns_per_ray";
    struct tables t = {.result = result};
    const struct rb_csv *kernels = &result->kernels;
    struct curve curve;
    if (rb_export_columns(&result->frames, &primitives, 1, &t.primitives, error) ||
        rb_export_columns(kernels, &ns_per_ray, 1, &t.ns_per_ray, error) ||
        rb_export_columns(kernels, rb_key_names, RB_KEY_COUNT, t.key, error))
        return RB_INVALID;
    fprintf(out, "%-8s %-16s %7s %-12s %6s %21s %20s %8s %5s %6s %5s\n", "scenes", "variant",
            "threads", "kernel", "bounce", "primitives", "ns per ray", "x 10: ns", "R^2", "power",
            "R^2");
    for (size_t row = 0; row < kernels->row_count; row++) {
        bool traces = strncmp(text(&t, row, RB_KEY_KERNEL), "trace", strlen("trace")) == 0;
        if (!traces || !family(text(&t, row, RB_KEY_SCENE)))
            continue;
        gather(&t, row, &curve);
        if (curve.count >= POINTS_LEAST)
            put_curve(&t, row, &curve, out);
    }
    return RB_OK;
}
