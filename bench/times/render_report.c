#include "bench/times/render_report.h"

#include "scene/generate.h"

#include <math.h>
#include <string.h>

#define PAPER "another machine, 2019"

// Text of the CSV must not end a cell or a line of the table.
static void put_cell(FILE *out, const char *text)
{
    for (; *text; text++)
        if (*text == '|')
            fputs("\\|", out);
        else
            fputc((unsigned char)*text < 0x20 ? ' ' : *text, out);
}

// Three digits, but no exponent for what is large.
static void put_number(FILE *out, double value)
{
    if (isfinite(value))
        fprintf(out, value >= 999.5 ? "%.0f" : "%.3g", value);
    else
        fputc('-', out);
}

static void put_median(FILE *out, const struct rb_render_row *row)
{
    put_number(out, row ? row->median_s : (double)NAN);
    if (row && rb_render_row_estimated(row))
        fputs(" est.", out);
}

static bool has_scene(const struct rb_render_table *table, const char *scene)
{
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(table->rows[i].scene, scene) == 0)
            return true;
    return false;
}

static bool has_estimates(const struct rb_render_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        if (rb_render_row_estimated(&table->rows[i]))
            return true;
    return false;
}

static int most_threads(const struct rb_render_table *table)
{
    int most = 1;
    for (size_t i = 0; i < table->count; i++)
        most = table->rows[i].threads > most ? table->rows[i].threads : most;
    return most;
}

static void put_machine(FILE *out, const struct rb_render_table *table)
{
    if (table->count == 0)
        return;
    const struct rb_render_row *first = table->rows;
    put_cell(out, first->cpu_model[0] ? first->cpu_model : "unknown processor");
    fprintf(out, ", %d thread%s, commit ", most_threads(table), most_threads(table) > 1 ? "s" : "");
    put_cell(out, first->git_commit[0] ? first->git_commit : "unknown");
    fputs(", ", out);
    put_cell(out, first->utc);
}

static void put_head(FILE *out, const struct rb_render_table *table)
{
    fputs("# Render time\n\n"
          "Table 1 of \"Ray Tracing in C\" (2019), measured anew. `make table` writes this file "
          "from\n[table1.csv](table1.csv); do not edit it.\n\n- Machine: ",
          out);
    put_machine(out, table);
    fputs(".\n- Seconds are those of whole processes, `raybench render SCENE --variant V -o "
          "FILE.ppm --quiet`: start, scene,\n  tree, image, file. Figures are medians unless they "
          "say otherwise.\n"
          "- The paper's seconds are from " PAPER
          ": a ratio to them compares machines as much as programs.\n",
          out);
    if (has_estimates(table))
        fputs("- est.: not run in full, but scaled up from small images of the same view; the note "
              "says how.\n",
              out);
}

// The variant of a scene's first row that is not among the earlier rows of the table.
static bool first_of_its_kind(const struct rb_render_table *table, size_t index)
{
    for (size_t i = 0; i < index; i++)
        if (strcmp(table->rows[i].variant, table->rows[index].variant) == 0)
            return false;
    return true;
}

static void put_overview(FILE *out, const struct rb_render_table *table)
{
    fputs("\n## Seconds\n\n| variant |", out);
    for (const struct rb_preset *p = rb_presets; p->name; p++)
        if (has_scene(table, p->name))
            fprintf(out, " %s |", p->name);
    fputs("\n|---|", out);
    for (const struct rb_preset *p = rb_presets; p->name; p++)
        if (has_scene(table, p->name))
            fputs("---:|", out);
    fputs("\n| the paper (" PAPER ") |", out);
    for (const struct rb_preset *p = rb_presets; p->name; p++)
        if (has_scene(table, p->name))
            fprintf(out, " %g |", p->paper_s);
    for (size_t i = 0; i < table->count; i++) {
        if (!first_of_its_kind(table, i))
            continue;
        fputs("\n| ", out);
        put_cell(out, table->rows[i].variant);
        fputs(" |", out);
        for (const struct rb_preset *p = rb_presets; p->name; p++) {
            if (!has_scene(table, p->name))
                continue;
            fputc(' ', out);
            put_median(out, rb_render_table_find(table, p->name, table->rows[i].variant));
            fputs(" |", out);
        }
    }
    fputc('\n', out);
}

static void put_figure(FILE *out, double value, bool estimated)
{
    fputs(" | ", out);
    put_number(out, value);
    if (isfinite(value) && estimated)
        fputs(" est.", out);
}

static void put_row(FILE *out, const struct rb_render_row *row, bool naive_estimated, bool energy)
{
    bool estimated = rb_render_row_estimated(row);
    fputs("| ", out);
    put_cell(out, row->variant);
    fprintf(out, " | %d | %g | ", row->threads, row->paper_s);
    put_median(out, row);
    const double numbers[] = {row->mean_s, row->min_s, row->max_s};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        put_figure(out, numbers[i], false);
    if (energy)
        put_figure(out, row->frame_j, false);
    fprintf(out, " | %d", row->runs);
    put_figure(out, row->speedup_over_naive, estimated || naive_estimated);
    put_figure(out, row->speedup_over_paper, estimated);
    fputs(" | ", out);
    put_cell(out, row->source);
    fputs(" | ", out);
    put_cell(out, row->note);
    fputs(" |\n", out);
}

