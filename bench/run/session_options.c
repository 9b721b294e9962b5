// Options that the commands of plans share.
#include "bench/run/session.h"

#define BENCH(field) offsetof(struct rb_arguments, bench.field)

const struct rb_option rb_options_cells[] = {
    {"--scenes", "SCENE,...", RB_OPTION_TEXT, BENCH(scenes), 0, 0,
     "scenes, comma-separated; patterns such as mount_* choose presets"},
    {"--variants", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0,
     "rows, comma-separated names or patterns, or fastest"},
    {"--variant", "VARIANT,...", RB_OPTION_TEXT, BENCH(variants), 0, 0, "the same"},
    {"--threads", "LIST", RB_OPTION_TEXT, BENCH(threads), 0, 0,
     "thread counts of +omp rows, max, or powers: 1, 2, 4 ... max; default max: as OpenMP has it"},
    {"--tile", "LIST", RB_OPTION_TEXT, BENCH(tiles), 0, 0,
     "edges of a tile in pixels, multiples of 16; default 64"},
    {"--depth", "LIST", RB_OPTION_TEXT, BENCH(depths), 0, 0,
     "levels of the ray tree, 1 = ray casting; default 5"},
    {"--light-samples", "LIST", RB_OPTION_TEXT, BENCH(light_samples), 0, 0,
     "shadow rays per light; default 1"},
    {.name = NULL},
};

const struct rb_option rb_options_timing[] = {
    {"--budget", "TIME", RB_OPTION_TIME, offsetof(struct rb_arguments, budget_s), 0.1, 1e6,
     "time to spend, such as 90s or 5m; default 12 s a scene"},
    {"--processes", "N", RB_OPTION_INT, BENCH(processes), 1, 1000,
     "processes each cell has at least; default 6, the fewest with a 95 % interval; 16 against a "
     "program"},
    {"--against", "PROGRAM", RB_OPTION_TEXT, BENCH(against), 0, 0,
     "another build of raybench, measured in turn with this one, and compared; variants: "
     "bvh,packet"},
    {"--full-reference", NULL, RB_OPTION_FLAG, BENCH(full_reference), 0, 0,
     "render naive in full for the reference, however long that takes; it is kept"},
    {"--resume", NULL, RB_OPTION_FLAG, BENCH(resume), 0, 0,
     "go on with the newest run in DIR, which was stopped"},
    {.name = NULL},
};

const struct rb_option rb_options_simulation[] = {
    {"--tiles", "N", RB_OPTION_INT, BENCH(simulate_tiles), 1, 1e9,
     "tiles of the frame to simulate; default: as many as take about ten seconds"},
    {"--l1", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(l1), 0, 0,
     "simulated L1 data cache, such as 32K,8; default: this machine's"},
    {"--ll", "SIZE,WAYS", RB_OPTION_TEXT, BENCH(ll), 0, 0,
     "simulated last-level cache, such as 32M,16; default: this machine's"},
    {.name = NULL},
};

const struct rb_option rb_options_hardware[] = {
    {"--events", "NAME|FILE", RB_OPTION_TEXT, BENCH(events), 0, 0,
     "what to count with --measure hardware: a name of bench/events, or a file that ends in "
     ".events; default: those of this processor"},
    {"--energy", NULL, RB_OPTION_FLAG, BENCH(energy), 0, 0,
     "measure energy too: of frames, and of each kernel alone, a second each; needs RAPL"},
    {"--idle", "TIME", RB_OPTION_TIME, BENCH(idle_s), 0.1, 3600,
     "how long the idle machine is measured for that, before and after; default 2 s"},
    {"--energy-model", "NAME|FILE", RB_OPTION_TEXT, BENCH(energy_model), 0, 0,
     "where energy is not measured, model it from simulated events: horowitz14-45nm, "
     "jouppi21-7nm, or a file that ends in .energy"},
    {.name = NULL},
};

const struct rb_option rb_options_keeping[] = {
    {"--out", "DIR", RB_OPTION_TEXT, offsetof(struct rb_arguments, output), 0, 0,
     "folder for result folders; default results"},
    {"--dry-run", NULL, RB_OPTION_FLAG, BENCH(dry_run), 0, 0, "print the cells and the time"},
    {"--quiet", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, quiet), 0, 0,
     "no progress, no warnings"},
    {.name = NULL},
};
