#define _POSIX_C_SOURCE 200809L
#include "bench/versus/pages.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WORDS_MAX = 256, TEXT_MAX = 1 << 16 };

void rb_versus_restart(const char *program)
{
    static char text[TEXT_MAX];
    char *words[WORDS_MAX + 1] = {NULL};
    int count = 0;
    FILE *file = getenv("GLIBC_TUNABLES") ? NULL : fopen("/proc/self/cmdline", "r");
    if (!file)
        return;
    size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    for (char *word = text; word < text + size && count < WORDS_MAX; word += strlen(word) + 1)
        words[count++] = word;
    bool whole = count > 0 && count < WORDS_MAX && size < sizeof text - 1;
    if (whole && setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 1) == 0)
        execv(program, words);
}

double rb_versus_huge_pct(void)
{
    FILE *file = fopen("/proc/self/smaps_rollup", "r");
    double all_kb = 0, huge_kb = 0;
    char line[256];
    while (file && fgets(line, sizeof line, file)) {
        (void)sscanf(line, "Anonymous: %lf", &all_kb);
        (void)sscanf(line, "AnonHugePages: %lf", &huge_kb);
    }
    if (file)
        fclose(file);
    return all_kb > 0 ? 100.0 * huge_kb / all_kb : (double)NAN;
}
