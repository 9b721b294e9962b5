// Reading files of events, and choosing one.
#define _POSIX_C_SOURCE 200809L
#include "bench/hardware/event_file.h"

#include "bench/hardware/sheet.h"
#include "bench/machine/machine_read.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const categories[] = {"compute", "compute_stall", "memory_stall", "other",
                                         "total"};
enum { CATEGORY_COUNT = sizeof categories / sizeof *categories };

static enum rb_status take_name(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    return rb_sheet_text(file->title, sizeof file->title, text, error);
}

static enum rb_status take_device(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    if (strchr(text, '/') || text[0] == '.')
        return rb_error_set(error, RB_INVALID,
                            "expected the name of a folder in " RB_EVENT_DEVICES);
    return rb_sheet_text(file->device, sizeof file->device, text, error);
}

static enum rb_status take_verified(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    file->verified = strncmp(text, "yes", 3) == 0; // where and when may follow
    file->verified_said = true;
    return file->verified || strcmp(text, "no") == 0
               ? RB_OK
               : rb_error_set(error, RB_INVALID, "expected no, or yes and where");
}

static enum rb_status take_prose(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    return rb_sheet_append(file->prose, sizeof file->prose, text, error);
}

static enum rb_status take_fallback(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    file->fallback = atoi(text);
    return file->fallback >= 1 && file->fallback <= 9
               ? RB_OK
               : rb_error_set(error, RB_INVALID, "expected a number from 1 to 9");
}

static enum rb_status take_match(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    struct rb_event_match *match = &file->matches[file->match_count];
    if (file->match_count == RB_EVENT_MATCHES_MAX)
        return rb_error_set(error, RB_INVALID, "more than %d matches", RB_EVENT_MATCHES_MAX);
    int words = sscanf(text, "%31s %15s %127s", match->vendor, match->family, match->models);
    if (words < 2 || (words == 3 && !rb_machine_list_count(match->models)))
        return rb_error_set(error, RB_INVALID,
                            "expected VENDOR FAMILY and models such as 85,106-108, or, on AArch64, "
                            "IMPLEMENTER PART");
    file->match_count++;
    return RB_OK;
}

static enum rb_status take_group(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    bool by_read = strcmp(text, "by read") == 0;
    if (*text && !by_read)
        return rb_error_set(error, RB_INVALID, "expected group, or group by read");
    if (file->group_count == RB_HARDWARE_GROUPS)
        return rb_error_set(error, RB_INVALID, "more than %d groups", RB_HARDWARE_GROUPS);
    file->by_read[file->group_count++] = by_read;
    return RB_OK;
}

static int events_in_group(const struct rb_event_file *file, int group)
{
    int count = 0;
    for (int i = 0; i < file->event_count; i++)
        count += file->events[i].group == group;
    return count;
}

static enum rb_status take_event(void *user, char *text, struct rb_error *error)
{
    static const char kernel[] = " with kernel";
    struct rb_event_file *file = user;
    struct rb_event_line *event = &file->events[file->event_count];
    char *encoding;
    if (file->group_count == 0)
        return rb_error_set(error, RB_INVALID, "an event before the first group");
    if (file->values.count != file->event_count)
        return rb_error_set(error, RB_INVALID, "an event behind a value");
    if (file->event_count == RB_HARDWARE_EVENTS ||
        events_in_group(file, file->group_count - 1) == RB_EVENTS_MAX)
        return rb_error_set(error, RB_INVALID, "more than %d events, or %d in a group",
                            RB_HARDWARE_EVENTS, RB_EVENTS_MAX);
    if (rb_sheet_cut(text, &encoding, error) || rb_values_add(&file->values, text, error))
        return RB_INVALID;
    error->column += (unsigned long)(encoding - text);
    size_t length = strlen(encoding), tail = sizeof kernel - 1;
    event->kernel = length > tail && strcmp(encoding + length - tail, kernel) == 0;
    if (event->kernel)
        encoding[length - tail] = '\0';
    if (!*encoding || strlen(encoding) >= sizeof event->encoding)
        return rb_error_set(error, RB_INVALID, "expected an encoding of at most %zu bytes",
                            sizeof event->encoding - 1);
    snprintf(event->encoding, sizeof event->encoding, "%s", encoding);
    event->group = file->group_count - 1;
    file->event_count++;
    return RB_OK;
}

static enum rb_status take_value(void *user, char *text, struct rb_error *error)
{
    struct rb_event_file *file = user;
    return rb_sheet_value(&file->values, text, error);
}

static enum rb_status check(const struct rb_event_file *file, struct rb_error *error)
{
    int found = 0;
    for (int i = 0; i < CATEGORY_COUNT; i++)
        found += rb_values_find(&file->values, categories[i]) >= 0;
    if (!file->title[0] || !file->device[0] || !file->event_count || !file->verified_said)
        return rb_error_set(error, RB_INVALID,
                            "a file of events needs name, device, verified and an event");
    if (found != 0 && found != CATEGORY_COUNT)
        return rb_error_set(error, RB_INVALID,
                            "expected all of compute, compute_stall, memory_stall, other, total, "
                            "or none");
    return RB_OK;
}

