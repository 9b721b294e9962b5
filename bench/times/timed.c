#define _DEFAULT_SOURCE // wait4
#include "bench/times/timed.h"

#include "measure/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const int passed_on[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
enum { PASSED_ON_COUNT = sizeof passed_on / sizeof *passed_on, LINE_ROOM = 200 };

static volatile sig_atomic_t interrupted;
static volatile pid_t child;

static void pass_on(int signal_number)
{
    interrupted = signal_number;
    if (child > 0)
        kill(-child, signal_number);
}

int rb_timed_interrupted(void)
{
    return interrupted;
}

static int spawn(char *const argv[], char *const environment[], const char *log,
                 const sigset_t *mask, pid_t *pid)
{
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    int cause = posix_spawn_file_actions_init(&files);
    if (cause)
        return cause;
    cause = posix_spawnattr_init(&attributes);
    if (cause == 0) {
        const short flags = POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK;
        posix_spawnattr_setpgroup(&attributes, 0);
        posix_spawnattr_setsigmask(&attributes, mask);
        posix_spawnattr_setflags(&attributes, flags);
        cause = posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
        cause =
            cause ? cause : posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
        cause = cause ? cause
                      : posix_spawn_file_actions_addopen(&files, 2, log,
                                                         O_WRONLY | O_CREAT | O_TRUNC, 0666);
        cause = cause ? cause
                      : posix_spawnp(pid, argv[0], &files, &attributes, argv,
                                     environment ? environment : environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&files);
    return cause;
}

static double seconds(struct timeval time)
{
    return (double)time.tv_sec + (double)time.tv_usec * 1e-6;
}

// Starts the process and reaps it. 0, or the errno of what failed. The signals wait until there is
// a process to pass them on to.
static int run_and_reap(char *const argv[], char *const environment[], const char *log,
                        const sigset_t *blocked, struct rb_timed_result *time, int *wait_status)
{
    sigset_t old_mask;
    struct rusage usage;
    pid_t pid = 0, reaped;
    sigprocmask(SIG_BLOCK, blocked, &old_mask);
    uint64_t start_ns = rb_clock_ns();
    int cause = spawn(argv, environment, log, &old_mask, &pid);
    child = cause ? 0 : pid;
    sigprocmask(SIG_SETMASK, &old_mask, NULL);
    if (cause)
        return cause;
    do
        reaped = wait4(pid, wait_status, 0, &usage);
    while (reaped < 0 && errno == EINTR);
    uint64_t end_ns = rb_clock_ns();
    child = 0;
    if (reaped < 0)
        return errno;
    time->wall_s = (double)(end_ns - start_ns) * 1e-9;
    time->user_s = seconds(usage.ru_utime);
    time->system_s = seconds(usage.ru_stime);
    return 0;
}

// The last line of a file that is not empty, or the end of it; "" if there is none.
static void last_line(const char *path, char line[LINE_ROOM])
{
    char text[LINE_ROOM];
    line[0] = '\0';
    FILE *file = fopen(path, "r");
    while (file && fgets(text, sizeof text, file)) {
        text[strcspn(text, "\r\n")] = '\0';
        if (text[0])
            memcpy(line, text, sizeof text);
    }
    if (file)
        fclose(file);
}

static enum rb_status judge(const char *program, const char *log, int wait_status,
                            struct rb_error *error)
{
    char said[LINE_ROOM];
    if (interrupted)
        return rb_error_set(error, RB_FAILED, "interrupted");
    if (WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == 0)
        return RB_OK;
    last_line(log, said);
    if (WIFSIGNALED(wait_status))
        return rb_error_set(error, RB_FAILED, "%s was ended by signal %d", program,
                            WTERMSIG(wait_status));
    return rb_error_set(error, RB_FAILED, "%s failed with code %d: %s", program,
                        WEXITSTATUS(wait_status), said[0] ? said : "it does not say why");
}

enum rb_status rb_timed_run(char *const argv[], char *const environment[], const char *log,
                            struct rb_timed_result *time, struct rb_error *error)
{
    struct sigaction action = {.sa_handler = pass_on}, old[PASSED_ON_COUNT];
    sigemptyset(&action.sa_mask);
    interrupted = 0;
    for (int i = 0; i < PASSED_ON_COUNT; i++) {
        sigaddset(&action.sa_mask, passed_on[i]);
        sigaction(passed_on[i], NULL, &old[i]);
    }
    for (int i = 0; i < PASSED_ON_COUNT; i++)
        if (old[i].sa_handler != SIG_IGN) // nohup stays in force
            sigaction(passed_on[i], &action, NULL);
    int wait_status = 0,
        cause = run_and_reap(argv, environment, log, &action.sa_mask, time, &wait_status);
    for (int i = 0; i < PASSED_ON_COUNT; i++)
        sigaction(passed_on[i], &old[i], NULL);
    if (cause)
        return rb_error_set(error, RB_FAILED, "cannot run %s: %s", argv[0], strerror(cause));
    return judge(argv[0], log, wait_status, error);
}
