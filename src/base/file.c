#define _POSIX_C_SOURCE 200809L
#include "base/file.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// What a signal handler has to remove; the flag is raised only while the name is complete.
static char pending_path[1100];
static volatile sig_atomic_t pending;

static enum rb_status fail(const struct rb_output *output, struct rb_error *error, const char *what)
{
    int cause = errno;
    if (error)
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1,
                 output->path);
    return rb_error_set(error, RB_FAILED, "cannot %s: %s", what, strerror(cause));
}

enum rb_status rb_output_open(struct rb_output *output, const char *path, struct rb_error *error)
{
    *output = (struct rb_output){0};
    size_t length = (size_t)snprintf(output->path, sizeof output->path, "%s", path);
    if (length >= sizeof output->path) {
        errno = ENAMETOOLONG;
        return fail(output, error, "open");
    }
    struct stat info;
    bool is_stdout = strcmp(path, "-") == 0;
    output->in_place = is_stdout || (stat(path, &info) == 0 && !S_ISREG(info.st_mode));
    if (output->in_place) {
        output->stream = is_stdout ? stdout : fopen(path, "wb");
    } else {
        snprintf(output->temporary, sizeof output->temporary, "%s.%ld.tmp", path, (long)getpid());
        memcpy(pending_path, output->temporary, sizeof pending_path);
        pending = 1;
        output->stream = fopen(output->temporary, "wb");
    }
    if (!output->stream) {
        pending = 0;
        return fail(output, error, "open for writing");
    }
    return RB_OK;
}

enum rb_status rb_output_commit(struct rb_output *output, struct rb_error *error)
{
    FILE *stream = output->stream;
    output->stream = NULL;
    bool written = fflush(stream) == 0 && !ferror(stream);
    int cause = errno;
    if (stream != stdout && fclose(stream) != 0 && written) {
        written = false;
        cause = errno;
    }
    if (!written) {
        errno = cause;
        enum rb_status status = fail(output, error, "write");
        rb_output_discard(output);
        return status;
    }
    if (!output->in_place && rename(output->temporary, output->path) != 0) {
        enum rb_status status = fail(output, error, "rename into place");
        rb_output_discard(output);
        return status;
    }
    pending = 0;
    return RB_OK;
}

void rb_output_discard(struct rb_output *output)
{
    if (output->stream && output->stream != stdout)
        fclose(output->stream);
    if (!output->in_place && output->temporary[0])
        unlink(output->temporary);
    output->stream = NULL;
    output->temporary[0] = '\0';
    pending = 0;
}

void rb_output_discard_on_signal(void)
{
    if (pending)
        unlink(pending_path);
}
