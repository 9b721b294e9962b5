// Geometry of the simulated caches: that of the host or as the user says, and in any case pinned
// and kept with the results, for it decides the misses.
#ifndef RB_SIMULATE_CACHES_H
#define RB_SIMULATE_CACHES_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct rb_cache_geometry {
    uint64_t bytes;
    uint32_t ways, line_bytes;
    bool rounded; // what was asked for has no power of two of sets, and cannot be simulated
};

struct rb_caches {
    struct rb_cache_geometry l1i, l1d, ll; // ll: the last level
};

// Fills the geometry from this machine's first and last levels (`root` as in rb_machine_read), and
// over that from the texts "SIZE,WAYS" or "SIZE,WAYS,LINE" such as "32K,8" or "1M,16,64"; NULL
// where nothing was said. `l1` is that of data. Sets that are no power of two become the next lower
// one with as many ways as it takes to keep the size. RB_FAILED where the machine does not tell,
// RB_INVALID for a text that is no cache.
enum rb_status rb_caches_choose(const char *root, const char *l1, const char *ll,
                                struct rb_caches *caches, struct rb_error *error);

// "32 KiB 8-way", at most 31 characters.
void rb_cache_text(const struct rb_cache_geometry *cache, char text[32]);

#endif
