// The columns on energy: measured, or else modelled where a model was asked for.
#include "bench/run/event_columns.h"

#include <math.h>

// Of a ray of a kernel at a bounce, or of a frame; joules, net and gross, and what they take.
struct known {
    struct rb_energy_figures figures;
    const char *source; // NULL: nothing is known
};

static struct known measured(const struct rb_cell *cell, const struct rb_energy_span *span)
{
    struct rb_energy_figures figures = rb_energy_figures(cell->energy, span);
    return (struct known){figures, isfinite(figures.net) ? cell->energy->source : NULL};
}

static double modelled_j(const struct rb_cell *cell, enum rb_stage stage, int bounce)
{
    return rb_energy_model_joules(cell->energy_model, &cell->simulated->place[stage][bounce]);
}

static struct known of_ray(const struct rb_line *line)
{
    const struct rb_cell *cell = line->cell;
    struct known known = {.source = NULL};
    if (!line->counts || line->stage >= RB_KERNEL_COUNT)
        return known;
    if (cell->energy)
        known = measured(cell, &cell->energy->place[line->stage][line->bounce]);
    if (known.source || !cell->energy_model || !cell->simulated)
        return known;
    double joules = modelled_j(cell, line->stage, line->bounce);
    known.figures = (struct rb_energy_figures){(double)NAN, joules, line->per_ray.value * 1e-9};
    known.source = isfinite(joules) ? cell->energy_model->label : NULL;
    return known;
}

// The model of a frame is the sum of its kernels, if all but a hundredth of their entries are where
// something was simulated.
static struct known of_frame(const struct rb_line *line)
{
    const struct rb_cell *cell = line->cell;
    struct known known = {.source = NULL};
    double joules = 0, rays = 0, missing = 0;
    if (cell->energy)
        known = measured(cell, &cell->energy->frames);
    if (known.source || !cell->energy_model || !cell->simulated)
        return known;
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            double here = (double)cell->reference->frame.stage[stage][bounce].rays;
            double each = here > 0 ? modelled_j(cell, (enum rb_stage)stage, bounce) : 0;
            missing += isnan(each) ? here : 0;
            joules += isnan(each) ? 0 : here * each;
            rays += here;
        }
    double seconds = line->per_ray.value * 1e-9;
    known.figures = (struct rb_energy_figures){(double)NAN, joules, seconds};
    known.source = joules > 0 && missing <= 0.01 * rays ? cell->energy_model->label : NULL;
    return known;
}

static struct rb_value note(const struct rb_cell *cell, const struct known *known, bool kernel)
{
    const struct rb_energy *energy = cell->energy;
    if (known->source || (!energy && !cell->energy_model))
        return rb_none();
    if (energy && energy->note[0])
        return rb_text(energy->note);
    if (energy && kernel && energy->kernels[0])
        return rb_text(energy->kernels);
    if (energy && isfinite(known->figures.gross))
        return rb_text("not above what the idle machine takes");
    return rb_text(energy ? "not measured: the frame is estimated" : "not simulated");
}

struct rb_value rb_column_nj_per_ray(const struct rb_line *line)
{
    struct known known = of_ray(line);
    return known.source ? rb_number(known.figures.net * 1e9) : rb_none();
}

struct rb_value rb_column_gross_nj_per_ray(const struct rb_line *line)
{
    struct known known = of_ray(line);
    return known.source ? rb_number(known.figures.gross * 1e9) : rb_none();
}

struct rb_value rb_column_energy_source(const struct rb_line *line)
{
    return rb_text(of_ray(line).source);
}

struct rb_value rb_column_energy_note(const struct rb_line *line)
{
    struct known known = of_ray(line);
    bool kernel = line->counts && line->stage < RB_KERNEL_COUNT;
    return kernel ? note(line->cell, &known, true) : rb_none();
}

struct rb_value rb_column_frame_j(const struct rb_line *line)
{
    struct known known = of_frame(line);
    return known.source ? rb_number(known.figures.net) : rb_none();
}

struct rb_value rb_column_gross_frame_j(const struct rb_line *line)
{
    struct known known = of_frame(line);
    return known.source ? rb_number(known.figures.gross) : rb_none();
}

struct rb_value rb_column_edp_js(const struct rb_line *line)
{
    struct known known = of_frame(line);
    return known.source ? rb_number(known.figures.net * known.figures.seconds) : rb_none();
}

struct rb_value rb_column_frame_energy_source(const struct rb_line *line)
{
    return rb_text(of_frame(line).source);
}

struct rb_value rb_column_frame_energy_note(const struct rb_line *line)
{
    struct known known = of_frame(line);
    return note(line->cell, &known, false);
}
