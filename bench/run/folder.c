#define _POSIX_C_SOURCE 200809L
#include "bench/run/folder.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static enum rb_status fail(const char *what, const char *path, struct rb_error *error)
{
    int cause = errno;
    snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, path);
    return rb_error_set(error, RB_FAILED, "cannot %s: %s", what, strerror(cause));
}

// First seven digits of the commit we stand in, "nogit" outside of a checkout.
static void git_revision(char revision[16])
{
    char line[16] = "";
    FILE *pipe = popen("git rev-parse --short=7 HEAD 2>/dev/null", "r");
    bool read = pipe && fgets(line, sizeof line, pipe);
    if (pipe)
        pclose(pipe);
    line[strspn(line, "0123456789abcdef")] = '\0';
    snprintf(revision, 16, "%s", read && line[0] ? line : "nogit");
}

enum rb_status rb_folder_check(const char *parent, struct rb_error *error)
{
    char link[RB_PATH_MAX];
    struct stat info;
    if (mkdir(parent, 0777) != 0 && errno != EEXIST)
        return fail("make the folder", parent, error);
    if (access(parent, W_OK | X_OK) != 0)
        return fail("write into the folder", parent, error);
    snprintf(link, sizeof link, "%s/latest", parent);
    if (lstat(link, &info) == 0 && !S_ISLNK(info.st_mode)) {
        errno = EEXIST;
        return fail("make the link", link, error);
    }
    return RB_OK;
}

enum rb_status rb_folder_make(const char *parent, char path[RB_PATH_MAX], struct rb_error *error)
{
    char when[32], revision[16], host[64] = "";
    time_t now = time(NULL);
    struct tm utc;
    strftime(when, sizeof when, "%Y%m%dT%H%M%SZ", gmtime_r(&now, &utc));
    git_revision(revision);
    gethostname(host, sizeof host - 1);
    host[strcspn(host, "/")] = '\0';
    for (int attempt = 0; attempt < 100; attempt++) { // two runs within a second
        char suffix[16] = "";
        if (attempt)
            snprintf(suffix, sizeof suffix, ".%d", attempt);
        int length = snprintf(path, RB_PATH_MAX, "%s/%s-%s-%s%s", parent, when, revision,
                              host[0] ? host : "unknown", suffix);
        if (length >= RB_PATH_MAX)
            errno = ENAMETOOLONG;
        else if (mkdir(path, 0777) == 0)
            return RB_OK;
        if (errno != EEXIST)
            break;
    }
    return fail("make the folder", path, error);
}

enum rb_status rb_folder_make_second(const char *first, char path[RB_PATH_MAX],
                                     struct rb_error *error)
{
    if (snprintf(path, RB_PATH_MAX, "%s.against", first) >= RB_PATH_MAX)
        errno = ENAMETOOLONG;
    else if (mkdir(path, 0777) == 0)
        return RB_OK;
    return fail("make the folder", path, error);
}

enum rb_status rb_folder_find_stopped(const char *parent, char path[RB_PATH_MAX],
                                      struct rb_error *error)
{
    char link[RB_PATH_MAX], name[RB_PATH_MAX / 2] = "", part[RB_PATH_MAX + 32];
    snprintf(link, sizeof link, "%s/latest", parent);
    if (readlink(link, name, sizeof name - 1) <= 0)
        return fail("find a run to go on with", link, error);
    if (snprintf(path, RB_PATH_MAX, "%s/%s", parent, name) >= RB_PATH_MAX) {
        errno = ENAMETOOLONG;
        return fail("find a run to go on with", link, error);
    }
    snprintf(part, sizeof part, "%s/samples.csv.part", path);
    if (access(part, R_OK | W_OK) == 0)
        return RB_OK;
    snprintf(error->file, sizeof error->file, "%.255s", path);
    return rb_error_set(error, RB_INVALID,
                        "the newest run has come to its end; there is nothing to go on with");
}

enum rb_status rb_folder_link_latest(const char *parent, const char *path, struct rb_error *error)
{
    char link[RB_PATH_MAX + 16], temporary[RB_PATH_MAX + 16];
    snprintf(link, sizeof link, "%s/latest", parent);
    snprintf(temporary, sizeof temporary, "%s/latest.%ld", parent, (long)getpid());
    const char *name = strrchr(path, '/');
    unlink(temporary);
    if (symlink(name ? name + 1 : path, temporary) != 0 || rename(temporary, link) != 0) {
        enum rb_status status = fail("update the link", link, error);
        unlink(temporary);
        return status;
    }
    return RB_OK;
}
