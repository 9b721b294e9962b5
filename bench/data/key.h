// The columns that say what a line of our tables is about, in the order of the files: a cell, and
// in kernels.csv the part of it.
#ifndef RB_DATA_KEY_H
#define RB_DATA_KEY_H

enum rb_key {
    RB_KEY_SCENE,
    RB_KEY_WIDTH,
    RB_KEY_HEIGHT,
    RB_KEY_DEPTH,
    RB_KEY_AA,
    RB_KEY_LIGHT_SAMPLES,
    RB_KEY_TILE,
    RB_KEY_VARIANT,
    RB_KEY_THREADS,
    RB_KEY_CELL, // so many name a cell
    RB_KEY_KERNEL = RB_KEY_CELL,
    RB_KEY_BOUNCE,
    RB_KEY_COUNT,
};

extern const char *const rb_key_names[RB_KEY_COUNT];

#endif
