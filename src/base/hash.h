// 64-bit mixing for hashes and keyed random numbers.
#ifndef RB_BASE_HASH_H
#define RB_BASE_HASH_H

#include <stdint.h>
#include <string.h>

// The finaliser of splitmix64 (Steele, Lea, Flood 2014): a bijection whose every output bit depends
// on every input bit.
static inline uint64_t rb_mix(uint64_t x)
{
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// Folds one more word into a running hash; the order of the words matters.
static inline uint64_t rb_hash_word(uint64_t hash, uint64_t word)
{
    return rb_mix(hash + 0x9e3779b97f4a7c15u + word);
}

static inline uint32_t rb_float_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

#endif
