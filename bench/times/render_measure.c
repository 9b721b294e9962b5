#define _POSIX_C_SOURCE 200809L
#include "bench/times/render_measure.h"

#include "bench/data/stats.h"
#include "measure/clock.h"

#include <math.h>
#include <stdarg.h>
#include <unistd.h>

// Less than this by the small images: run it, to know.
static const double LOOK_S = 4;

#define NOTE_ESTIMATED "est.: not run in full; scaled up from 16 x 16 and 64 x 64 pixels"
#define NOTE_DISAGREES "no time: its image is not that of the first row"

// A line that the next one overwrites for those who watch a terminal, and that stays for everybody
// else.
__attribute__((format(printf, 2, 3))) static void announce(const struct rb_render_cell *cell,
                                                           const char *format, ...)
{
    bool terminal = isatty(STDERR_FILENO);
    va_list arguments;
    fprintf(stderr, "%s%s %s: ", terminal ? "\r" : "", cell->scene->name, cell->variant->name);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputs(terminal ? " ...\033[K\r" : "\n", stderr);
}

static void wipe_announcement(void)
{
    if (isatty(STDERR_FILENO))
        fputs("\r\033[K", stderr);
}

static void announce_runs(const struct rb_render_session *session, size_t index)
{
    const struct rb_render_cell *cell = &session->cells[index];
    announce(cell, "%d run%s, about %.0f s left", cell->runs, cell->runs == 1 ? "" : "s",
             rb_render_plan_seconds(cell, session->count - index));
}

// The least of a few runs, if they are short: what disturbs a small image would be multiplied.
static enum rb_status time_small(struct rb_render_session *session,
                                 const struct rb_render_cell *cell, int edge, double *least_s,
                                 struct rb_error *error)
{
    enum { TRIES = 3 };
    const double short_s = 0.3;
    struct rb_timed_result time;
    *least_s = HUGE_VAL;
    for (int i = 0; i < TRIES && (i == 0 || *least_s < short_s); i++) {
        enum rb_status status = rb_render_session_time(session, cell, edge, &time, error);
        if (status)
            return status;
        *least_s = time.wall_s < *least_s ? time.wall_s : *least_s;
    }
    return RB_OK;
}

// From small images; but where it cannot take long, it is run.
static enum rb_status estimate(struct rb_render_session *session, size_t index,
                               struct rb_error *error)
{
    enum { SMALL = RB_RENDER_SMALL_EDGE, MEDIUM = RB_RENDER_MEDIUM_EDGE, FULL = RB_RENDER_EDGE };
    struct rb_render_cell *cell = &session->cells[index];
    struct rb_timed_result full;
    double small_s, medium_s;
    enum rb_status status = time_small(session, cell, SMALL, &small_s, error);
    if (status == RB_OK)
        status = time_small(session, cell, MEDIUM, &medium_s, error);
    if (status == RB_OK)
        status = rb_render_session_compare(session, index, error);
    if (status)
        return status;
    cell->estimate_s =
        rb_render_extrapolate(small_s, SMALL * SMALL, medium_s, MEDIUM * MEDIUM, FULL * FULL);
    if (cell->estimate_s >= LOOK_S)
        return RB_OK;
    status = rb_render_session_time(session, cell, 0, &full, error);
    if (status == RB_OK)
        cell->estimate_s = full.wall_s;
    return status;
}

enum rb_status rb_render_estimate(struct rb_render_session *session, struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (size_t i = 0; i < session->count && status == RB_OK; i++) {
        bool new_scene = i == 0 || session->cells[i].scene != session->cells[i - 1].scene;
        if (new_scene)
            session->has_reference = false;
        if (new_scene || isatty(STDERR_FILENO))
            announce(&session->cells[i], "estimating its time");
        status = estimate(session, i, error);
    }
    wipe_announcement();
    return status;
}

static enum rb_status measure_by_hyperfine(struct rb_render_session *session, size_t begin,
                                           size_t end, struct rb_run_times *times,
                                           struct rb_error *error)
{
    enum rb_status status = RB_OK;
    for (size_t i = begin; i < end && status == RB_OK; i++) {
        const struct rb_render_cell *cell = &session->cells[i];
        if (cell->runs == 0 || session->disagrees[i])
            continue;
        announce_runs(session, i);
        status = rb_render_session_hyperfine(session, cell, &times[i - begin], error);
        if (status == RB_OK)
            status = rb_render_session_compare(session, i, error);
    }
    return status;
}

