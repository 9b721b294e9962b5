// The command line: picks the sub-command, and keeps the promises that hold for all of them (exit
// codes, no half-written file after a signal, no lost output).
#define _POSIX_C_SOURCE 200809L
#include "base/cpu.h"
#include "base/file.h"
#include "bench/shell/commands.h"
#include "cli/commands.h"
#include "cli/suggest.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_help(void)
{
    printf("raybench measures a ray tracer: time per ray, per kernel, per bounce.\n\n"
           "usage: raybench COMMAND [arguments]\n\n");
    for (const struct rb_command *const *command = rb_commands; *command; command++)
        if (!(*command)->hidden)
            printf("  %-12s %s\n", (*command)->name, (*command)->summary);
    printf("\nraybench COMMAND --help explains a command; raybench --version prints the version.\n"
           "Start with: raybench render balls_high -o balls.ppm\n\n"
           "Exit codes: 0 fine, 1 runtime failure (memory, disk), 2 bad usage or input.\n");
}

static void remove_partial_output(int signal_number)
{
    rb_output_discard_on_signal();
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

// nohup stays in force. A file size limit shows as a failed write.
static void catch_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU};
    struct sigaction action = {.sa_handler = remove_partial_output}, old;
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (sigaction(numbers[i], NULL, &old) == 0 &&
            (numbers[i] != SIGHUP || old.sa_handler != SIG_IGN))
            sigaction(numbers[i], &action, NULL);
    signal(SIGXFSZ, SIG_IGN);
}

// Standard streams that the caller closed must not become the next file we open. Opened in the
// wrong direction, so that using them still fails.
static bool occupy_standard_streams(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) == -1 && open("/dev/null", fd ? O_RDONLY : O_WRONLY) != fd)
            return false;
    return true;
}

// The words of the command line with blanks between them; for people.
static char command_line[4096];

static void join_words(int count, char **words)
{
    size_t length = 0;
    for (int i = 0; i < count && length < sizeof command_line; i++)
        length += (size_t)snprintf(command_line + length, sizeof command_line - length, "%s%s",
                                   i ? " " : "", words[i]);
}

static int dispatch(const struct rb_command *command, int count, char **words)
{
    struct rb_arguments arguments = {.command_line = command_line};
    struct rb_error error = {0};
    if (rb_options_parse(command, count, words, &arguments, &error)) {
        struct rb_error hinted = error;
        snprintf(hinted.text, sizeof hinted.text, "%.300s (see raybench %s --help)", error.text,
                 command->name);
        return rb_report(RB_INVALID, &hinted);
    }
    if (arguments.help) {
        rb_options_help(command);
        return 0;
    }
    return command->run(&arguments);
}

static int run(int argc, char **argv)
{
    struct rb_error error = {0};
    join_words(argc, argv);
    if (rb_cpu_check_disabled(&error))
        return rb_report(RB_INVALID, &error);
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_help();
        return 0;
    }
    if (strcmp(name, "--version") == 0) {
        printf("raybench " RB_VERSION "\n");
        return 0;
    }
    struct rb_suggestion suggestion = {.typed = name, .length = strlen(name)};
    for (const struct rb_command *const *command = rb_commands; *command; command++) {
        if (strcmp(name, (*command)->name) == 0)
            return dispatch(*command, argc - 2, argv + 2);
        if (!(*command)->hidden)
            rb_suggestion_offer(&suggestion, (*command)->name);
    }
    char hint[RB_SUGGESTION_TEXT];
    if (argc > 1)
        fprintf(stderr, "raybench: there is no command '%s'%s (see raybench --help)\n", name,
                rb_suggestion_text(&suggestion, hint));
    else
        fprintf(stderr, "raybench: no command given (see raybench --help)\n");
    return RB_INVALID;
}

int main(int argc, char **argv)
{
    if (!occupy_standard_streams())
        return RB_FAILED;
    catch_signals();
    int code = run(argc, argv);
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == 0) {
        perror("raybench: cannot write to standard output");
        return RB_FAILED;
    }
    return code;
}
