#include "accel/parallel.h"

#include "base/fpenv.h"

void rb_parallel_for(int threads, uint32_t count, rb_parallel_step *step, const void *job)
{
    (void)threads;
#pragma omp parallel num_threads(threads)
    {
        fenv_t saved;
        rb_fpenv_enter(&saved);
#pragma omp for schedule(dynamic, 1)
        for (uint32_t i = 0; i < count; i++)
            step(job, i);
        rb_fpenv_leave(&saved);
    }
}