static enum rb_status measure_once(struct rb_render_session *session, size_t index, int round,
                                   struct rb_run_times *times, struct rb_error *error)
{
    const struct rb_render_cell *cell = &session->cells[index];
    struct rb_timed_result time;
    enum rb_status status = rb_render_session_time(session, cell, 0, &time, error);
    if (status || round < cell->warmups)
        return status;
    times->user_s += time.user_s / cell->runs;
    times->system_s += time.system_s / cell->runs;
    return rb_array_push(&times->wall_s, &time.wall_s, sizeof time.wall_s)
               ? RB_OK
               : rb_error_memory(error, "the times");
}

// In turns, so that drift of the machine hits all rows alike.
static enum rb_status measure_by_ourselves(struct rb_render_session *session, size_t begin,
                                           size_t end, struct rb_run_times *times,
                                           struct rb_error *error)
{
    enum rb_status status = RB_OK;
    bool more = true;
    for (int round = 0; more && status == RB_OK; round++) {
        more = false;
        for (size_t i = begin; i < end && status == RB_OK; i++) {
            const struct rb_render_cell *cell = &session->cells[i];
            int rounds = cell->runs ? cell->warmups + cell->runs : 0;
            more |= round + 1 < rounds;
            if (round >= rounds || session->disagrees[i])
                continue;
            if (round == 0)
                announce_runs(session, i);
            status = measure_once(session, i, round, &times[i - begin], error);
            if (status == RB_OK)
                status = rb_render_session_compare(session, i, error);
        }
    }
    return status;
}

static void fill_times(struct rb_render_row *row, const struct rb_run_times *times)
{
    double *values = times->wall_s.data, sum = 0;
    size_t count = times->wall_s.count;
    row->median_s = rb_stats_median(values, count).value; // sorts them, too
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    row->mean_s = sum / (double)count;
    row->min_s = values[0];
    row->max_s = values[count - 1];
    row->user_s = times->user_s;
    row->system_s = times->system_s;
    row->runs = (int)count;
}

static void fill_row(const struct rb_render_session *session, size_t index,
                     const struct rb_run_times *times, struct rb_render_row *row)
{
    const struct rb_render_cell *cell = &session->cells[index];
    const double none = (double)NAN;
    *row = (struct rb_render_row){
        .scene = cell->scene->name,
        .variant = cell->variant->name,
        .paper_s = cell->scene->paper_s,
        .threads = rb_variant_parallel(cell->variant) ? rb_threads_default() : 1,
        .median_s = none,
        .mean_s = none,
        .min_s = none,
        .max_s = none,
        .user_s = none,
        .system_s = none,
        .frame_j = none,
        .source = session->hyperfine[0] && cell->runs ? session->hyperfine : "raybench",
        .note = "",
    };
    if (session->disagrees[index]) {
        row->note = NOTE_DISAGREES;
    } else if (cell->runs) {
        fill_times(row, times);
    } else {
        row->median_s = cell->estimate_s;
        row->note = NOTE_ESTIMATED;
    }
}

static void print_row(const struct rb_render_row *row)
{
    if (isfinite(row->median_s))
        printf("  %-16s %-18s %10.4g s  %s", row->scene, row->variant, row->median_s,
               row->runs ? "" : "est.");
    else
        printf("  %-16s %-18s %10s    %s", row->scene, row->variant, "-", row->note);
    if (row->runs)
        printf("%d run%s", row->runs, row->runs == 1 ? "" : "s");
    printf("\n");
}

static enum rb_status measure_scene(struct rb_render_session *session, size_t begin, size_t end,
                                    struct rb_render_row *rows, struct rb_error *error)
{
    struct rb_run_times *times = rb_alloc(end - begin, sizeof *times);
    if (!times)
        return rb_error_memory(error, "the times");
    session->has_reference = false;
    enum rb_status status = session->hyperfine[0]
                                ? measure_by_hyperfine(session, begin, end, times, error)
                                : measure_by_ourselves(session, begin, end, times, error);
    wipe_announcement();
    for (size_t i = begin; i < end; i++) {
        if (status == RB_OK) {
            fill_row(session, i, &times[i - begin], &rows[i]);
            print_row(&rows[i]);
        }
        rb_run_times_free(&times[i - begin]);
    }
    rb_free(times);
    fflush(stdout);
    return status;
}

enum rb_status rb_render_measure(struct rb_render_session *session, int runs, double budget_s,
                                 struct rb_render_row *rows, struct rb_error *error)
{
    uint64_t start_ns = rb_clock_ns();
    enum rb_status status = RB_OK;
    for (size_t begin = 0, end; begin < session->count && status == RB_OK; begin = end) {
        double spent_s = (double)(rb_clock_ns() - start_ns) * 1e-9;
        struct rb_render_cell *cells = session->cells + begin;
        rb_render_plan(cells, session->count - begin, runs, budget_s - spent_s);
        for (end = begin; end < session->count && session->cells[end].scene == cells->scene; end++)
            ;
        status = measure_scene(session, begin, end, rows, error);
    }
    return status;
}
