// From the words of a file of events to the numbers of perf_event_open, as sysfs defines them
// (Documentation/ABI/testing/sysfs-bus-event_source-devices-format of Linux).
#include "bench/hardware/event_file.h"

#include "bench/machine/machine_read.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Puts the bits of `value`, lowest first, where `ranges` such as "0-7,32-35" says. False if it is
// no such text, or there is no room for the value.
static bool scatter(uint64_t value, const char *ranges, uint64_t *config)
{
    int first, last;
    while (rb_machine_next_range(&ranges, &first, &last)) {
        if (last > 63)
            return false;
        for (int bit = first; bit <= last; bit++, value >>= 1)
            *config |= (value & 1) << bit;
    }
    return !*ranges && value == 0;
}

// One term, "umask=0x14" or "inv", as the device's format says: "config1:0-15".
static bool add_term(const char *root, const char *device, char *term, struct rb_event *event)
{
    struct {
        const char *name;
        uint64_t *config;
    } fields[] = {
        {"config", &event->config}, {"config1", &event->config1}, {"config2", &event->config2}};
    char path[192], format[128];
    char *sign = strchr(term, '='), *end = "";
    uint64_t value = sign ? strtoull(sign + 1, &end, 0) : 1;
    if (sign)
        *sign = '\0';
    if (*end || (sign && end == sign + 1) || !*term)
        return false;
    snprintf(path, sizeof path, RB_EVENT_DEVICES "/%s/format/%.64s", device, term);
    if (strchr(term, '/') || !rb_machine_line(root, path, format, sizeof format))
        snprintf(format, sizeof format, "%.16s:0-63", term);
    char *colon = strchr(format, ':');
    for (size_t i = 0; i < sizeof fields / sizeof *fields && colon; i++)
        if (strncmp(format, fields[i].name, (size_t)(colon - format)) == 0 &&
            fields[i].name[colon - format] == '\0')
            return scatter(value, colon + 1, fields[i].config);
    return false;
}

static bool add_terms(const char *root, const char *device, const char *terms,
                      struct rb_event *event)
{
    char copy[160];
    snprintf(copy, sizeof copy, "%s", terms);
    for (char *term = strtok(copy, ","); term; term = strtok(NULL, ","))
        if (!add_term(root, device, term, event))
            return false;
    return true;
}

// One alternative: terms, or the name of an event that the kernel exports as terms.
static bool encode(const char *root, const char *device, const char *text, struct rb_event *event)
{
    char path[256], terms[160];
    uint32_t type = event->type;
    bool kernel = event->kernel;
    *event = (struct rb_event){.type = type, .kernel = kernel};
    if (strchr(text, '='))
        return add_terms(root, device, text, event);
    snprintf(path, sizeof path, RB_EVENT_DEVICES "/%s/events/%.100s", device, text);
    return !strchr(text, '/') && rb_machine_line(root, path, terms, sizeof terms) && terms[0] &&
           add_terms(root, device, terms, event);
}

enum rb_status rb_event_encode(const char *root, const struct rb_event_file *file, int index,
                               struct rb_event *event, struct rb_error *error)
{
    const struct rb_event_line *line = &file->events[index];
    char path[128], word[160];
    double type;
    snprintf(path, sizeof path, RB_EVENT_DEVICES "/%s/type", file->device);
    if (!rb_machine_number(root, path, &type))
        return rb_error_set(error, RB_FAILED, "no %s%s", root, path);
    *event = (struct rb_event){.type = (uint32_t)type, .kernel = line->kernel};
    for (const char *rest = line->encoding; rest;) {
        const char *next = strstr(rest, " or ");
        snprintf(word, sizeof word, "%.*s", next ? (int)(next - rest) : (int)strlen(rest), rest);
        word[strcspn(word, " \t")] = '\0';
        if (encode(root, file->device, word, event))
            return RB_OK;
        rest = next ? next + 4 + strspn(next + 4, " ") : NULL;
    }
    return rb_error_set(error, RB_FAILED,
                        "the machine does not know %s: no such name or terms in " RB_EVENT_DEVICES
                        "/%s",
                        line->encoding, file->device);
}
