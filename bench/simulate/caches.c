#include "bench/simulate/caches.h"

#include "bench/machine/machine_read.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What callgrind takes: it allocates a word for each line, and lines are powers of two from 16.
enum { LINE_MIN = 16, LINE_MAX = 4096, LINE_DEFAULT = 64, WAYS_MAX = 4096 };
static const double BYTES_MAX = 1024.0 * 1024 * 1024;

// False unless all of it is possible.
static bool make(double bytes, double ways, double line_bytes, struct rb_cache_geometry *cache)
{
    if (!(bytes >= 1 && bytes <= BYTES_MAX && ways >= 1 && ways <= WAYS_MAX &&
          line_bytes >= LINE_MIN && line_bytes <= LINE_MAX))
        return false;
    uint64_t lines = (uint64_t)bytes / (uint64_t)line_bytes, sets = 1;
    cache->line_bytes = (uint32_t)line_bytes;
    if (cache->line_bytes & (cache->line_bytes - 1) || lines < (uint64_t)ways || lines < 2)
        return false;
    while (2 * sets * (uint64_t)ways <= lines)
        sets *= 2;
    cache->ways = (uint32_t)(lines / sets);
    cache->bytes = sets * cache->ways * cache->line_bytes;
    cache->rounded = cache->ways != (uint32_t)ways || cache->bytes != (uint64_t)bytes;
    return true;
}

static bool read_number(const char **text, bool is_size, double *number)
{
    char *end;
    if ((*text)[0] < '0' || (*text)[0] > '9')
        return false;
    *number = (double)strtoul(*text, &end, 10);
    if (is_size && *end && strchr("KM", *end))
        *number *= *end++ == 'K' ? 1024 : 1024 * 1024;
    *text = end;
    return true;
}

static bool read_comma(const char **text)
{
    return *(*text)++ == ',';
}

static bool parse(const char *text, struct rb_cache_geometry *cache)
{
    double bytes, ways, line_bytes = LINE_DEFAULT;
    if (!read_number(&text, true, &bytes) || !read_comma(&text) ||
        !read_number(&text, false, &ways))
        return false;
    if (*text && (!read_comma(&text) || !read_number(&text, false, &line_bytes)))
        return false;
    return !*text && make(bytes, ways, line_bytes, cache);
}

// The first cache of a level and one of two types, or with level 0 of the highest level.
static bool find(const struct rb_cache *caches, int count, int level, const char *type,
                 struct rb_cache_geometry *cache)
{
    const struct rb_cache *found = NULL;
    for (int i = 0; i < count; i++) {
        bool fits = level ? caches[i].level == level : !found || caches[i].level > found->level;
        bool is = strcmp(caches[i].type, type) == 0 || strcmp(caches[i].type, "Unified") == 0;
        if (fits && is && !(level && found))
            found = &caches[i];
    }
    return found && make(found->bytes, found->ways, found->line_bytes, cache);
}

enum rb_status rb_caches_choose(const char *root, const char *l1, const char *ll,
                                struct rb_caches *caches, struct rb_error *error)
{
    struct rb_cache host[RB_CACHES_MAX];
    int count = rb_machine_caches(root, host);
    const struct {
        const char *option, *text, *type;
        int level;
        struct rb_cache_geometry *cache;
    } wanted[] = {
        {"--l1", l1, "Data", 1, &caches->l1d},
        {"--l1", l1, "Instruction", 1, &caches->l1i},
        {"--ll", ll, "Unified", 0, &caches->ll},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        bool told = find(host, count, wanted[i].level, wanted[i].type, wanted[i].cache);
        // What is said of L1 is about data; instructions have the same where nothing else is known.
        bool heed = wanted[i].text && (wanted[i].cache != &caches->l1i || !told);
        if (heed && !parse(wanted[i].text, wanted[i].cache))
            return rb_error_set(error, RB_INVALID,
                                "%s %.64s: expected SIZE,WAYS or SIZE,WAYS,LINE, such as 32K,8",
                                wanted[i].option, wanted[i].text);
        if (!wanted[i].text && !told)
            return rb_error_set(error, RB_FAILED,
                                "this machine does not tell its caches: give both --l1 and --ll, "
                                "such as --l1 32K,8 --ll 32M,16");
    }
    return RB_OK;
}

void rb_cache_text(const struct rb_cache_geometry *cache, char text[32])
{
    bool mega = cache->bytes % (1024 * 1024) == 0, kilo = cache->bytes % 1024 == 0;
    uint64_t unit = mega ? 1024 * 1024 : kilo ? 1024 : 1;
    snprintf(text, 32, "%" PRIu64 " %s %" PRIu32 "-way", cache->bytes / unit,
             mega   ? "MiB"
             : kilo ? "KiB"
                    : "B",
             cache->ways);
}
