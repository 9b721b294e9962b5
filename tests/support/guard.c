#define _DEFAULT_SOURCE
#include "tests/support/guard.h"

#include "tests/support/stage.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

// Bytes checked before an array where its pages have that many.
enum { LEAD = 256 };

enum type { FLOAT, WORD, LONG, BYTE };
static const size_t size_of[] = {sizeof(float), sizeof(uint32_t), sizeof(uint64_t), 1};

// One member array of a queue.
struct array {
    const char *name;
    size_t at; // of the pointer within struct queue
    enum type type;
};

#define ARRAY(part, member, type)                                                                  \
    {                                                                                              \
#member, offsetof(struct queue, part.member), type                                         \
    }
static const struct array rays[] = {
    ARRAY(rays, ox, FLOAT),     ARRAY(rays, oy, FLOAT),   ARRAY(rays, oz, FLOAT),
    ARRAY(rays, dx, FLOAT),     ARRAY(rays, dy, FLOAT),   ARRAY(rays, dz, FLOAT),
    ARRAY(rays, weight, FLOAT), ARRAY(rays, pixel, WORD), ARRAY(rays, path, WORD),
    ARRAY(rays, self, WORD),    ARRAY(rays, media, LONG),
};
static const struct array hits[] = {
    ARRAY(hits, t, FLOAT),
    ARRAY(hits, u, FLOAT),
    ARRAY(hits, v, FLOAT),
    ARRAY(hits, prim, WORD),
};
static const struct array surfaces[] = {
    ARRAY(surfaces, px, FLOAT),     ARRAY(surfaces, py, FLOAT),    ARRAY(surfaces, pz, FLOAT),
    ARRAY(surfaces, nx, FLOAT),     ARRAY(surfaces, ny, FLOAT),    ARRAY(surfaces, nz, FLOAT),
    ARRAY(surfaces, vx, FLOAT),     ARRAY(surfaces, vy, FLOAT),    ARRAY(surfaces, vz, FLOAT),
    ARRAY(surfaces, weight, FLOAT), ARRAY(surfaces, pixel, WORD),  ARRAY(surfaces, path, WORD),
    ARRAY(surfaces, prim, WORD),    ARRAY(surfaces, inside, BYTE), ARRAY(surfaces, material, WORD),
};
static const struct array shadows[] = {
    ARRAY(shadows, ox, FLOAT),      ARRAY(shadows, oy, FLOAT),       ARRAY(shadows, oz, FLOAT),
    ARRAY(shadows, dx, FLOAT),      ARRAY(shadows, dy, FLOAT),       ARRAY(shadows, dz, FLOAT),
    ARRAY(shadows, r, FLOAT),       ARRAY(shadows, g, FLOAT),        ARRAY(shadows, b, FLOAT),
    ARRAY(shadows, self, WORD),     ARRAY(shadows, distance, FLOAT), ARRAY(shadows, pixel, WORD),
    ARRAY(shadows, occluded, BYTE),
};

static const struct {
    const struct array *arrays;
    int count;
    size_t length, capacity; // where these are within struct queue; 0 if there are none
} kinds[] = {
    [QUEUE_RAYS] = {rays, sizeof rays / sizeof *rays, offsetof(struct queue, rays.count),
                    offsetof(struct queue, rays.capacity)},
    [QUEUE_HITS] = {hits, sizeof hits / sizeof *hits, 0, 0},
    [QUEUE_SURFACES] = {surfaces, sizeof surfaces / sizeof *surfaces,
                        offsetof(struct queue, surfaces.count),
                        offsetof(struct queue, surfaces.capacity)},
    [QUEUE_SHADOWS] = {shadows, sizeof shadows / sizeof *shadows,
                       offsetof(struct queue, shadows.count),
                       offsetof(struct queue, shadows.capacity)},
};

void guard_open(struct guard *guard, size_t bytes)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    guard->bytes = (bytes + page - 1) / page * page;
    unsigned char *all = mmap(NULL, guard->bytes + 2 * page, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (all == MAP_FAILED)
        stage_give_up("no memory");
    guard->usable = all + page;
    if (mprotect(all, page, PROT_NONE) || mprotect(guard->usable + guard->bytes, page, PROT_NONE))
        stage_give_up("no guard pages");
}

