#include "bench/gate/report.h"

#include "base/file.h"
#include "bench/compare/compare_print.h"
#include "bench/gate/report_json.h"
#include "bench/gate/row.h"
#include "cli/commands.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { PLACES_SHOWN = 20 };

void rb_gate_report_add(struct rb_gate_report *report, const struct rb_gate_row *row, bool shown)
{
    report->counts[row->moved]++;
    if (shown && !rb_array_push(&report->rows, row, sizeof *row))
        report->incomplete = true;
}

static void put_text(char text[RB_GATE_TEXT_MAX], const char *format, va_list values)
{
    vsnprintf(text, RB_GATE_TEXT_MAX, format, values);
}

void rb_gate_report_note(struct rb_gate_report *report, const char *format, ...)
{
    char note[RB_GATE_TEXT_MAX];
    va_list values;
    va_start(values, format);
    put_text(note, format, values);
    va_end(values);
    if (!rb_array_push(&report->notes, note, sizeof note))
        report->incomplete = true;
}

void rb_gate_report_judge(struct rb_gate_report *report, int code, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    put_text(report->verdict, format, values);
    va_end(values);
    report->code = code;
}

void rb_gate_report_worst(const struct rb_gate_report *report, char text[RB_GATE_TEXT_MAX])
{
    const struct rb_gate_row *rows = report->rows.data, *worst = NULL;
    char place[RB_GATE_PLACE_MAX];
    for (size_t i = 0; i < report->rows.count; i++)
        if (!worst || rows[i].moved < worst->moved ||
            (rows[i].moved == worst->moved && rows[i].ratio > worst->ratio))
            worst = &rows[i];
    text[0] = '\0';
    if (!worst)
        return;
    rb_gate_row_place(worst, place);
    if (isinf(worst->ratio))
        snprintf(text, RB_GATE_TEXT_MAX, "%.400s: %.32s from 0 to %.10g", place, worst->figure,
                 worst->head);
    else
        snprintf(text, RB_GATE_TEXT_MAX, "%.400s: %.32s %+.2f %%", place, worst->figure,
                 100 * (worst->ratio - 1));
}

// How a report is laid out: as a terminal or as Markdown has it.
struct layout {
    const char *verdict, *place, *row, *command, *rest, *note;
};

static const struct layout terminal = {
    .verdict = "%s: %s\n",
    .place = "\n%s\n",
    .row = "  %-15s %12.10g -> %-12.10g x %-8.4f %-18s %-15s %s%s\n",
    .command = "  %s\n",
    .rest = "\n%zu more places moved\n",
    .note = "%s\n",
};

static const struct layout markdown = {
    .verdict = "**raybench %s: %s**\n",
    .place = "\n%s\n\n| figure | base | head | ratio | interval | noise | |\n"
             "|---|---:|---:|---:|---|---|---|\n",
    .row = "| %s | %.10g | %.10g | %.4f | %s | %s | %s%s |\n",
    .command = "\n    %s\n",
    .rest = "\n%zu more places moved\n",
    .note = "\n%s\n",
};

static void put_row(const struct layout *layout, const struct rb_gate_row *row, FILE *out)
{
    char interval[48] = "exact", noise[48] = "", reason[160] = "";
    if (!isnan(row->low))
        snprintf(interval, sizeof interval, "%.4f to %.4f", row->low, row->high);
    else if (row->moved == RB_MOVED_UNDECIDED)
        snprintf(interval, sizeof interval, "none");
    if (!isnan(row->floor))
        snprintf(noise, sizeof noise, "noise %.2f %%", 100 * (row->floor - 1));
    if (row->reason[0])
        snprintf(reason, sizeof reason, ": %s", row->reason);
    fprintf(out, layout->row, row->figure, row->base, row->head, row->ratio, interval, noise,
            rb_moved_names[row->moved], reason);
}

// The rows of one place, and what shows it.
static void put_place(const struct layout *layout, const struct rb_gate_row *rows, size_t count,
                      FILE *out)
{
    char place[RB_GATE_PLACE_MAX], command[RB_GATE_COMMAND_MAX];
    rb_gate_row_place(rows, place);
    rb_gate_row_command(rows, command);
    fprintf(out, layout->place, place);
    for (size_t i = 0; i < count; i++)
        put_row(layout, &rows[i], out);
    fprintf(out, layout->command, command);
}

// Of the rows of one place, from the first on; how many they are goes to `count`.
static enum rb_moved worst_of(const struct rb_gate_report *report, size_t first, size_t *count)
{
    const struct rb_gate_row *rows = report->rows.data;
    enum rb_moved worst = RB_MOVED_NOT;
    for (*count = 0; first + *count < report->rows.count &&
                     rb_gate_row_same_place(&rows[first], &rows[first + *count]);
         ++*count)
        worst = rows[first + *count].moved < worst ? rows[first + *count].moved : worst;
    return worst;
}

// What is worse comes first, and of that not more than one wants to read.
static void put_places(const struct layout *layout, const struct rb_gate_report *report, FILE *out)
{
    const struct rb_gate_row *rows = report->rows.data;
    size_t shown = 0, left = 0, count;
    for (int moved = 0; moved < RB_MOVED_COUNT; moved++)
        for (size_t i = 0; i < report->rows.count; i += count) {
            if (worst_of(report, i, &count) != (enum rb_moved)moved)
                continue;
            if (shown++ < PLACES_SHOWN)
                put_place(layout, &rows[i], count, out);
            else
                left++;
        }
    if (left)
        fprintf(out, layout->rest, left);
}

static void put_report(const struct layout *layout, const struct rb_gate_report *report, FILE *out)
{
    const char(*notes)[RB_GATE_TEXT_MAX] = report->notes.data;
    fprintf(out, layout->verdict, report->name, report->verdict);
    for (size_t i = 0; i < report->notes.count; i++)
        fprintf(out, layout->note, notes[i]);
    put_places(layout, report, out);
}

static void put_terminal(const struct rb_gate_report *report, FILE *out)
{
    put_report(&terminal, report, out);
}

static void put_markdown(const struct rb_gate_report *report, FILE *out)
{
    put_report(&markdown, report, out);
}

typedef void put_fn(const struct rb_gate_report *report, FILE *out);

static enum rb_status put_file(const struct rb_gate_report *report, const char *path, put_fn *put,
                               struct rb_error *error)
{
    static struct rb_output output;
    enum rb_status status = path ? rb_output_open(&output, path, error) : RB_OK;
    if (!path || status)
        return status;
    put(report, output.stream);
    return rb_output_commit(&output, error);
}

int rb_gate_report_put(const struct rb_gate_report *report, const char *markdown_path,
                       const char *json_path)
{
    struct rb_error error = {0};
    put_terminal(report, stdout);
    enum rb_status status = put_file(report, markdown_path, put_markdown, &error);
    if (!status)
        status = put_file(report, json_path, rb_gate_report_json, &error);
    if (!status && report->incomplete)
        status = rb_error_memory(&error, "the report");
    if (!status)
        return report->code;
    rb_report(status, &error);
    return RB_GATE_INVALID;
}

void rb_gate_report_free(struct rb_gate_report *report)
{
    rb_array_release(&report->rows);
    rb_array_release(&report->notes);
}
