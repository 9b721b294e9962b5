// env.json: what is written can be read back.
#define _GNU_SOURCE
#include "bench/machine/env.h"

#include "base/memory.h"
#include "bench/data/json_read.h"
#include "tests/unit/tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/raybench-env-XXXXXX";
static char value[4096];

// A new file each time: ext4 flushes one that was emptied and written again.
static bool put(const char *bytes, size_t length)
{
    unlink(path);
    FILE *file = fopen(path, "wb");
    return file && fwrite(bytes, 1, length, file) == length && fclose(file) == 0;
}

// The text at a dotted path goes to `value`.
static bool find(const char *key)
{
    struct rb_error error = {0};
    char *text;
    value[0] = '\0';
    if (rb_json_load(path, &text, &error))
        return false;
    bool found = rb_json_get_text(rb_json_find(text, key), value, sizeof value);
    rb_free(text);
    return found;
}

static bool read_back(const char *key, const char *expected)
{
    return find(key) && strcmp(value, expected) == 0;
}

static void test_written(char *text)
{
    static const struct rb_env_scene scenes[] = {{"balls \"6\"", 0x0123456789abcdef, 7382}};
    const struct rb_env_run run = {
        .command_line = "raybench bench \"a b\" \\ \n caf\xc3\xa9",
        .session = "20260101T000000Z-42",
        .seed = UINT64_MAX,
        .scenes = scenes,
        .scene_count = 1,
        .tsc_ns_per_tick = 0.385,
        .tsc_error_ppm = (double)NAN,
        .probe_ns = 18.5,
        .started = 86400,
    };
    setenv("OMP_NUM_THREADS", "a\"b", 1);
    setenv("RAYBENCH_TEST", "", 1);
    char *written = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&written, &length);
    rb_env_write(stream, &run);
    ok(fclose(stream) == 0 && length < 64 * 1024 && put(written, length), "it is written");
    snprintf(text, 64 * 1024, "%s", written);
    free(written);
    ok(read_back("session", run.session), "the session");
    ok(read_back("command_line", run.command_line), "the command line, byte for byte");
    ok(read_back("started", "1970-01-02T00:00:00Z"), "the time of the start, in UTC");
    ok(read_back("environment.OMP_NUM_THREADS", "a\"b"), "a variable of OpenMP");
    ok(read_back("environment.RAYBENCH_TEST", ""), "an empty variable of ours");
    char compiler[16] = "gcc ";
#ifdef __clang__
    snprintf(compiler, sizeof compiler, "%s", "");
#endif
    ok(find("build.compiler") && strstr(value, __VERSION__) &&
           strncmp(value, compiler, strlen(compiler)) == 0,
       "the compiler");
    ok(find("build.flags") && strstr(value, " -std=c11 "), "its flags");
    ok(find("binary.hash") && strlen(value) == 16, "the hash of the binary");
    ok(find("binary.path") && strstr(value, "unit/env"), "its path");
    ok(strstr(text, "\"seed\": 18446744073709551615,"), "a seed of 64 bits");
    ok(strstr(text, "\"tsc_error_ppm\": null,"), "what is not known is null");
    ok(strstr(text, "\"hash\": \"0123456789abcdef\","), "the hash of a scene");
    ok(strstr(text, "\"complete\": false,"), "an unfinished run");
    ok(strstr(text, "\"pinning\": null,"), "pinning that nobody told of");
}

int main(void)
{
    static char text[64 * 1024];
    int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    test_written(text);
    unlink(path);
    return done();
}
