// A whole file in memory.
#ifndef RB_DATA_TEXT_H
#define RB_DATA_TEXT_H

#include "base/status.h"

#include <stddef.h>

// Reads the file; `*text` ends with a NUL that `*length` does not count. Release with rb_free.
// RB_FAILED with error->file set if it cannot be read or there is no memory; nothing to free then.
enum rb_status rb_text_load(const char *path, char **text, size_t *length, struct rb_error *error);

#endif
