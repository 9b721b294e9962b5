#include "bench/data/changes.h"

#include "base/hash.h"
#include "base/memory.h"

#include <math.h>

// With 999 permutations, the p-value is a multiple of 1/1000.
enum { PERMUTATIONS = 999, SIGNIFICANT = 10 };

struct search {
    const double *values;
    bool *starts;
    double *ranks; // of the stretch
};

// Ranks from 1 on; those of equal values are their mean.
static void rank(const double *values, size_t count, double *ranks)
{
    for (size_t i = 0; i < count; i++) {
        double below = 0, equal = 0;
        for (size_t j = 0; j < count; j++) {
            below += values[j] < values[i];
            equal += values[j] == values[i];
        }
        ranks[i] = below + (equal + 1) / 2;
    }
}

// The largest |U|, where U is how far the ranks of the first values are above the others'; where
// those end goes to `place`.
static double pettitt(const double *ranks, size_t count, size_t *place)
{
    double sum = 0, largest = 0;
    *place = 0;
    for (size_t i = 1; i < count; i++) {
        sum += ranks[i - 1];
        double u = fabs(2 * sum - (double)i * (double)(count + 1));
        if (u > largest) {
            largest = u;
            *place = i;
        }
    }
    return largest;
}

static void shuffle(double *ranks, size_t count, uint64_t seed)
{
    for (size_t i = count - 1; i > 0; i--) {
        size_t j = (size_t)(rb_hash_word(seed, i) % (i + 1));
        double rank = ranks[i];
        ranks[i] = ranks[j];
        ranks[j] = rank;
    }
}

// Does chance rarely do as well as the order these values came in?
static bool is_change(double *ranks, size_t count, double statistic)
{
    size_t as_well = 1, place;
    for (uint64_t i = 0; i < PERMUTATIONS && as_well <= SIGNIFICANT; i++) {
        shuffle(ranks, count, i);
        as_well += pettitt(ranks, count, &place) >= statistic;
    }
    return as_well <= SIGNIFICANT;
}

static void find(struct search *search, size_t first, size_t count)
{
    size_t place;
    rank(search->values + first, count, search->ranks);
    double statistic = pettitt(search->ranks, count, &place);
    if (place == 0 || !is_change(search->ranks, count, statistic))
        return;
    search->starts[first + place] = true;
    find(search, first, place);
    find(search, first + place, count - place);
}

bool rb_changes_find(const double *values, size_t count, bool *starts)
{
    struct search search = {values, starts, rb_alloc(count, sizeof(double))};
    for (size_t i = 0; i < count; i++)
        starts[i] = false;
    if (search.ranks && count)
        find(&search, 0, count);
    rb_free(search.ranks);
    return search.ranks;
}
