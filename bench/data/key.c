#include "bench/data/key.h"

const char *const rb_key_names[RB_KEY_COUNT] = {
    "scene", "width",   "height",  "depth",  "aa",     "light_samples",
    "tile",  "variant", "threads", "kernel", "bounce",
};
