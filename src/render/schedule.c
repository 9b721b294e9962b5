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
    (void)frame;
    (void)count;
    rb_worker_run(&workers[0]);
}

#ifdef _OPENMP
void rb_schedule_openmp(struct rb_frame *frame, struct rb_worker *workers, int count)
{
    (void)frame;
#pragma omp parallel num_threads(count)
    rb_worker_run(&workers[omp_get_thread_num()]);
}
#else
void rb_schedule_openmp(struct rb_frame *frame, struct rb_worker *workers, int count)
{
    rb_schedule_serial(frame, workers, count);
}
#endif
