#include "bench/machine/peaks.h"

#include "base/file.h"
#include "base/memory.h"
#include "bench/data/csv_write.h"
#include "bench/machine/machine.h"
#include "cli/commands.h"
#include "measure/clock.h"

#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_peaks = {
    .name = "peaks",
    .summary = "measure the most that one thread of this machine gets through",
    .synopsis = "[RESULT]",
    .text =
        "Cycles, instructions, and bytes read from each level of memory, in a nanosecond: what\n"
        "times of kernels are held against. Takes a second. With RESULT, a folder of results\n"
        "from this machine, they are written to RESULT/peaks.csv, where the report's roofline\n"
        "finds them.\n\n"
        "  raybench peaks results/latest\n\n"
        "Instructions: the best of some loops of independent additions. Bytes: loads of 16,\n"
        "the most that all machines have; wider ones may get more from the first level.",
    .positional_min = 0,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){NULL},
    .run = run,
};

enum { RUNS = 2000, ROUNDS = 2000 };

// The shortest of some runs, which others on this machine disturb least.
static uint64_t least_ns(uint64_t (*timed_ns)(void))
{
    uint64_t least = UINT64_MAX;
    for (int i = 0; i < RUNS; i++) {
        uint64_t ns = timed_ns();
        least = ns < least ? ns : least;
    }
    return least;
}

#if defined(__x86_64__)
#define FLOAT_REGISTER "+x"
#elif defined(__aarch64__)
#define FLOAT_REGISTER "+w"
#else
#define FLOAT_REGISTER "+m"
#endif

// An addition that the compiler can neither leave out nor join with others.
static inline void add(uint64_t *a)
{
    *a += 1;
    __asm__ volatile("" : "+r"(*a));
}

static inline void add_float(float *a)
{
    *a += 1.0f;
    __asm__ volatile("" : FLOAT_REGISTER(*a));
}

enum { CHAIN = 8 };

static uint64_t chain_ns(void)
{
    uint64_t start_ns = rb_clock_ns(), a = 0;
    for (int i = 0; i < ROUNDS; i++) {
#pragma GCC unroll 8
        for (int k = 0; k < CHAIN; k++)
            add(&a);
    }
    return rb_clock_ns() - start_ns;
}

double rb_peak_cycles_per_ns(void)
{
    return (double)ROUNDS * CHAIN / (double)least_ns(chain_ns);
}

enum { INTEGERS = 16, FLOATS = 8 };

static uint64_t integers_ns(void)
{
    uint64_t start_ns = rb_clock_ns(), a = 0, b = 0, c = 0, d = 0;
    for (int i = 0; i < ROUNDS; i++) {
#pragma GCC unroll 4
        for (int k = 0; k < INTEGERS / 4; k++)
            add(&a), add(&b), add(&c), add(&d);
    }
    return rb_clock_ns() - start_ns;
}

static uint64_t both_ns(void)
{
    uint64_t start_ns = rb_clock_ns(), a = 0, b = 0, c = 0, d = 0;
    float p = 0, q = 0, r = 0, s = 0, t = 0, u = 0, v = 0, w = 0;
    for (int i = 0; i < ROUNDS; i++) {
        add(&a), add(&b), add(&c), add(&d), add_float(&p), add_float(&q);
        add(&a), add(&b), add(&c), add(&d), add_float(&r), add_float(&s);
        add(&a), add(&b), add(&c), add(&d), add_float(&t), add_float(&u);
        add(&a), add(&b), add(&c), add(&d), add_float(&v), add_float(&w);
    }
    return rb_clock_ns() - start_ns;
}

double rb_peak_instructions_per_ns(void)
{
    double integers = (double)ROUNDS * INTEGERS / (double)least_ns(integers_ns);
    double both = (double)ROUNDS * (INTEGERS + FLOATS) / (double)least_ns(both_ns);
    return integers > both ? integers : both;
}

typedef uint32_t block __attribute__((vector_size(16)));

// Reads it so often that a clock can tell.
static double read_once(const block *blocks, size_t count)
{
    enum { LEAST_BYTES = 1 << 20, UNROLLED = 8 };
    size_t again = LEAST_BYTES / (count * sizeof *blocks) + 1;
    block sums[UNROLLED] = {{0}};
    uint64_t start_ns = rb_clock_ns();
    for (size_t i = 0; i < again; i++)
        for (size_t k = 0; k < count; k += UNROLLED) {
#pragma GCC unroll 8
            for (int at = 0; at < UNROLLED; at++)
                sums[at] |= blocks[k + (size_t)at];
        }
    uint64_t ns = rb_clock_ns() - start_ns;
    for (int at = 1; at < UNROLLED; at++)
        sums[0] |= sums[at];
    __asm__ volatile("" : : "m"(sums[0])); // or the compiler would drop the reads
    return (double)(again * count * sizeof *blocks) / (double)(ns ? ns : 1);
}

