#define _POSIX_C_SOURCE 200809L
#include "bench/gate/waivers.h"

#include "base/file.h"
#include "bench/data/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { SCENE, VARIANT, KERNEL, BOUNCE, FIGURE, CEILING, EXPIRES, REASON, COLUMN_COUNT };

static const char *const names[COLUMN_COUNT] = {
    [SCENE] = "scene",   [VARIANT] = "variant",     [KERNEL] = "kernel",   [BOUNCE] = "bounce",
    [FIGURE] = "figure", [CEILING] = "ceiling_pct", [EXPIRES] = "expires", [REASON] = "reason",
};

static const char *text_of(const struct rb_waivers *waivers, size_t row, int column)
{
    return rb_csv_text(&waivers->csv, row, waivers->columns[column]);
}

static bool is_date(const char *text)
{
    int year, month, day, length = 0;
    return strlen(text) == 10 && strspn(text, "0123456789-") == 10 &&
           sscanf(text, "%4d-%2d-%2d%n", &year, &month, &day, &length) == 3 && length == 10 &&
           month >= 1 && month <= 12 && day >= 1 && day <= 31;
}

static bool has_expired(const struct rb_waivers *waivers, size_t row)
{
    return strcmp(text_of(waivers, row, EXPIRES), waivers->today) < 0; // such dates sort as texts
}

static enum rb_status refuse(const struct rb_waivers *waivers, size_t row, int column,
                             const char *what, struct rb_error *error)
{
    rb_csv_place(&waivers->csv, row, waivers->columns[column], error);
    return rb_error_set(error, RB_INVALID, "'%.40s': expected %s", text_of(waivers, row, column),
                        what);
}

static enum rb_status check_row(const struct rb_waivers *waivers, size_t row,
                                struct rb_error *error)
{
    for (int i = SCENE; i <= FIGURE; i++)
        if (!text_of(waivers, row, i)[0])
            return refuse(waivers, row, i, "a name or a pattern, * for all", error);
    if (!(rb_csv_number(&waivers->csv, row, waivers->columns[CEILING]) >= 0))
        return refuse(waivers, row, CEILING, "per cent that pass, such as 3", error);
    if (!is_date(text_of(waivers, row, EXPIRES)))
        return refuse(waivers, row, EXPIRES, "the last day as YYYY-MM-DD", error);
    if (!text_of(waivers, row, REASON)[0])
        return refuse(waivers, row, REASON, "why this may pass", error);
    return RB_OK;
}

static enum rb_status find_columns(struct rb_waivers *waivers, struct rb_error *error)
{
    for (int i = 0; i < COLUMN_COUNT; i++) {
        waivers->columns[i] = rb_csv_column(&waivers->csv, names[i]);
        if (waivers->columns[i] >= 0)
            continue;
        error->line = error->column = 1;
        return rb_error_set(error, RB_INVALID, "no column '%s'", names[i]);
    }
    return RB_OK;
}

enum rb_status rb_waivers_load(const char *folder, struct rb_waivers *waivers,
                               struct rb_gate_report *report, struct rb_error *error)
{
    char path[RB_OUTPUT_PATH_MAX];
    time_t now = time(NULL);
    struct tm utc;
    *waivers = (struct rb_waivers){.columns = {0}};
    strftime(waivers->today, sizeof waivers->today, "%Y-%m-%d", gmtime_r(&now, &utc));
    snprintf(path, sizeof path, "%s/waivers.csv", folder);
    if (access(path, F_OK) != 0)
        return RB_OK;
    enum rb_status status = rb_csv_load(path, &waivers->csv, error);
    if (!status)
        status = find_columns(waivers, error);
    for (size_t row = 0; row < waivers->csv.row_count && !status; row++) {
        status = check_row(waivers, row, error);
        if (!status && has_expired(waivers, row))
            rb_gate_report_note(report, "%.200s:%zu: this waiver has expired on %s: %.100s", path,
                                rb_csv_line(&waivers->csv, row), text_of(waivers, row, EXPIRES),
                                text_of(waivers, row, REASON));
    }
    if (!status)
        *error = (struct rb_error){0};
    return status;
}

static bool is_for(const struct rb_waivers *waivers, size_t row, const struct rb_gate_row *moved)
{
    char bounce[16];
    snprintf(bounce, sizeof bounce, "%d", moved->bounce);
    const char *const words[] = {
        [SCENE] = moved->cell.key[RB_KEY_SCENE],
        [VARIANT] = moved->cell.key[RB_KEY_VARIANT],
        [KERNEL] = moved->kernel,
        [BOUNCE] = moved->bounce < 0 ? "all" : bounce,
        [FIGURE] = moved->figure,
    };
    bool fits = true;
    for (int i = SCENE; i <= FIGURE; i++)
        fits = fits && rb_name_matches(text_of(waivers, row, i), words[i]);
    return fits;
}

void rb_waivers_apply(const struct rb_waivers *waivers, struct rb_gate_row *row)
{
    for (size_t i = 0; i < waivers->csv.row_count && row->moved == RB_MOVED_WORSE; i++) {
        double ceiling_pct = rb_csv_number(&waivers->csv, i, waivers->columns[CEILING]);
        if (has_expired(waivers, i) || !is_for(waivers, i, row) ||
            !(100 * (row->ratio - 1) <= ceiling_pct))
            continue;
        row->moved = RB_MOVED_WAIVED;
        snprintf(row->reason, sizeof row->reason, "%.127s", text_of(waivers, i, REASON));
    }
}
