#define _POSIX_C_SOURCE 200809L
#include "bench/simulate/simulate.h"

#include "base/file.h"
#include "base/memory.h"
#include "bench/simulate/callgrind.h"
#include "bench/times/timed.h"
#include "measure/simulate.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_ROOM = 1024, OWN_WORDS = 16, WORD_ROOM = PATH_ROOM + 64, PROGRAM_FD = 100 };

// The whole environment, but for variables that decide what is simulated and where valgrind lies.
static const char *const fixed[] = {"PATH=/usr/local/bin:/usr/bin:/bin", "LC_ALL=C"};
static const char *const passed_on[] = {"RAYBENCH_CPU_DISABLE", "VALGRIND_LIB"};
enum {
    FIXED_COUNT = sizeof fixed / sizeof *fixed,
    PASSED_ON_COUNT = sizeof passed_on / sizeof *passed_on
};

static bool find_program(const char *name, char path[PATH_ROOM])
{
    const char *folders = getenv("PATH");
    for (size_t length; folders && *folders; folders += length + (folders[length] == ':')) {
        length = strcspn(folders, ":");
        int used = snprintf(path, PATH_ROOM, "%.*s/%s", (int)length, folders, name);
        if (length && used < PATH_ROOM && access(path, X_OK) == 0)
            return true;
    }
    return false;
}

// Debian's valgrind is a script around valgrind.bin; its shell adds the working folder to the
// environment, and so moves the stack.
static bool find_valgrind(char path[PATH_ROOM])
{
    return find_program("valgrind.bin", path) || find_program("valgrind", path);
}

enum rb_status rb_simulate_check(struct rb_error *error)
{
    char path[PATH_ROOM];
    if (!find_valgrind(path))
        return rb_error_set(error, RB_FAILED,
                            "valgrind is not installed: make setup, or apt-get install valgrind; "
                            "then make");
    if (!rb_simulate_built())
        return rb_error_set(error, RB_FAILED,
                            "this program was built without valgrind's headers: make setup, or "
                            "apt-get install valgrind; then make");
    return RB_OK;
}

struct command {
    char own[OWN_WORDS][WORD_ROOM]; // words before those of the program
    int own_count;
    char passed_on[PASSED_ON_COUNT][WORD_ROOM];
    char *environment[FIXED_COUNT + PASSED_ON_COUNT + 1];
};

__attribute__((format(printf, 2, 3))) static void add(struct command *command, const char *format,
                                                      ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(command->own[command->own_count++], WORD_ROOM, format, values);
    va_end(values);
}

static void add_cache(struct command *command, const char *name,
                      const struct rb_cache_geometry *cache)
{
    add(command, "--%s=%" PRIu64 ",%" PRIu32 ",%" PRIu32, name, cache->bytes, cache->ways,
        cache->line_bytes);
}

static void add_simulator(struct command *command, const char *valgrind, const char *folder,
                          const struct rb_caches *caches)
{
    static const char *const switches[] = {
        "--command-line-only=yes", // no ~/.valgrindrc
        "-q",
        "--tool=callgrind",
        "--instr-atstart=no",
        "--collect-atstart=no",
        "--cache-sim=yes",
        "--branch-sim=yes",
        "--dump-line=no", // shorter dumps
        "--combine-dumps=yes",
    };
    add(command, "%s", valgrind);
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        add(command, "%s", switches[i]);
    add_cache(command, "I1", &caches->l1i);
    add_cache(command, "D1", &caches->l1d);
    add_cache(command, "LL", &caches->ll);
    add(command, "--callgrind-out-file=%s/out", folder);
}

static void fill_environment(struct command *command)
{
    int count = 0;
    for (int i = 0; i < FIXED_COUNT; i++)
        command->environment[count++] = (char *)fixed[i];
    for (int i = 0; i < PASSED_ON_COUNT; i++) {
        const char *value = getenv(passed_on[i]);
        snprintf(command->passed_on[i], WORD_ROOM, "%s=%s", passed_on[i], value ? value : "");
        if (value)
            command->environment[count++] = command->passed_on[i];
    }
    command->environment[count] = NULL;
}

