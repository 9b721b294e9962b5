#define _POSIX_C_SOURCE 200809L
#include "bench/times/hyperfine.h"

#include "base/file.h"
#include "bench/times/timed.h"

#include <stdio.h>
#include <string.h>

void rb_run_times_free(struct rb_run_times *times)
{
    rb_array_release(&times->wall_s);
}

bool rb_hyperfine_find(char version[RB_HYPERFINE_VERSION_ROOM])
{
    int major = 0, minor = 0, patch = 0;
    char line[64] = "";
    FILE *pipe = popen("hyperfine --version 2>/dev/null", "r");
    bool read = pipe && fgets(line, sizeof line, pipe);
    if (pipe)
        pclose(pipe);
    if (!read || sscanf(line, "hyperfine %4d.%4d.%4d", &major, &minor, &patch) != 3)
        return false;
    snprintf(version, RB_HYPERFINE_VERSION_ROOM, "hyperfine %d.%d.%d", major, minor, patch);
    return major > 1 || (major == 1 && minor >= 13);
}

// Appends to a line of limited size; false, and the line stays as it is, without room.
static bool append(char *line, size_t size, size_t *length, const char *text, size_t count)
{
    if (count >= size - *length)
        return false;
    memcpy(line + *length, text, count);
    *length += count;
    line[*length] = '\0';
    return true;
}

bool rb_hyperfine_quote(char *const argv[], char *line, size_t size)
{
    size_t length = 0;
    line[0] = '\0';
    for (int i = 0; argv[i]; i++) {
        if (!append(line, size, &length, i ? " '" : "'", i ? 2 : 1))
            return false;
        for (const char *c = argv[i]; *c;
             c++) // a quote ends the quotes, and stands outside of them
            if (!append(line, size, &length, *c == '\'' ? "'\\''" : c, *c == '\'' ? 4 : 1))
                return false;
        if (!append(line, size, &length, "'", 1))
            return false;
    }
    return true;
}

enum rb_status rb_hyperfine_run(char *const argv[], int warmups, int runs, const char *json,
                                const char *log, struct rb_run_times *times, struct rb_error *error)
{
    char command[RB_HYPERFINE_COMMAND_ROOM], warmup_count[16], run_count[16];
    if (!rb_hyperfine_quote(argv, command, sizeof command))
        return rb_error_set(error, RB_FAILED, "the name of the program or folder is too long");
    snprintf(warmup_count, sizeof warmup_count, "%d", warmups);
    snprintf(run_count, sizeof run_count, "%d", runs);
    char *words[] = {"hyperfine", "--shell=none", "--style=none",  "--warmup",   warmup_count,
                     "--runs",    run_count,      "--export-json", (char *)json, command,
                     NULL};
    struct rb_timed_result whole;
    char *text;
    size_t length;
    enum rb_status status = rb_timed_run(words, NULL, log, &whole, error);
    if (status == RB_OK)
        status = rb_file_read(json, &text, &length, error);
    if (status)
        return status;
    status = rb_hyperfine_parse(text, length, times, error);
    rb_free(text);
    if (status)
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, json);
    else if (times->wall_s.count != (size_t)runs) {
        status = rb_error_set(error, RB_INVALID, "hyperfine reports %zu runs instead of %d",
                              times->wall_s.count, runs);
        rb_run_times_free(times);
    }
    return status;
}
