#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>

enum rb_status rb_error_set(struct rb_error *error, enum rb_status status, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}

enum rb_status rb_error_memory(struct rb_error *error, const char *what)
{
    return rb_error_set(error, RB_FAILED, "not enough memory for %s", what);
}
