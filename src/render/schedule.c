// How the tiles of a frame are shared among workers: they take the next tile from a counter until
// none is left. Whoever renders a tile, its pixels come out the same, so the assignment may be left
// to chance.
#include "render/frame.h"
#include "render/variants.h"

#ifdef _OPENMP
#include <omp.h>
#endif

void rb_schedule_serial(struct rb_frame *frame, struct rb_worker *workers, int count)
{
    (void)count;
    frame->thread_count = 1;
    rb_worker_run(&workers[0]);
}

#ifdef _OPENMP
int rb_threads_default(void)
{
    int threads = omp_get_max_threads(), limit = omp_get_thread_limit();
    threads = threads < limit ? threads : limit;
    return threads < RB_THREADS_MAX ? threads : RB_THREADS_MAX;
}

void rb_schedule_openmp(struct rb_frame *frame, struct rb_worker *workers, int count)
{
#pragma omp parallel num_threads(count)
    {
        if (omp_get_thread_num() == 0)
            frame->thread_count = omp_get_num_threads(); // OpenMP may give fewer
        rb_worker_run(&workers[omp_get_thread_num()]);
    }
}
#else
int rb_threads_default(void)
{
    return 1;
}

void rb_schedule_openmp(struct rb_frame *frame, struct rb_worker *workers, int count)
{
    rb_schedule_serial(frame, workers, count);
}
#endif
