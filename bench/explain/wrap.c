#include "bench/explain/wrap.h"

#include <stdio.h>
#include <string.h>

enum { LINE = 96 };

void rb_wrap_print(int indent, const char *text)
{
    size_t most = (size_t)(LINE - indent);
    while (*text) {
        size_t length = strlen(text);
        if (length > most) {
            length = most;
            while (length > 1 && text[length] != ' ')
                length--;
        }
        printf("%*s%.*s\n", indent, "", (int)length, text);
        text += length;
        text += strspn(text, " ");
    }
}