// Opens the program under a name that does not depend on where it lies: its path stands on its
// stack, and where that begins decides what meets in a line of the cache. Two copies of one program
// in two folders differed by 2 % in their misses. Returns the descriptor, -1 if it cannot be read.
static int open_program(const char *path, char name[32])
{
    int file = open(path, O_RDONLY | O_CLOEXEC);
    int inherited = file < 0 ? -1 : fcntl(file, F_DUPFD, PROGRAM_FD);
    if (file >= 0)
        close(file);
    snprintf(name, 32, "/proc/self/fd/%d", inherited);
    return inherited;
}

// Runs our own words and then those of the program.
static enum rb_status run_command(struct command *command, char *const *words, const char *log,
                                  struct rb_error *error)
{
    struct rb_timed_result time;
    size_t count = 0, own_count = (size_t)command->own_count;
    char name[32];
    int program = open_program(words[0], name);
    if (program < 0)
        return rb_error_set(error, RB_FAILED, "cannot read %.200s: %s", words[0], strerror(errno));
    while (words[count])
        count++;
    char **all = rb_alloc(own_count + count + 1, sizeof *all);
    enum rb_status status = all ? RB_OK : rb_error_memory(error, "a command line");
    if (!status) {
        for (size_t i = 0; i < own_count; i++)
            all[i] = command->own[i];
        memcpy(all + own_count, words, count * sizeof *words);
        all[own_count] = name;
        status = rb_timed_run(all, command->environment, log, &time, error);
    }
    rb_free(all);
    close(program);
    return status;
}

static enum rb_status make_folder(char folder[PATH_ROOM], struct rb_error *error)
{
    const char *parent = getenv("TMPDIR");
    snprintf(folder, PATH_ROOM, "%.900s/raybench-sim-XXXXXX", parent && *parent ? parent : "/tmp");
    if (mkdtemp(folder))
        return RB_OK;
    snprintf(error->file, sizeof error->file, "%.255s", folder);
    return rb_error_set(error, RB_FAILED, "cannot make a temporary folder: %s", strerror(errno));
}

// A simulator that was ended may have left files of any name.
static void remove_folder(const char *folder)
{
    DIR *entries = opendir(folder);
    for (struct dirent *entry; entries && (entry = readdir(entries));) {
        char path[PATH_ROOM + sizeof entry->d_name + 1];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        unlink(path); // not . and ..
    }
    if (entries)
        closedir(entries);
    rmdir(folder);
}

static enum rb_status read_record(const char *folder, struct rb_simulated *simulated,
                                  struct rb_error *error)
{
    char path[PATH_ROOM + 8], *text;
    size_t size;
    snprintf(path, sizeof path, "%s/out", folder);
    enum rb_status status = rb_file_read(path, &text, &size, error);
    if (status == RB_OK)
        status = rb_callgrind_parse(text, simulated, error);
    rb_free(text);
    if (status == RB_OK)
        error->file[0] = '\0';
    return status;
}

static enum rb_status run_in(const char *folder, const char *valgrind, char *const *words,
                             const struct rb_caches *caches, struct rb_simulated *simulated,
                             struct rb_error *error)
{
    static struct command command; // too large for the stack
    char log[PATH_ROOM + 8];
    command.own_count = 0;
    add_simulator(&command, valgrind, folder, caches);
    fill_environment(&command);
    snprintf(log, sizeof log, "%s/log", folder);
    enum rb_status status = run_command(&command, words, log, error);
    *simulated = (struct rb_simulated){.caches = *caches};
    return status ? status : read_record(folder, simulated, error);
}

enum rb_status rb_simulate_run(char *const *words, const struct rb_caches *caches,
                               struct rb_simulated *simulated, struct rb_error *error)
{
    char folder[PATH_ROOM], valgrind[PATH_ROOM];
    enum rb_status status = rb_simulate_check(error);
    if (status == RB_OK)
        status = make_folder(folder, error);
    if (status)
        return status;
    find_valgrind(valgrind);
    status = run_in(folder, valgrind, words, caches, simulated, error);
    remove_folder(folder);
    if (rb_timed_interrupted())
        raise(rb_timed_interrupted());
    return status;
}