void guard_close(struct guard *guard)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    munmap(guard->usable - page, guard->bytes + 2 * page);
    *guard = (struct guard){0};
}

void *guard_tail(const struct guard *guard, size_t bytes)
{
    return guard->usable + guard->bytes - bytes;
}

static void (*crash_describe)(void);

// The fault is synchronous, in a kernel, which holds no lock: printing is safe.
static void crash(int number, siginfo_t *info, void *context)
{
    (void)context;
    printf("Bail out! signal %d at address %p\n", number, info->si_addr);
    crash_describe();
    fflush(stdout);
    _exit(1);
}

void guard_catch_crashes(void (*describe)(void))
{
    struct sigaction action = {.sa_flags = SA_SIGINFO | (int)SA_RESETHAND};
    action.sa_sigaction = crash;
    crash_describe = describe;
    sigaction(SIGSEGV, &action, NULL);
    sigaction(SIGBUS, &action, NULL);
}

static uint32_t round_up(uint32_t count)
{
    return (count + RB_LANES_MAX - 1) / RB_LANES_MAX * RB_LANES_MAX;
}

static unsigned char *array_of(const struct queue *queue, int a)
{
    unsigned char *array; // all object pointers look alike here, as in render/queues.c
    memcpy(&array, (const char *)queue + kinds[queue->kind].arrays[a].at, sizeof array);
    return array;
}

void queue_open(struct queue *queue, enum queue_kind kind, uint32_t most)
{
    *queue = (struct queue){.kind = kind};
    for (int a = 0; a < kinds[kind].count; a++)
        guard_open(&queue->memory[a], round_up(most) * size_of[kinds[kind].arrays[a].type]);
}

void queue_close(struct queue *queue)
{
    for (int a = 0; a < kinds[queue->kind].count; a++)
        guard_close(&queue->memory[a]);
}

static size_t lead_of(const struct queue *queue, int a)
{
    size_t lead = (size_t)(array_of(queue, a) - queue->memory[a].usable);
    return lead < LEAD ? lead : LEAD;
}

void queue_place(struct queue *queue, uint32_t before, uint32_t added, uint32_t spare,
                 unsigned char fill)
{
    uint32_t capacity = before + added + spare;
    queue->before = before;
    queue->promised = before + added;
    queue->room = round_up(capacity);
    queue->fill = fill;
    for (int a = 0; a < kinds[queue->kind].count; a++) {
        const struct array *array = &kinds[queue->kind].arrays[a];
        size_t bytes = queue->room * size_of[array->type];
        unsigned char *data = guard_tail(&queue->memory[a], bytes);
        memcpy((char *)queue + array->at, &data, sizeof data);
        size_t lead = lead_of(queue, a);
        memset(data - lead, fill, lead + bytes);
    }
    queue_set_count(queue, before);
    if (kinds[queue->kind].capacity)
        memcpy((char *)queue + kinds[queue->kind].capacity, &capacity, sizeof capacity);
}

uint32_t queue_count(const struct queue *queue)
{
    uint32_t count = queue->promised;
    if (kinds[queue->kind].length)
        memcpy(&count, (const char *)queue + kinds[queue->kind].length, sizeof count);
    return count;
}

void queue_set_count(struct queue *queue, uint32_t count)
{
    if (kinds[queue->kind].length)
        memcpy((char *)queue + kinds[queue->kind].length, &count, sizeof count);
}

void queue_copy(struct queue *to, uint32_t at, const struct queue *from, uint32_t first,
                uint32_t count)
{
    for (int a = 0; a < kinds[to->kind].count; a++) {
        size_t size = size_of[kinds[to->kind].arrays[a].type];
        memcpy(array_of(to, a) + at * size, array_of(from, a) + first * size, count * size);
    }
}

