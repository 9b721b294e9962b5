// Replaying recorded rays as a sub-command.
#ifndef RB_REPLAY_REPLAY_H
#define RB_REPLAY_REPLAY_H

#include "bench/replay/record_file.h"
#include "bench/run/cell.h"
#include "cli/options.h"

extern const struct rb_command rb_command_replay;

// One kernel at one bounce on the rays of a class: a cell that has processes of its own.
struct rb_replay_unit {
    struct rb_record_choice choice;
    uint64_t rays, batches;
    struct rb_cell cell;
};

enum { RB_REPLAY_UNITS_MAX = RB_CLASS_COUNT * RB_KERNEL_COUNT * RB_BOUNCE_MAX };

// A run of replay: its units, and whole frames of the same row in turn with them.
struct rb_replay_run {
    struct rb_record record; // what it says about itself, without batches
    const char *path;
    char program[RB_OUTPUT_PATH_MAX]; // that workers run
    struct rb_reference reference;    // the scene and settings of all cells
    struct rb_replay_unit units[RB_REPLAY_UNITS_MAX];
    int unit_count;
    struct rb_cell in_place;
    bool frames_wanted; // some unit has rays of the image
    double probe_ns;
};

// What is replayed, and the times, on standard output (replay_table.c).
void rb_replay_print_head(const struct rb_replay_run *run);
void rb_replay_print(const struct rb_replay_run *run);

#endif
