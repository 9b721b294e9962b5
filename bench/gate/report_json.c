#include "bench/gate/report_json.h"

#include "bench/data/json.h"
#include "bench/gate/row.h"

enum { SCHEMA_VERSION = 1 };

static void put_row(struct rb_json *json, const struct rb_gate_row *row)
{
    char command[RB_GATE_COMMAND_MAX];
    rb_gate_row_command(row, command);
    rb_json_object(json, NULL);
    for (int i = 0; i < RB_KEY_CELL; i++)
        rb_json_string(json, rb_key_names[i], row->cell.key[i]);
    rb_json_string(json, "kernel", row->kernel);
    if (row->bounce >= 0)
        rb_json_integer(json, "bounce", row->bounce);
    else
        rb_json_string(json, "bounce", NULL);
    rb_json_string(json, "figure", row->figure);
    rb_json_number(json, "base", row->base);
    rb_json_number(json, "head", row->head);
    rb_json_number(json, "ratio", row->ratio);
    rb_json_number(json, "ratio_lo", row->low);
    rb_json_number(json, "ratio_hi", row->high);
    rb_json_number(json, "floor", row->floor);
    rb_json_string(json, "verdict", rb_moved_names[row->moved]);
    rb_json_string(json, "waived_for", row->reason[0] ? row->reason : NULL);
    rb_json_string(json, "replay", command);
    rb_json_end_object(json);
}

void rb_gate_report_json(const struct rb_gate_report *report, FILE *out)
{
    const struct rb_gate_row *rows = report->rows.data;
    const char(*notes)[RB_GATE_TEXT_MAX] = report->notes.data;
    struct rb_json json = {.out = out};
    rb_json_object(&json, NULL);
    rb_json_integer(&json, "schema_version", SCHEMA_VERSION);
    rb_json_string(&json, "gate", report->name);
    rb_json_integer(&json, "code", report->code);
    rb_json_string(&json, "verdict", report->verdict);
    rb_json_object(&json, "compared");
    for (int i = 0; i < RB_MOVED_COUNT; i++)
        rb_json_integer(&json, rb_moved_names[i], (int64_t)report->counts[i]);
    rb_json_end_object(&json);
    rb_json_array(&json, "rows");
    for (size_t i = 0; i < report->rows.count; i++)
        put_row(&json, &rows[i]);
    rb_json_end_array(&json);
    rb_json_array(&json, "notes");
    for (size_t i = 0; i < report->notes.count; i++)
        rb_json_string(&json, NULL, notes[i]);
    rb_json_end_array(&json);
    rb_json_end_object(&json);
}
