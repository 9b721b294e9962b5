#include "bench/times/render_energy.h"

#include "base/memory.h"
#include "bench/energy/energy.h"

#include <math.h>
#include <stdio.h>

static enum rb_status measure_cell(const struct rb_render_session *session,
                                   const struct rb_render_cell *cell, struct rb_meter *meter,
                                   struct rb_energy_span *span, struct rb_error *error)
{
    struct rb_timed_result time;
    double before = 0, after = 0;
    enum rb_status status = rb_meter_read(meter, &before, error);
    while (status == RB_OK && span->seconds < RB_ENERGY_SECONDS_LEAST) {
        status = rb_render_session_time(session, cell, 0, &time, error);
        span->seconds += time.wall_s;
        span->units += 1;
    }
    if (status == RB_OK)
        status = rb_meter_read(meter, &after, error);
    span->joules = after - before;
    return status;
}

static enum rb_status measure_cells(const struct rb_render_session *session, struct rb_meter *meter,
                                    struct rb_energy_span *spans, struct rb_render_row *rows,
                                    struct rb_error *error)
{
    struct rb_energy energy = {.frames = {.units = 0}};
    enum rb_status status = rb_energy_idle(meter, 0, &energy.idle_before_w, error);
    for (size_t i = 0; i < session->count && status == RB_OK; i++)
        if (rows[i].runs)
            status = measure_cell(session, &session->cells[i], meter, &spans[i], error);
    if (status == RB_OK)
        status = rb_energy_idle(meter, 0, &energy.idle_after_w, error);
    for (size_t i = 0; i < session->count && status == RB_OK; i++)
        rows[i].frame_j = rb_energy_figures(&energy, &spans[i]).net;
    return status;
}

enum rb_status rb_render_measure_energy(const struct rb_render_session *session, const char *root,
                                        struct rb_render_row *rows, struct rb_error *error)
{
    struct rb_meter meter;
    struct rb_error reason = {0};
    struct rb_energy_span *spans = rb_alloc(session->count, sizeof *spans);
    if (!spans)
        return rb_error_memory(error, "the energies");
    enum rb_status status = rb_meter_open(&meter, root, &reason);
    if (status == RB_OK) {
        status = measure_cells(session, &meter, spans, rows, &reason);
        rb_meter_close(&meter);
    }
    rb_free(spans);
    if (status && rb_timed_interrupted())
        return rb_error_set(error, status, "%s", reason.text);
    if (status)
        printf("No joules a frame: %s.\n", reason.text);
    return RB_OK;
}
