#include "bench/data/json.h"

#include <inttypes.h>
#include <math.h>

static void put_string(FILE *out, const char *text)
{
    fputc('"', out);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fprintf(out, "\\%c", *c);
        else if (*c < 0x20 || *c >= 0x7f) // bytes above ASCII may not be UTF-8: as Latin-1
            fprintf(out, "\\u%04x", *c);
        else
            fputc(*c, out);
    }
    fputc('"', out);
}

static void begin_line(struct rb_json *json)
{
    if (json->depth == 0)
        return;
    if (json->line)
        fputs(json->begun ? ", " : "", json->out);
    else
        fprintf(json->out, "%s\n%*s", json->begun ? "," : "", 2 * json->depth, "");
}

static void begin_member(struct rb_json *json, const char *key)
{
    begin_line(json);
    json->begun = true;
    if (!key)
        return;
    put_string(json->out, key);
    fputs(": ", json->out);
}

static void begin_group(struct rb_json *json, const char *key, char bracket)
{
    begin_member(json, key);
    fputc(bracket, json->out);
    json->depth++;
    json->begun = false;
}

static void end_group(struct rb_json *json, char bracket)
{
    json->depth--;
    if (json->begun && !json->line)
        fprintf(json->out, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->out);
    json->begun = true;
    if (json->depth == 0)
        fputc('\n', json->out);
}

void rb_json_object(struct rb_json *json, const char *key)
{
    begin_group(json, key, '{');
}

void rb_json_array(struct rb_json *json, const char *key)
{
    begin_group(json, key, '[');
}

void rb_json_end_object(struct rb_json *json)
{
    end_group(json, '}');
}

void rb_json_end_array(struct rb_json *json)
{
    end_group(json, ']');
}

void rb_json_string(struct rb_json *json, const char *key, const char *value)
{
    begin_member(json, key);
    if (value)
        put_string(json->out, value);
    else
        fputs("null", json->out);
}

void rb_json_number(struct rb_json *json, const char *key, double value)
{
    begin_member(json, key);
    if (isfinite(value))
        fprintf(json->out, "%.9g", value);
    else
        fputs("null", json->out);
}

void rb_json_integer(struct rb_json *json, const char *key, int64_t value)
{
    begin_member(json, key);
    fprintf(json->out, "%" PRId64, value);
}

void rb_json_unsigned(struct rb_json *json, const char *key, uint64_t value)
{
    begin_member(json, key);
    fprintf(json->out, "%" PRIu64, value);
}

void rb_json_hash(struct rb_json *json, const char *key, uint64_t value)
{
    begin_member(json, key);
    fprintf(json->out, "\"%016" PRIx64 "\"", value);
}

void rb_json_bool(struct rb_json *json, const char *key, bool value)
{
    begin_member(json, key);
    fputs(value ? "true" : "false", json->out);
}
