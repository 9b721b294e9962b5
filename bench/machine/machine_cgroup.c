// The CPU quota of the control groups that this process is in, version 2 or 1.
#define _POSIX_C_SOURCE 200809L
#include "bench/machine/machine_read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct group {
    const char *mount;                  // of the hierarchy
    bool second;                        // version 2
    char path[RB_MACHINE_PATH_MAX / 2]; // within it, "" for its root
};

static bool is_folder(const char *root, const char *path)
{
    char whole[RB_MACHINE_PATH_MAX];
    int length = snprintf(whole, sizeof whole, "%s%s", root, path);
    return length < (int)sizeof whole && access(whole, X_OK) == 0;
}

// A line of /proc/self/cgroup is "number:controllers:path"; version 2 has no controllers. Cuts the
// line in two and says whether it is the one: `second` asks for version 2, else for controller cpu.
static bool is_line(char *line, bool second, const char **path)
{
    char *controllers = strchr(line, ':'), *end = controllers ? strchr(controllers + 1, ':') : NULL;
    if (!end)
        return false;
    *end = '\0';
    *path = end + 1;
    if (second)
        return controllers[1] == '\0';
    for (char *word = controllers + 1; word;
         word = strchr(word, ',') ? strchr(word, ',') + 1 : NULL)
        if (strncmp(word, "cpu", 3) == 0 && (word[3] == ',' || !word[3]))
            return true;
    return false;
}

// A path that leads out of its hierarchy (seen from within a name space) is that of the root.
static bool own_path(const char *root, bool second, char *path, size_t size)
{
    char line[RB_MACHINE_PATH_MAX], file[RB_MACHINE_PATH_MAX];
    const char *found;
    int length = snprintf(file, sizeof file, "%s/proc/self/cgroup", root);
    FILE *stream = length < (int)sizeof file ? fopen(file, "re") : NULL;
    bool ok = false;
    while (stream && !ok && fgets(line, sizeof line, stream)) {
        line[strcspn(line, "\n")] = '\0';
        ok = is_line(line, second, &found) && strlen(found) < size;
        if (ok)
            snprintf(path, size, "%s", strstr(found, "..") || found[0] != '/' ? "" : found);
    }
    if (stream)
        fclose(stream);
    return ok;
}

static bool find_group(const char *root, struct group *group)
{
    static const struct {
        const char *mount;
        bool second;
    } mounts[] = {{"/sys/fs/cgroup/cpu", false},
                  {"/sys/fs/cgroup/cpu,cpuacct", false},
                  {"/sys/fs/cgroup/unified", true},
                  {"/sys/fs/cgroup", true}};
    for (size_t i = 0; i < sizeof mounts / sizeof *mounts; i++) {
        *group = (struct group){.mount = mounts[i].mount, .second = mounts[i].second};
        if (is_folder(root, group->mount) &&
            own_path(root, group->second, group->path, sizeof group->path))
            return true;
    }
    return false;
}

static void join(const struct group *group, const char *file, char path[RB_MACHINE_PATH_MAX])
{
    snprintf(path, RB_MACHINE_PATH_MAX, "%s%s/%s", group->mount, group->path, file);
}

// Moves to the group above; false at the root.
static bool go_up(struct group *group)
{
    char *slash = strrchr(group->path, '/');
    if (slash)
        *slash = '\0';
    return slash;
}

// CPUs that one group may use, infinite where it says nothing or "max".
static double quota(const char *root, const struct group *group)
{
    char path[RB_MACHINE_PATH_MAX], line[128];
    double time = -1, period = -1;
    if (group->second) {
        join(group, "cpu.max", path);
        rb_machine_line(root, path, line, sizeof line);
        if (sscanf(line, "%lf %lf", &time, &period) != 2)
            return HUGE_VAL;
    } else {
        join(group, "cpu.cfs_quota_us", path);
        bool has_time = rb_machine_number(root, path, &time);
        join(group, "cpu.cfs_period_us", path);
        if (!has_time || !rb_machine_number(root, path, &period))
            return HUGE_VAL;
    }
    return time > 0 && period > 0 ? time / period : HUGE_VAL; // version 1 has -1 for none
}

void rb_machine_cgroup_cpus(const char *root, const char *unused, struct rb_fact *fact)
{
    struct group group;
    (void)unused;
    if (!find_group(root, &group)) {
        rb_fact_unknown(fact, "no control groups in /proc/self/cgroup and /sys/fs/cgroup");
        return;
    }
    double least = quota(root, &group);
    while (go_up(&group))
        least = fmin(least, quota(root, &group));
    if (isfinite(least))
        rb_fact_number(fact, least);
    else
        rb_fact_text(fact, "none");
}

void rb_machine_cgroup_throttled(const char *root, const char *unused, struct rb_fact *fact)
{
    struct group group;
    char path[RB_MACHINE_PATH_MAX], value[64];
    (void)unused;
    bool more = find_group(root, &group);
    for (; more; more = go_up(&group)) {
        join(&group, "cpu.stat", path);
        if (rb_machine_value(root, path, "nr_throttled", value, sizeof value)) {
            rb_fact_number(fact, strtod(value, NULL));
            return;
        }
    }
    rb_fact_unknown(fact, "no group has cpu.stat with nr_throttled");
}
