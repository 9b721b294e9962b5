#define _POSIX_C_SOURCE 200809L
#include "cli/progress.h"

#include "measure/clock.h"

#include <stdio.h>
#include <unistd.h>

enum { BAR_WIDTH = 40, UPDATE_NS = 100000000 };

void rb_progress_start(struct rb_progress *progress, bool quiet)
{
    *progress = (struct rb_progress){.shown = !quiet && isatty(STDERR_FILENO)};
    progress->start_ns = progress->last_ns = rb_clock_ns();
}

void rb_progress_update(void *user, uint32_t done, uint32_t total)
{
    struct rb_progress *progress = user;
    uint64_t now_ns = rb_clock_ns();
    if (!progress->shown || now_ns - progress->last_ns < UPDATE_NS)
        return;
    progress->last_ns = now_ns;
    double share = (double)done / (double)total;
    double left_s = (double)(now_ns - progress->start_ns) * 1e-9 * (1.0 - share) / share;
    char bar[BAR_WIDTH + 1] = {0};
    for (int i = 0; i < BAR_WIDTH; i++)
        bar[i] = i < (int)(share * BAR_WIDTH) ? '#' : '.';
    fprintf(stderr, "\r[%s] %3.0f %%  %.0f s left \033[K", bar, share * 100.0, left_s);
}

void rb_progress_end(struct rb_progress *progress)
{
    if (progress->shown)
        fprintf(stderr, "\r\033[K");
}