static void put_scene(FILE *out, const struct rb_render_table *table, const struct rb_preset *scene)
{
    const struct rb_render_row *naive = rb_render_table_find(table, scene->name, "naive");
    bool energy = rb_render_table_has_energy(table);
    fprintf(out,
            "\n## %s\n\n"
            "| variant | threads | paper s | median s | mean s | min s | max s |%s runs | x naive "
            "| x the paper (" PAPER ") | measured by | note |\n"
            "|---|---:|---:|---:|---:|---:|---:|%s---:|---:|---:|---|---|\n",
            scene->name, energy ? " J a frame |" : "", energy ? "---:|" : "");
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(table->rows[i].scene, scene->name) == 0)
            put_row(out, &table->rows[i], naive && rb_render_row_estimated(naive), energy);
}

void rb_render_report_markdown(FILE *out, const struct rb_render_table *table)
{
    put_head(out, table);
    put_overview(out, table);
    for (const struct rb_preset *p = rb_presets; p->name; p++)
        if (has_scene(table, p->name))
            put_scene(out, table, p);
}

// The fastest row of a scene among those that are parallel, or are not. NULL if none has a time.
static const struct rb_render_row *best(const struct rb_render_table *table, const char *scene,
                                        bool parallel)
{
    const struct rb_render_row *fastest = NULL;
    for (const struct rb_render_row *row = table->rows; row < table->rows + table->count; row++)
        if (strcmp(row->scene, scene) == 0 && (strstr(row->variant, "+omp") != NULL) == parallel &&
            isfinite(row->median_s) && (!fastest || row->median_s < fastest->median_s))
            fastest = row;
    return fastest;
}

static void put_best(FILE *out, const struct rb_render_row *row)
{
    put_median(out, row);
    if (row) {
        fputc(' ', out);
        put_cell(out, row->variant);
    }
    fputs(" |", out);
}

void rb_render_report_compact(FILE *out, const struct rb_render_table *table)
{
    fputs("\n| seconds | the paper (" PAPER ") | naive | bvh | best of one thread | best +omp |\n"
          "|---|---:|---:|---:|---:|---:|\n",
          out);
    for (const struct rb_preset *p = rb_presets; p->name; p++) {
        if (!has_scene(table, p->name))
            continue;
        fprintf(out, "| %s | %g | ", p->name, p->paper_s);
        put_median(out, rb_render_table_find(table, p->name, "naive"));
        fputs(" | ", out);
        put_median(out, rb_render_table_find(table, p->name, "bvh"));
        fputs(" | ", out);
        put_best(out, best(table, p->name, false));
        fputc(' ', out);
        put_best(out, best(table, p->name, true));
        fputc('\n', out);
    }
    fputs("\nWhole processes, from start to image file, medians. ", out);
    if (has_estimates(table))
        fputs("est.: scaled up from small images. ", out);
    put_machine(out, table);
    fputs(".\n[report/table1.md](report/table1.md) has all rows, and how they were measured.\n\n",
          out);
}

struct line {
    const char *begin, *end; // end: behind the line feed
    unsigned long number;    // 0: not found
};

// The only line that is `marker`. RB_INVALID if there is none or more than one.
static enum rb_status find_marker(const char *text, size_t length, const char *marker,
                                  struct line *found, struct rb_error *error)
{
    *found = (struct line){0};
    unsigned long number = 1;
    for (const char *at = text, *end = text + length; at < end; number++) {
        const char *feed = memchr(at, '\n', (size_t)(end - at));
        const char *next = feed ? feed + 1 : end;
        size_t size = (size_t)((feed ? feed : end) - at);
        if (size == strlen(marker) && memcmp(at, marker, size) == 0) {
            if (found->number) {
                error->line = number;
                error->column = 1;
                return rb_error_set(error, RB_INVALID, "%s is here again; keep one", marker);
            }
            *found = (struct line){at, next, number};
        }
        at = next;
    }
    return found->number
               ? RB_OK
               : rb_error_set(error, RB_INVALID, "there is no line %s; put it back", marker);
}

enum rb_status rb_render_report_readme(FILE *out, const char *text, size_t length,
                                       const struct rb_render_table *table, struct rb_error *error)
{
    struct line begin, end;
    if (find_marker(text, length, RB_README_BEGIN, &begin, error) ||
        find_marker(text, length, RB_README_END, &end, error))
        return RB_INVALID;
    if (end.number < begin.number) {
        error->line = end.number;
        error->column = 1;
        return rb_error_set(error, RB_INVALID, "%s comes before its beginning", RB_README_END);
    }
    fwrite(text, 1, (size_t)(begin.end - text), out);
    rb_render_report_compact(out, table);
    fwrite(end.begin, 1, (size_t)(text + length - end.begin), out);
    return RB_OK;
}