double rb_peak_bytes_per_ns(const void *memory, size_t bytes)
{
    enum { LEAST_RUNS = 4, LEAST_MS = 40 };
    double most = 0;
    uint64_t end_ns = rb_clock_ns() + LEAST_MS * 1000000ull;
    for (int i = 0; i < LEAST_RUNS || rb_clock_ns() < end_ns; i++) {
        double now = read_once(memory, bytes / sizeof(block));
        most = now > most ? now : most;
    }
    return most;
}

// What fits into each level, and what fits into none.
struct level {
    char name[8];
    size_t bytes;
};

enum { LEVELS_MAX = RB_CACHES_MAX + 1 };

static int levels_of(const struct rb_machine *machine, struct level levels[LEVELS_MAX])
{
    int count = 0;
    size_t largest = 0;
    for (int i = 0; i < machine->cache_count; i++) {
        const struct rb_cache *cache = &machine->caches[i];
        if (strcmp(cache->type, "Instruction") == 0 || !(cache->bytes >= 1024))
            continue;
        snprintf(levels[count].name, sizeof levels[count].name, "L%d", cache->level % 10);
        levels[count++].bytes = (size_t)cache->bytes / 2 & ~(size_t)255;
        largest = (size_t)cache->bytes > largest ? (size_t)cache->bytes : largest;
    }
    levels[count] = (struct level){"memory", 4 * (largest ? largest : (size_t)16 << 20)};
    return count + 1;
}

struct peaks {
    double cycles_per_ns, instructions_per_ns;
    struct level levels[LEVELS_MAX];
    double bytes_per_ns[LEVELS_MAX];
    int count;
};

static enum rb_status measure(const struct rb_machine *machine, struct peaks *peaks,
                              struct rb_error *error)
{
    peaks->count = levels_of(machine, peaks->levels);
    size_t most = peaks->levels[peaks->count - 1].bytes;
    unsigned char *memory = rb_alloc(most, 1);
    if (!memory)
        return rb_error_memory(error, "what is read");
    memset(memory, 1, most); // pages of zeros may be one page
    peaks->cycles_per_ns = rb_peak_cycles_per_ns();
    peaks->instructions_per_ns = rb_peak_instructions_per_ns();
    for (int i = 0; i < peaks->count; i++)
        peaks->bytes_per_ns[i] = rb_peak_bytes_per_ns(memory, peaks->levels[i].bytes);
    rb_free(memory);
    return RB_OK;
}

static void print(const struct peaks *peaks)
{
    printf("cycles          %8.3f a ns\n", peaks->cycles_per_ns);
    printf("instructions    %8.3f a ns, %.2f a cycle\n", peaks->instructions_per_ns,
           peaks->instructions_per_ns / peaks->cycles_per_ns);
    for (int i = 0; i < peaks->count; i++)
        printf("bytes of %-6s %8.3f a ns, reading %zu KiB\n", peaks->levels[i].name,
               peaks->bytes_per_ns[i], peaks->levels[i].bytes / 1024);
}

static enum rb_status write_file(const char *folder, const char *cpu, const struct peaks *peaks,
                                 struct rb_error *error)
{
    struct rb_output output;
    char path[RB_OUTPUT_PATH_MAX];
    snprintf(path, sizeof path, "%.4000s/peaks.csv", folder);
    enum rb_status status = rb_output_open(&output, path, error);
    if (status)
        return status;
    fprintf(output.stream, "cpu_model,peak,bytes,per_ns\n");
    for (int i = -2; i < peaks->count; i++) {
        rb_csv_put_text(output.stream, cpu);
        if (i == -2)
            fprintf(output.stream, ",cycles,,%.6g\n", peaks->cycles_per_ns);
        else if (i == -1)
            fprintf(output.stream, ",instructions,,%.6g\n", peaks->instructions_per_ns);
        else
            fprintf(output.stream, ",%s,%zu,%.6g\n", peaks->levels[i].name, peaks->levels[i].bytes,
                    peaks->bytes_per_ns[i]);
    }
    return rb_output_commit(&output, error);
}

static int run(const struct rb_arguments *arguments)
{
    struct rb_machine machine;
    struct peaks peaks;
    struct rb_error error = {0};
    rb_machine_read(&machine, "");
    enum rb_status status = measure(&machine, &peaks, &error);
    if (!status)
        print(&peaks);
    if (!status && arguments->positional_count)
        status = write_file(arguments->positional[0], machine.facts[RB_FACT_CPU_MODEL].text, &peaks,
                            &error);
    return status ? rb_report(status, &error) : 0;
}
