#include "bench/gate/floor.h"

#include "base/file.h"
#include "base/memory.h"
#include "bench/data/csv_write.h"
#include "bench/machine/machine.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Of the newest comparisons of a row, the ratio that strayed farthest from 1, and half as much
// again: with as few as these the next one strays farther now and then. How wide the intervals were
// does not count: the interval of a comparison tells that itself.
enum { NEWEST = 8 };
static const double MARGIN = 1.5;

enum { HOST, KEY, EXCURSION = KEY + RB_KEY_COUNT, COLUMN_COUNT };

static const char *column_name(int column)
{
    if (column == HOST)
        return "host";
    return column == EXCURSION ? "excursion" : rb_key_names[column - KEY];
}

static void identify(char host[256])
{
    static const enum rb_fact_id facts[] = {RB_FACT_HOST_NAME, RB_FACT_CPU_MODEL, RB_FACT_CPUS};
    struct rb_machine machine;
    size_t used = 0;
    rb_machine_read(&machine, "");
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) {
        const struct rb_fact *fact = &machine.facts[facts[i]];
        const char *gap = i ? "; " : "";
        if (fact->kind == RB_FACT_IS_NUMBER)
            used += (size_t)snprintf(host + used, 80, "%s%g", gap, fact->number);
        else
            used += (size_t)snprintf(host + used, 80, "%s%.70s", gap,
                                     fact->kind == RB_FACT_IS_TEXT ? fact->text : "unknown");
    }
}

static enum rb_status check(const struct rb_csv *csv, struct rb_error *error)
{
    bool known = csv->column_count == COLUMN_COUNT;
    for (int i = 0; i < COLUMN_COUNT; i++)
        known = known && rb_csv_column(csv, column_name(i)) == i;
    if (!known)
        return rb_error_set(error, RB_INVALID,
                            "not the noise floors of this version of raybench; delete it, and "
                            "they are learned anew");
    for (size_t row = 0; row < csv->row_count; row++) {
        if (rb_csv_number(csv, row, EXCURSION) >= 1)
            continue;
        rb_csv_place(csv, row, EXCURSION, error);
        return rb_error_set(error, RB_INVALID, "'%.40s': expected a ratio from 1 on",
                            rb_csv_text(csv, row, EXCURSION));
    }
    return RB_OK;
}

static enum rb_status load(struct rb_floor *floor, struct rb_error *error)
{
    rb_csv_free(&floor->csv);
    if (access(floor->path, F_OK) != 0)
        return RB_OK;
    enum rb_status status = rb_csv_load(floor->path, &floor->csv, error);
    return status ? status : check(&floor->csv, error);
}

enum rb_status rb_floor_load(const char *folder, struct rb_floor *floor, struct rb_error *error)
{
    *floor = (struct rb_floor){.csv = {.path = NULL}};
    identify(floor->host);
    snprintf(floor->path, sizeof floor->path, "%.700s/floor.csv", folder);
    return load(floor, error);
}

static void bounce_text(const struct rb_compare_row *row, char text[16])
{
    text[0] = '\0';
    if (row->bounce != RB_ALL_BOUNCES)
        snprintf(text, 16, "%d", row->bounce);
}

double rb_floor_find(const struct rb_floor *floor, const struct rb_timed_cell *cell,
                     const struct rb_compare_row *row, size_t *runs)
{
    char bounce[16];
    double farthest = (double)NAN;
    bounce_text(row, bounce);
    *runs = 0;
    for (size_t i = floor->csv.row_count; i-- > 0 && *runs < NEWEST;) {
        const struct rb_csv *csv = &floor->csv;
        bool same = strcmp(rb_csv_text(csv, i, HOST), floor->host) == 0 &&
                    strcmp(rb_csv_text(csv, i, KEY + RB_KEY_KERNEL),
                           rb_timed_kernels[row->kernel].name) == 0 &&
                    strcmp(rb_csv_text(csv, i, KEY + RB_KEY_BOUNCE), bounce) == 0;
        for (int k = 0; k < RB_KEY_CELL && same; k++)
            same = strcmp(rb_csv_text(csv, i, KEY + k), cell->key[k]) == 0;
        if (same) {
            farthest = fmax(farthest, rb_csv_number(csv, i, EXCURSION));
            ++*runs;
        }
    }
    return *runs ? fmax(RB_FLOOR_LEAST, 1 + MARGIN * (farthest - 1)) : (double)NAN;
}

static void put_row(FILE *out, const char *host, const struct rb_timed_cell *cell,
                    const struct rb_compare_row *row)
{
    char bounce[16];
    bounce_text(row, bounce);
    rb_csv_put_text(out, host);
    for (int i = 0; i < RB_KEY_CELL; i++) {
        fputc(',', out);
        rb_csv_put_text(out, cell->key[i]);
    }
    fprintf(out, ",%s,%s,%.6f\n", rb_timed_kernels[row->kernel].name, bounce,
            fmax(row->ratio.value, 1 / row->ratio.value));
}

enum rb_status rb_floor_learn(struct rb_floor *floor, const struct rb_comparison *comparison,
                              struct rb_error *error)
{
    static struct rb_output output;
    char *old = NULL;
    size_t size = 0;
    enum rb_status status =
        access(floor->path, F_OK) == 0 ? rb_file_read(floor->path, &old, &size, error) : RB_OK;
    if (!status)
        status = rb_output_open(&output, floor->path, error);
    if (!status) {
        for (int i = 0; i < COLUMN_COUNT && !old; i++)
            fprintf(output.stream, "%s%s", column_name(i), i + 1 < COLUMN_COUNT ? "," : "\n");
        fwrite(old ? old : "", 1, size, output.stream);
        for (size_t i = 0; i < comparison->cell_count; i++)
            for (size_t r = 0; r < comparison->cells[i].row_count; r++)
                put_row(output.stream, floor->host, comparison->cells[i].a,
                        &comparison->rows[comparison->cells[i].first_row + r]);
        status = rb_output_commit(&output, error);
    }
    rb_free(old);
    return status ? status : load(floor, error);
}
