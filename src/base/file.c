#define _XOPEN_SOURCE 700
#include "base/file.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// What a signal handler has to remove; the flag is raised only while the name is complete.
static char pending_path[RB_OUTPUT_PATH_MAX];
static volatile sig_atomic_t pending;

static void set_file(struct rb_error *error, const char *path)
{
    if (error)
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, path);
}

static enum rb_status fail(const struct rb_output *output, struct rb_error *error, const char *what)
{
    int cause = errno;
    set_file(error, output->path);
    return rb_error_set(error, RB_FAILED, "cannot %s: %s", what, strerror(cause));
}

// The name in `output` becomes that of the file behind links. False if it does not fit.
static bool resolve(struct rb_output *output)
{
    char *real = realpath(output->path, NULL);
    bool fits = !real || strlen(real) < sizeof output->path;
    if (real && fits)
        memcpy(output->path, real, strlen(real) + 1);
    free(real);
    return fits;
}

// Opens a new file in the folder of the final one, with the mode of the file it will replace.
static FILE *open_temporary(struct rb_output *output, const struct stat *replaced)
{
    const char *slash = strrchr(output->path, '/');
    int folder_length = slash ? (int)(slash - output->path) + 1 : 0;
    int length = snprintf(output->temporary, sizeof output->temporary, "%.*s.raybench-%ld.tmp",
                          folder_length, output->path, (long)getpid());
    if (length >= (int)sizeof output->temporary) {
        errno = ENAMETOOLONG;
        return NULL;
    }
    if (replaced && access(output->path, W_OK) != 0)
        return NULL;
    memcpy(pending_path, output->temporary, sizeof pending_path);
    atomic_signal_fence(memory_order_seq_cst);
    int descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0)
        return NULL;
    pending = 1;
    if (replaced)
        fchmod(descriptor, replaced->st_mode & 0777);
    FILE *stream = fdopen(descriptor, "wb");
    if (!stream)
        close(descriptor);
    return stream;
}

enum rb_status rb_output_open(struct rb_output *output, const char *path, struct rb_error *error)
{
    *output = (struct rb_output){0};
    struct stat info;
    bool is_stdout = strcmp(path, "-") == 0, exists = !is_stdout && stat(path, &info) == 0;
    size_t length = (size_t)snprintf(output->path, sizeof output->path, "%s", path);
    if (length >= sizeof output->path || (exists && !resolve(output))) {
        errno = ENAMETOOLONG;
        return fail(output, error, "open for writing");
    }
    output->in_place = is_stdout || (exists && !S_ISREG(info.st_mode));
    if (output->in_place)
        output->stream = is_stdout ? stdout : fopen(path, "wb");
    else
        output->stream = open_temporary(output, exists ? &info : NULL);
    if (output->stream)
        return RB_OK;
    enum rb_status status = fail(output, error, "open for writing");
    if (pending)
        rb_output_discard(output);
    return status;
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

// The bytes and a terminator. The size of the file is a hint: a pipe has none.
static enum rb_status read_stream(FILE *stream, struct rb_array *text, struct rb_error *error)
{
    struct stat info;
    bool sized = fstat(fileno(stream), &info) == 0 && S_ISREG(info.st_mode);
    size_t step = sized ? (size_t)info.st_size + 1 : 1 << 16;
    for (bool whole = false; !whole; step = 1 << 16) {
        if (!rb_array_reserve(text, step + 1, 1))
            return rb_error_memory(error, "the file");
        size_t got = fread((char *)text->data + text->count, 1, step, stream);
        text->count += got;
        whole = got < step;
    }
    if (ferror(stream))
        return rb_error_set(error, RB_FAILED, "cannot read: %s", strerror(errno));
    ((char *)text->data)[text->count] = '\0';
    return RB_OK;
}

enum rb_status rb_file_read(const char *path, char **text, size_t *size, struct rb_error *error)
{
    set_file(error, path);
    *text = NULL;
    *size = 0;
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return rb_error_set(error, RB_FAILED, "cannot open: %s", strerror(errno));
    struct rb_array bytes = {0};
    enum rb_status status = read_stream(stream, &bytes, error);
    fclose(stream);
    if (status) {
        rb_array_release(&bytes);
        return status;
    }
    *text = bytes.data;
    *size = bytes.count;
    return RB_OK;
}
