// env.json: what is written can be read back, and no bytes whatever upset the reader.
#define _GNU_SOURCE
#include "bench/machine/env.h"

#include "base/hash.h"
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

static bool read_back(const char *key, const char *expected)
{
    return rb_env_json_text(path, key, value, sizeof value) && strcmp(value, expected) == 0;
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
    ok(rb_env_json_text(path, "build.compiler", value, sizeof value) &&
           strstr(value, __VERSION__) && strncmp(value, compiler, strlen(compiler)) == 0,
       "the compiler");
    ok(rb_env_json_text(path, "build.flags", value, sizeof value) && strstr(value, " -std=c11 "),
       "its flags");
    ok(rb_env_json_text(path, "binary.hash", value, sizeof value) && strlen(value) == 16,
       "the hash of the binary");
    ok(rb_env_json_text(path, "binary.path", value, sizeof value) && strstr(value, "unit/env"),
       "its path");
    ok(strstr(text, "\"seed\": 18446744073709551615,"), "a seed of 64 bits");
    ok(strstr(text, "\"tsc_error_ppm\": null,"), "what is not known is null");
    ok(strstr(text, "\"hash\": \"0123456789abcdef\","), "the hash of a scene");
    ok(strstr(text, "\"complete\": false,"), "an unfinished run");
    ok(strstr(text, "\"pinning\": null,"), "pinning that nobody told of");
    ok(!rb_env_json_text(path, "seed", value, sizeof value), "a number is no string");
    ok(!rb_env_json_text(path, "host", value, sizeof value), "nor is an object");
    ok(!rb_env_json_text(path, "tools.none", value, sizeof value), "nor what is not there");
    ok(!rb_env_json_text(path, "session", value, 8) && !value[0], "nothing is cut to fit");
    ok(rb_env_json_text(path, "session", value, strlen(run.session) + 1), "but it may just fit");
    ok(!rb_env_json_text(path, "session", value, strlen(run.session)), "one byte less is too few");
    ok(!rb_env_json_text("/nonexistent", "session", value, sizeof value) && !value[0], "no file");
    ok(!rb_env_json_text("/tmp", "session", value, sizeof value), "a folder");
}

// TEXT holds EXPECTED under "a.b", or nothing if that is NULL.
static void reads(const char *text, const char *expected)
{
    put(text, strlen(text));
    bool found = rb_env_json_text(path, "a.b", value, sizeof value);
    bool right = expected ? found && strcmp(value, expected) == 0 : !found && !value[0];
    if (!ok(right, "%.*s", (int)strcspn(text, "\n"), text))
        note("%d '%s'", found, value);
}

static void test_texts(void)
{
    reads("{\"a\":{\"b\":\"x\"}}", "x");
    reads(" {\"c\" : [1, -0.5e+3, {\"b\":\"no\"}], \"a\"\n: { \"b\" : \"x\" } } ", "x");
    reads("{\"b\":\"no\",\"a\":{\"a\":{\"b\":\"no\"},\"b\":\"\\u00e9\\n\\/\"}}", "\xe9\n/");
    reads("{\"a\":[{\"b\":\"x\"}]}", NULL);
    reads("{\"a\":\"b\"}", NULL);
    reads("{\"a.b\":\"x\"}", "x"); // a name with a dot is a path as well
    reads("{\"a\":{\"b\":null}}", NULL);
    reads("{\"a\":{\"b\":\"x\"}", NULL);
    reads("{\"a\":{\"b\":\"x\"}}}", NULL);
    reads("{\"a\":{\"b\":\"x\"},}", NULL);
    reads("{\"a\":{\"b\":\"x\"},\"c\":01}", NULL);
    reads("{\"a\":{\"b\":\"x\"},\"c\":tru}", NULL);
    reads("{\"a\":{\"b\":\"\\u0100\"}}", NULL);
    reads("{\"a\":{\"b\":\"\\u0000\"}}", NULL);
    reads("{\"a\":{\"b\":\"\\x\"}}", NULL);
    reads("{\"a\":{\"b\":\"\n\"}}", NULL);
    reads("[\"a\"]", NULL);
    reads("", NULL);
    reads("{\"a\":{\"b\":\"x\"},\"c\":[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", NULL);
}

// Cut at every length, and with bytes changed. The reader may take a change for good; it may not
// run over, and never finds a text in a file that was cut.
static void test_mutants(const char *text)
{
    size_t length = strlen(text);
    char *copy = malloc(length + 1);
    bool cut = true, same = true;
    for (size_t i = 0; i + 1 < length; i += 1 + i / 64) {
        put(text, i);
        cut &= !rb_env_json_text(path, "host.name", value, sizeof value);
    }
    ok(cut, "no cut file is taken for good");
    for (uint32_t round = 0; round < 2000; round++) {
        memcpy(copy, text, length + 1);
        for (uint32_t change = 0; change < 1 + round % 3; change++) {
            uint64_t random = rb_mix(round * 4 + change);
            copy[random % length] = (char)(random >> 56);
        }
        put(copy, length);
        char small[9];
        small[8] = '#';
        rb_env_json_text(path, "host.name", small, 8);
        rb_env_json_text(path, "host.kernel", value, sizeof value);
        same &= small[8] == '#' && memchr(small, '\0', 8);
    }
    ok(same, "changed bytes do no harm");
    free(copy);
}

int main(void)
{
    static char text[64 * 1024];
    int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    test_written(text);
    test_texts();
    test_mutants(text);
    unlink(path);
    return done();
}
