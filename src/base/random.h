// Random numbers that are a pure function of what they are for, so that no order of work, no batch
// and no thread can change them.
#ifndef RB_BASE_RANDOM_H
#define RB_BASE_RANDOM_H

#include "base/hash.h"

// Uniform in [0, 1), 24 bits, keyed by seed, pixel, sample of the pixel, path (1 is the camera ray;
// the children of p are 2p and 2p + 1) and dimension.
static inline float rb_random(uint64_t seed, uint32_t pixel, uint32_t sample, uint32_t path,
                              uint32_t dimension)
{
    uint64_t h = rb_hash_word(seed, (uint64_t)pixel << 32 | sample);
    h = rb_hash_word(h, (uint64_t)path << 32 | dimension);
    return (float)(h >> 40) * 0x1p-24f;
}

#endif
