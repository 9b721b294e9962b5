#include "bench/simulate/callgrind.h"

#include "measure/simulate.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char trigger[] = "desc: Trigger: Client Request: ";

enum { COLUMNS_MAX = 64, NO_EVENT = RB_SIM_EVENT_COUNT };

struct reader {
    struct rb_simulated *simulated;
    struct rb_error *error;
    int columns[COLUMNS_MAX]; // events of the running dump
    int column_count;
    struct rb_simulated_place *place; // of the running dump; NULL: not a lap
    bool labelled;                    // there was a label, and no totals yet
    bool ended;                       // the last label was the end
};

// Behind `prefix` if the line begins with it, else NULL.
static const char *after(const char *line, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncmp(line, prefix, length) == 0 ? line + length : NULL;
}

// A number with its name before it, such as " rays=10"; moves on behind it.
static bool read_field(const char **text, const char *name, uint64_t *value)
{
    const char *digits = after(*text, name);
    char *end;
    errno = 0;
    if (!digits || !isxdigit((unsigned char)*digits))
        return false;
    *value = strtoull(digits, &end, 16);
    *text = end;
    return errno == 0;
}

static enum rb_status read_lap(struct reader *reader, const char *text)
{
    uint64_t stage, bounce, rays;
    if (!read_field(&text, "stage=", &stage) || !read_field(&text, " bounce=", &bounce) ||
        !read_field(&text, " rays=", &rays) || *text || stage >= RB_STAGE_COUNT ||
        bounce >= RB_BOUNCE_MAX)
        return rb_error_set(reader->error, RB_FAILED, "a dump with a label that is not ours");
    reader->place = &reader->simulated->place[stage][bounce];
    reader->place->rays += rays;
    reader->place->laps++;
    return RB_OK;
}

static enum rb_status read_end(struct reader *reader, const char *text)
{
    const char *row =
        read_field(&text, "hits=", &reader->simulated->hits_hash) ? after(text, " row=") : NULL;
    if (!row || strlen(row) >= sizeof reader->simulated->row)
        return rb_error_set(reader->error, RB_FAILED, "a dump with an end that is not ours");
    strcpy(reader->simulated->row, row);
    reader->ended = true;
    return RB_OK;
}

static enum rb_status read_creator(struct reader *reader, const char *name)
{
    name += strspn(name, " ");
    snprintf(reader->simulated->simulator, sizeof reader->simulated->simulator, "%.32s", name);
    return RB_OK;
}

static enum rb_status read_label(struct reader *reader, const char *label)
{
    const char *end = after(label, "end ");
    if (reader->ended || reader->labelled)
        return rb_error_set(reader->error, RB_FAILED, "a dump where none is expected");
    reader->labelled = true;
    return end ? read_end(reader, end) : read_lap(reader, label);
}

static enum rb_status read_columns(struct reader *reader, const char *names)
{
    bool seen[RB_SIM_EVENT_COUNT + 1] = {false};
    reader->column_count = 0;
    for (size_t length; *(names += strspn(names, " ")); names += length) {
        length = strcspn(names, " ");
        int event = 0;
        while (event < RB_SIM_EVENT_COUNT &&
               (strlen(rb_sim_event_names[event]) != length ||
                memcmp(rb_sim_event_names[event], names, length) != 0))
            event++;
        if (reader->column_count == COLUMNS_MAX || (event != NO_EVENT && seen[event]))
            return rb_error_set(reader->error, RB_FAILED, "too many columns");
        seen[event] = true;
        reader->columns[reader->column_count++] = event;
    }
    for (int event = 0; event < RB_SIM_EVENT_COUNT; event++)
        if (!seen[event])
            return rb_error_set(reader->error, RB_FAILED, "there is no column %s",
                                rb_sim_event_names[event]);
    return RB_OK;
}

// Fewer numbers than columns: the rest are 0.
static enum rb_status read_totals(struct reader *reader, const char *text)
{
    int column = 0;
    for (; *(text += strspn(text, " ")); column++) {
        char *end;
        errno = 0;
        uint64_t number = strtoull(text, &end, 10);
        if (!isdigit((unsigned char)*text) || errno || (*end && *end != ' ') ||
            column >= reader->column_count)
            return rb_error_set(reader->error, RB_FAILED, "totals that do not fit the columns");
        if (reader->place && reader->columns[column] != NO_EVENT)
            reader->place->events[reader->columns[column]] += number;
        text = end;
    }
    if (column == 0)
        return rb_error_set(reader->error, RB_FAILED, "totals without numbers");
    reader->place = NULL;
    reader->labelled = false;
    return RB_OK;
}

static enum rb_status read_line(struct reader *reader, const char *line)
{
    static const struct {
        const char *prefix;
        enum rb_status (*read)(struct reader *reader, const char *text);
    } kinds[] = {
        {"creator:", read_creator},
        {trigger, read_label},
        {"events:", read_columns},
        {"totals:", read_totals},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const char *text = after(line, kinds[i].prefix);
        if (text)
            return kinds[i].read(reader, text);
    }
    return RB_OK;
}

enum rb_status rb_callgrind_parse(const char *text, struct rb_simulated *simulated,
                                  struct rb_error *error)
{
    struct reader reader = {.simulated = simulated, .error = error};
    char line[512];
    error->line = 0;
    for (size_t length; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        // Longer lines are names of functions and command lines, of which the beginning will do.
        size_t kept = length < sizeof line - 1 ? length : sizeof line - 1;
        memcpy(line, text, kept);
        line[kept] = '\0';
        error->line++;
        error->column = 1;
        if (read_line(&reader, line))
            return RB_FAILED;
    }
    if (!reader.ended || reader.labelled)
        return rb_error_set(error, RB_FAILED, "the simulator's record is cut short");
    error->line = error->column = 0;
    return RB_OK;
}