void queue_pad(struct queue *queue, enum queue_padding padding)
{
    static const unsigned char bytes[] = {0x00, 0xff, 0xa5};
    uint32_t count = queue_count(queue);
    for (int a = 0; a < kinds[queue->kind].count; a++) {
        size_t size = size_of[kinds[queue->kind].arrays[a].type];
        unsigned char *array = array_of(queue, a);
        for (uint32_t i = count; i < round_up(count); i++) {
            if (padding == PADDING_STALE && count)
                memcpy(array + i * size, array + i % count * size, size);
            else
                memset(array + i * size, bytes[padding % PADDING_STALE], size);
        }
    }
}

static bool same_float(const unsigned char *a, const unsigned char *b)
{
    float x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return memcmp(a, b, sizeof x) == 0 || (x != x && y != y);
}

uint32_t queue_difference(const struct queue *a, const struct queue *b)
{
    uint32_t count_a = queue_count(a), count_b = queue_count(b);
    uint32_t count = count_a < count_b ? count_a : count_b;
    uint32_t first = count_a == count_b ? RB_NONE : count;
    if (count > a->room || count > b->room)
        return 0;
    for (int k = 0; k < kinds[a->kind].count; k++) {
        enum type type = kinds[a->kind].arrays[k].type;
        size_t size = size_of[type];
        const unsigned char *x = array_of(a, k), *y = array_of(b, k);
        if (memcmp(x, y, count * size) == 0)
            continue;
        for (uint32_t i = 0; i < count && i < first; i++) {
            const unsigned char *xi = x + i * size, *yi = y + i * size;
            if (type == FLOAT ? !same_float(xi, yi) : memcmp(xi, yi, size) != 0)
                first = i;
        }
    }
    return first;
}

// First byte of [from, to) that is not `fill`, or `to`.
static size_t first_touched(const unsigned char *bytes, size_t from, size_t to, unsigned char fill)
{
    while (from < to && bytes[from] == fill)
        from++;
    return from;
}

const char *queue_trespass(const struct queue *queue, long *element)
{
    for (int a = 0; a < kinds[queue->kind].count; a++) {
        const struct array *array = &kinds[queue->kind].arrays[a];
        size_t size = size_of[array->type], lead = lead_of(queue, a), before = queue->before * size;
        size_t limit = round_up(queue->promised) * size, end = queue->room * size;
        const unsigned char *start = array_of(queue, a) - lead;
        size_t low = first_touched(start, 0, lead + before, queue->fill);
        size_t high = first_touched(start, lead + limit, lead + end, queue->fill);
        if (low == lead + before && high == lead + end)
            continue;
        long offset = (long)(low < lead + before ? low : high) - (long)lead;
        *element = (offset < 0 ? offset - (long)size + 1 : offset) / (long)size;
        return array->name;
    }
    return NULL;
}

void float_print(FILE *stream, float x)
{
    const char *sign = signbit(x) ? "-" : "";
    if (isnan(x))
        fprintf(stream, "%sNAN", sign);
    else if (isinf(x))
        fprintf(stream, "%sINFINITY", sign);
    else
        fprintf(stream, "%af", (double)x);
}

void queue_print(FILE *stream, const struct queue *queue, uint32_t i)
{
    if (i >= queue->room) {
        fprintf(stream, "nothing");
        return;
    }
    for (int a = 0; a < kinds[queue->kind].count; a++) {
        const struct array *array = &kinds[queue->kind].arrays[a];
        const unsigned char *data = array_of(queue, a) + i * size_of[array->type];
        float x;
        uint32_t word;
        uint64_t two;
        fprintf(stream, "%s.%s = ", a ? ", " : "{", array->name);
        if (array->type == FLOAT)
            memcpy(&x, data, sizeof x), float_print(stream, x);
        else if (array->type == WORD)
            memcpy(&word, data, sizeof word), fprintf(stream, "%#xu", word);
        else if (array->type == LONG)
            memcpy(&two, data, sizeof two), fprintf(stream, "%#llxu", (unsigned long long)two);
        else
            fprintf(stream, "%u", *data);
    }
    fprintf(stream, "}");
}
