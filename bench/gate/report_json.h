// A report as JSON: schema_version 1, code, verdict, counts, rows, notes.
#ifndef RB_GATE_REPORT_JSON_H
#define RB_GATE_REPORT_JSON_H

#include "bench/gate/report.h"

#include <stdio.h>

void rb_gate_report_json(const struct rb_gate_report *report, FILE *out);

#endif
