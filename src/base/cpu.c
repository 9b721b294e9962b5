#include "base/cpu.h"

#include <stdlib.h>
#include <string.h>

#if defined(__x86_64__)
static bool has_sse2(void)
{
    return true; // part of x86-64
}

static bool has_avx2(void)
{
    return __builtin_cpu_supports("avx2"); // asks the operating system as well
}

static bool has_bmi2(void)
{
    return __builtin_cpu_supports("bmi2");
}

static bool has_avx512f(void)
{
    return __builtin_cpu_supports("avx512f");
}
#else
static bool has_sse2(void)
{
    return false;
}

static bool has_avx512f(void)
{
    return false;
}

static bool has_bmi2(void)
{
    return false;
}

static bool has_avx2(void)
{
    return false;
}
#endif

static bool has_neon(void)
{
#ifdef __aarch64__
    return true; // part of AArch64
#else
    return false;
#endif
}

static const struct feature {
    const char *name;
    bool (*present)(void);
} features[] = {{"sse2", has_sse2},
                {"avx2", has_avx2},
                {"bmi2", has_bmi2},
                {"avx512f", has_avx512f},
                {"neon", has_neon}};

enum { FEATURE_COUNT = sizeof features / sizeof *features };

static const struct feature *find(const char *name, size_t length)
{
    for (int i = 0; i < FEATURE_COUNT; i++)
        if (strlen(features[i].name) == length && memcmp(features[i].name, name, length) == 0)
            return &features[i];
    return NULL;
}

static const char *disabled_list(void)
{
    const char *list = getenv("RAYBENCH_CPU_DISABLE");
    return list ? list : "";
}

// The item of a comma-separated list at `*list`, which moves on behind it; its length.
static size_t next_item(const char **list, const char **item)
{
    size_t length = strcspn(*list, ",");
    *item = *list;
    *list += length + ((*list)[length] == ',');
    return length;
}

enum rb_status rb_cpu_check_disabled(struct rb_error *error)
{
    const char *list = disabled_list(), *item;
    while (*list) {
        size_t length = next_item(&list, &item);
        if (!find(item, length))
            return rb_error_set(error, RB_INVALID,
                                "RAYBENCH_CPU_DISABLE: there is no feature '%.*s' (sse2, avx2, "
                                "bmi2, avx512f, neon)",
                                (int)(length < 40 ? length : 40), item);
    }
    return RB_OK;
}

bool rb_cpu_has(const char *name, int length)
{
    const struct feature *feature = find(name, (size_t)length);
    const char *list = disabled_list(), *item;
    while (*list) {
        size_t item_length = next_item(&list, &item);
        if (find(item, item_length) == feature)
            return false;
    }
    return feature && feature->present();
}

const char *rb_cpu_feature(int index)
{
    return index < FEATURE_COUNT ? features[index].name : NULL;
}
