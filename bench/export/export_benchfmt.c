// Go's benchmark format (golang.org/design/14313-benchmark-format), one line for each process, so
// that benchstat has samples. Its configuration lines split benchstat's tables where they differ,
// and are kept to what makes times incomparable; the rest of the provenance is in comments.
#include "bench/data/json_read.h"
#include "bench/export/export.h"

#include <ctype.h>
#include <math.h>

enum { VALUE_MAX = 512 };

// "trace_shadow" -> "BenchmarkTraceShadow". Anything but letters and digits separates words.
static void put_kernel(FILE *out, const char *kernel)
{
    fputs("Benchmark", out);
    bool begins = true;
    for (const unsigned char *c = (const unsigned char *)kernel; *c; c++) {
        if (isalnum(*c))
            fputc(begins ? toupper(*c) : *c, out);
        begins = !isalnum(*c);
    }
}

// One line: no control characters, ASCII.
static void put_line(FILE *out, const char *prefix, const char *key, const char *value)
{
    if (!value[0])
        return;
    fprintf(out, "%s%s: ", prefix, key);
    for (const unsigned char *c = (const unsigned char *)value; *c; c++)
        fputc(*c >= ' ' && *c <= '~' ? *c : '?', out);
    fputc('\n', out);
}

static void put_configuration(FILE *out, const struct rb_export *result)
{
    static const struct {
        const char *prefix, *key, *path;
    } lines[] = {
        {"", "host", "host.name"},         {"", "cpu", "host.cpu_model"},
        {"# ", "session", "session"},      {"# ", "commit", "git.commit"},
        {"# ", "dirty", "git.dirty"},      {"# ", "seed", "seed"},
        {"# ", "command", "command_line"},
    };
    char value[VALUE_MAX];
    put_line(out, "", "pkg", "raybench");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        rb_json_get_text(rb_json_find(result->env, lines[i].path), value, sizeof value);
        put_line(out, lines[i].prefix, lines[i].key, value);
    }
    put_line(out, "# ", "date", result->stamp);
    fprintf(out, "Unit ns/ray better=lower\n"
                 "Unit wall-ns/ray better=lower\n"
                 "Unit thread-ns/op better=lower\n"
                 "Unit Mrays/s better=higher\n\n");
}

// Per ray, ns/ray is the time of all threads, as in kernels.csv. Else an op is a frame; ns/op is
// the time that passed, thread-ns/op that of all threads.
static void put_run(FILE *out, const struct rb_export_series *series,
                    const struct rb_export_run *run)
{
    bool per_ray = series->key[RB_KEY_BOUNCE][0] != '\0', wall = isfinite(run->wall_ns);
    put_kernel(out, series->key[RB_KEY_KERNEL]);
    rb_export_put_name(out, series->key, '=');
    fprintf(out, "-%s\t%.0f", series->key[RB_KEY_THREADS], run->iterations);
    if (per_ray) {
        fprintf(out, "\t%.9g ns/ray", run->work_ns);
        if (wall)
            fprintf(out, "\t%.9g wall-ns/ray", run->wall_ns);
    } else if (wall) {
        fprintf(out, "\t%.9g ns/op\t%.9g thread-ns/op", run->wall_ns, run->work_ns);
    } else {
        fprintf(out, "\t%.9g thread-ns/op", run->work_ns);
    }
    if (isfinite(run->mrays_per_s))
        fprintf(out, "\t%.9g Mrays/s", run->mrays_per_s);
    fputc('\n', out);
}

enum rb_status rb_export_benchfmt(const struct rb_export *result, FILE *out, struct rb_error *error)
{
    (void)error;
    put_configuration(out, result);
    const struct rb_export_series *series = result->series.data;
    for (size_t i = 0; i < result->series.count; i++) {
        struct rb_export_run run;
        for (size_t at = 0; rb_export_next_run(result, &series[i], &at, &run);)
            put_run(out, &series[i], &run);
    }
    return RB_OK;
}
