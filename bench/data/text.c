#include "bench/data/text.h"

#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static enum rb_status fail(const char *path, struct rb_error *error)
{
    int cause = errno;
    snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1, path);
    return rb_error_set(error, RB_FAILED, "cannot read: %s", strerror(cause));
}

enum rb_status rb_text_load(const char *path, char **text, size_t *length, struct rb_error *error)
{
    enum { CHUNK = 65536 };
    struct rb_array bytes = {0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return fail(path, error);
    enum rb_status status = RB_OK;
    size_t got = 1;
    while (status == RB_OK && got) {
        if (!rb_array_reserve(&bytes, CHUNK + 1, 1)) {
            status = rb_error_memory(error, path);
            break;
        }
        got = fread((char *)bytes.data + bytes.count, 1, CHUNK, file);
        bytes.count += got;
    }
    if (status == RB_OK && ferror(file))
        status = fail(path, error);
    fclose(file);
    if (status) {
        rb_array_release(&bytes);
        return status;
    }
    *text = bytes.data;
    *length = bytes.count;
    (*text)[bytes.count] = '\0';
    return RB_OK;
}
