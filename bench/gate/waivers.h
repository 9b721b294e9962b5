// Waivers: what a gate lets pass, for a reason, up to a ceiling, until a day. A CSV file with the
// columns scene, variant, kernel, bounce, figure (names or globs), ceiling_pct, expires
// (YYYY-MM-DD, the last day) and reason; other columns are comments.
#ifndef RB_GATE_WAIVERS_H
#define RB_GATE_WAIVERS_H

#include "bench/data/csv_read.h"
#include "bench/gate/report.h"

struct rb_waivers {
    struct rb_csv csv; // no rows if there is no file
    int columns[8];
    char today[16];
};

// Loads FOLDER/waivers.csv, if it is there, and notes in the report which have expired. RB_INVALID
// with the place of what is wrong. Free with rb_csv_free(&waivers->csv).
enum rb_status rb_waivers_load(const char *folder, struct rb_waivers *waivers,
                               struct rb_gate_report *report, struct rb_error *error);

// Waives a row that is worse, if one of them is for it.
void rb_waivers_apply(const struct rb_waivers *waivers, struct rb_gate_row *row);

#endif
