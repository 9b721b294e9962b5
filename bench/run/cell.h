// A cell is one thing to measure: a scene, a row of the table and settings. Cells of the same scene
// and image settings share a reference, which says what the image and the hits must be.
#ifndef RB_RUN_CELL_H
#define RB_RUN_CELL_H

#include "bench/data/stats.h"
#include "bench/energy/energy.h"
#include "bench/energy/model.h"
#include "bench/hardware/hardware.h"
#include "bench/run/sample.h"
#include "bench/simulate/simulated.h"
#include "render/counted.h"
#include "render/settings.h"
#include "render/variants.h"

#include <stddef.h>

struct rb_reference {
    const char *scene_name;
    uint64_t scene_hash;
    uint32_t primitive_count;
    struct rb_settings settings; // complete, as far as they tell what the image is
    const char *made_by;         // row that rendered it; NULL: not made yet
    bool cached;                 // in an earlier run
    uint64_t image_hash, hits_hash;
    struct rb_sample frame; // its ray counts, the same for every row
    double rays;            // of trace and trace_shadow in it
};

enum rb_cell_state {
    RB_CELL_OPEN,        // has or will have samples
    RB_CELL_UNAVAILABLE, // the machine or the build lacks what the row needs
    RB_CELL_INVALID,     // its image or hits differ from the reference: it gets no time
    RB_CELL_CRASHED,     // its process ended otherwise than it should
};

// What the kernels of a cell did, and for how many rays: in a frame, or in a group of tiles.
struct rb_counted {
    struct rb_sample sample;
    struct rb_count_table table;
};

struct rb_cell {
    const struct rb_variant *variant;
    struct rb_reference *reference;
    struct rb_settings settings; // complete
    int side;                    // 0, or 1: measured with the program of --against
    enum rb_cell_state state;
    uint32_t group_tiles; // samples are random groups of so many small tiles; 0: whole frames
    double group_population;
    struct rb_sample *samples; // by process, then repetition
    size_t sample_count, sample_room;
    uint32_t process_count;                     // processes that have ended well
    double cost_s;                              // wall time of the last of them
    struct rb_counted *counted;                 // NULL: not counted; its own, as the samples
    struct rb_simulated *simulated;             // NULL: not simulated; its own, as the samples
    struct rb_hardware *hardware;               // NULL: not counted by hardware; its own
    struct rb_energy *energy;                   // NULL: not measured; its own
    const struct rb_energy_model *energy_model; // NULL: none
};

// A number over the repetitions and processes of a cell. NaN where it cannot be known.
struct rb_figure {
    double value;       // median over processes of the median over their repetitions
    double low, high;   // interval of the median over processes, of order statistics
    double level;       // that covers it with this probability
    double min, p10;    // over all repetitions
    double mdape_pct;   // median absolute deviation of all repetitions from `value`
    size_t n;           // processes
    size_t repetitions; // in all of them
};

// The figures all tables show, in ns. Thread time is that of all threads together.
struct rb_figure rb_cell_ns_per_ray(const struct rb_cell *cell, enum rb_stage stage, int bounce);

// ns per ray of each process, for comparing: the 10th percentile of its repetitions, which is what
// `raybench compare` compares. `times` has room for one per sample. Returns how many there are.
size_t rb_cell_process_p10(const struct rb_cell *cell, enum rb_stage stage, int bounce,
                           double *times);

// The same of wall time, where threads share the rays of one stage at one bounce.
size_t rb_cell_process_wall_p10(const struct rb_cell *cell, enum rb_stage stage, int bounce,
                                double *times);

struct rb_figure rb_cell_frame_ns(const struct rb_cell *cell); // wall time
struct rb_figure rb_cell_build_ns(const struct rb_cell *cell);
double rb_cell_busy_ns(const struct rb_cell *cell); // thread time of a frame

// Share of the thread time, all repetitions together, that a stage takes at a bounce, or at all if
// bounce is -1: shares add up to 1 however noisy the machine is, which medians do not.
double rb_cell_share(const struct rb_cell *cell, enum rb_stage stage, int bounce);
double rb_cell_imbalance(const struct rb_cell *cell); // 1 - mean / max busy time of the threads
double rb_cell_overhead(const struct rb_cell *cell, double probe_ns); // share of the thread time

bool rb_cell_has_time(const struct rb_cell *cell);
const char *rb_cell_note(const struct rb_cell *cell); // why there is none, or that it is estimated

// Words separated by ';' that say what to beware of; see results/README.md.
void rb_cell_flags(const struct rb_cell *cell, bool partial, double probe_ns, char text[128]);

// Frees what the cell owns.
void rb_cell_release(struct rb_cell *cell);

// Appends a sample. False without memory.
bool rb_cell_add(struct rb_cell *cell, const struct rb_sample *sample);

#endif