enum rb_status rb_event_file_read(const char *path, struct rb_event_file *file,
                                  struct rb_error *error)
{
    static const struct rb_sheet_key keys[] = {
        {"name", take_name},         {"match", take_match},
        {"fallback", take_fallback}, {"device", take_device},
        {"prose", take_prose},       {"verified", take_verified},
        {"group", take_group},       {"event", take_event},
        {"value", take_value},       {NULL, NULL},
    };
    *file = (struct rb_event_file){.fallback = 0};
    rb_sheet_stem(path, file->stem);
    enum rb_status status = rb_sheet_read(path, keys, file, error);
    if (status == RB_OK)
        status = check(file, error);
    if (status)
        snprintf(error->file, sizeof error->file, "%.255s", path);
    return status;
}

bool rb_event_file_has_categories(const struct rb_event_file *file)
{
    return rb_values_find(&file->values, "total") >= 0;
}

const char *rb_event_file_source(const struct rb_event_file *file)
{
    return strcmp(file->device, "software") == 0 ? "software" : "pmu";
}

const char *rb_hardware_root(void)
{
    const char *root = getenv("RAYBENCH_SYSFS");
    return root ? root : "";
}

static bool in_list(const char *list, int number)
{
    int first, last;
    while (rb_machine_next_range(&list, &first, &last))
        if (number >= first && number <= last)
            return true;
    return false;
}

// What /proc/cpuinfo says under either name, x86's or AArch64's.
static void cpuinfo(const char *root, const char *key, const char *other, char value[64])
{
    if (!rb_machine_value(root, "/proc/cpuinfo", key, value, 64))
        rb_machine_value(root, "/proc/cpuinfo", other, value, 64);
}

static bool matches(const struct rb_event_file *file, const char *root)
{
    char vendor[64], family[64], model[64];
    cpuinfo(root, "vendor_id", "CPU implementer", vendor);
    cpuinfo(root, "cpu family", "CPU part", family);
    cpuinfo(root, "model", "CPU variant", model);
    for (int i = 0; i < file->match_count; i++) {
        const struct rb_event_match *match = &file->matches[i];
        if (strcmp(match->vendor, vendor) == 0 && strcmp(match->family, family) == 0 &&
            (!match->models[0] || in_list(match->models, atoi(model))))
            return true;
    }
    return false;
}

static bool has_device(const struct rb_event_file *file, const char *root)
{
    char path[128];
    double type;
    snprintf(path, sizeof path, RB_EVENT_DEVICES "/%s/type", file->device);
    return rb_machine_number(root, path, &type);
}

// How well a file suits the machine; 0: not at all.
static int suits(const struct rb_event_file *file, const char *root)
{
    if (!has_device(file, root))
        return 0;
    return matches(file, root) ? 10 : file->fallback ? 10 - file->fallback : 0;
}

// The best of the files there are, the first one in the order of their names among equals.
static enum rb_status choose(const glob_t *found, const char *root, struct rb_event_file *file,
                             struct rb_error *error)
{
    static struct rb_event_file next;
    int best = 0;
    for (size_t i = 0; i < found->gl_pathc; i++) {
        enum rb_status status = rb_event_file_read(found->gl_pathv[i], &next, error);
        if (status)
            return status;
        if (suits(&next, root) > best) {
            best = suits(&next, root);
            *file = next;
        }
    }
    return best ? RB_OK
                : rb_error_set(error, RB_FAILED,
                               "no events to count: no file of bench/events has a device that is "
                               "in %s" RB_EVENT_DEVICES "; mount sysfs, or name a file with "
                               "--events",
                               root);
}

enum rb_status rb_event_file_choose(const char *root, const char *asked, struct rb_event_file *file,
                                    struct rb_error *error)
{
    glob_t found;
    char pattern[1200];
    const char *folder;
    size_t length = asked ? strlen(asked) : 0;
    if (length > 7 && strcmp(asked + length - 7, ".events") == 0)
        return rb_event_file_read(asked, file, error);
    for (int i = 0; (folder = rb_sheet_folder("bench/events", "events", i)); i++) {
        snprintf(pattern, sizeof pattern, "%s/%.64s.events", folder, asked ? asked : "*");
        if (glob(pattern, 0, NULL, &found) != 0)
            continue;
        enum rb_status status = asked ? rb_event_file_read(found.gl_pathv[0], file, error)
                                      : choose(&found, root, file, error);
        globfree(&found);
        return status;
    }
    return rb_error_set(error, asked ? RB_INVALID : RB_FAILED,
                        "no file %.64s.events in bench/events, here or where the program was "
                        "built or installed",
                        asked ? asked : "*");
}
