#define _POSIX_C_SOURCE 200809L
#include "bench/run/process.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static volatile sig_atomic_t signal_seen;

static void note_signal(int number)
{
    signal_seen = number;
}

bool rb_process_interrupted(void)
{
    return signal_seen != 0;
}

void rb_process_catch_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action = {.sa_handler = note_signal}, old; // no SA_RESTART: reads end early
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (sigaction(numbers[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN)
            sigaction(numbers[i], &action, NULL);
}

void rb_process_raise_again(void)
{
    signal(signal_seen, SIG_DFL);
    raise(signal_seen);
}

enum rb_status rb_process_self(char *path, size_t size, struct rb_error *error)
{
    ssize_t length = readlink("/proc/self/exe", path, size - 1);
    if (length <= 0 || (size_t)length >= size - 1)
        return rb_error_set(error, RB_FAILED, "cannot find the running program: no /proc here?");
    path[length] = '\0';
    return RB_OK;
}

void rb_worker_word(struct rb_worker_words *words, const char *format, ...)
{
    va_list values;
    if (words->count == RB_WORKER_WORDS_MAX)
        abort(); // more options than we know of
    va_start(values, format);
    vsnprintf(words->text[words->count++], RB_WORKER_WORD_MAX, format, values);
    va_end(values);
}

// The worker's standard output is the writing end of `ends`; nothing else is handed down.
static int spawn(char *const *words, const int ends[2], pid_t *pid)
{
    posix_spawn_file_actions_t actions;
    int problem = posix_spawn_file_actions_init(&actions);
    if (problem)
        return problem;
    problem = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (!problem)
        problem = posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    if (!problem)
        problem = posix_spawn(pid, words[0], &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    return problem;
}

static int spawn_bound(char *const *words, const int ends[2], bool bind, pid_t *pid)
{
    bool ours =
        bind && !getenv("OMP_PROC_BIND") && !getenv("OMP_PLACES") && !getenv("GOMP_CPU_AFFINITY");
    if (ours)
        setenv("OMP_PROC_BIND", "true", 1);
    int problem = spawn(words, ends, pid);
    if (ours)
        unsetenv("OMP_PROC_BIND");
    return problem;
}

// Reads one record. Returns how many bytes there were; fewer at the end or after a signal.
static size_t read_record(int from, char *record, size_t bytes)
{
    size_t have = 0;
    while (have < bytes && !rb_process_interrupted()) {
        ssize_t got = read(from, record + have, bytes - have);
        if (got == 0 || (got < 0 && errno != EINTR))
            break;
        have += got > 0 ? (size_t)got : 0;
    }
    return have;
}

static enum rb_status take_all(int from, void *record, size_t bytes, rb_take_fn *take, void *user,
                               struct rb_error *error)
{
    const struct rb_sample *sample = record;
    size_t got;
    bool mismatch = false, any = false;
    while ((got = read_record(from, record, bytes)) == bytes) {
        if (sample->magic != RB_SAMPLE_MAGIC)
            return rb_error_set(error, RB_FAILED,
                                "the program is another version of raybench, "
                                "whose samples cannot be read");
        any = true;
        mismatch |= sample->mismatch;
        if (!take(user, sample))
            return rb_error_memory(error, "the samples");
    }
    if (got > 0 && !rb_process_interrupted())
        return rb_error_set(error, RB_FAILED, "the worker's last sample is cut short");
    if (!any && !rb_process_interrupted())
        return rb_error_set(error, RB_FAILED, "the worker sent no samples");
    return mismatch ? RB_INVALID : RB_OK;
}

static enum rb_status judge(int how, enum rb_status status, struct rb_error *error)
{
    if (status == RB_FAILED || rb_process_interrupted())
        return status;
    if (WIFSIGNALED(how))
        return rb_error_set(error, RB_FAILED, "the worker was ended by signal %d (%s)",
                            WTERMSIG(how), strsignal(WTERMSIG(how)));
    if (WEXITSTATUS(how) != (int)status)
        return rb_error_set(error, RB_FAILED, "the worker failed with exit code %d",
                            WEXITSTATUS(how));
    return status;
}

enum rb_status rb_process_run(const struct rb_worker_words *words, bool bind, size_t record_bytes,
                              rb_take_fn *take, void *user, struct rb_error *error)
{
    char *pointers[RB_WORKER_WORDS_MAX + 1] = {NULL};
    int ends[2], how = 0;
    pid_t pid = 0;
    for (int i = 0; i < words->count; i++)
        pointers[i] = (char *)words->text[i];
    if (pipe(ends) != 0)
        return rb_error_set(error, RB_FAILED, "cannot make a pipe: %s", strerror(errno));
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    int problem = spawn_bound(pointers, ends, bind, &pid);
    close(ends[1]);
    if (problem) {
        close(ends[0]);
        return rb_error_set(error, RB_FAILED, "cannot start %.200s: %s", pointers[0],
                            strerror(problem));
    }
    void *record = malloc(record_bytes + 1);
    enum rb_status status = !take    ? RB_OK
                            : record ? take_all(ends[0], record, record_bytes, take, user, error)
                                     : rb_error_memory(error, "the samples");
    free(record);
    close(ends[0]);
    if (rb_process_interrupted() || status == RB_FAILED)
        kill(pid, SIGTERM);
    while (waitpid(pid, &how, 0) < 0 && errno == EINTR)
        ;
    return judge(how, status, error);
}
