#include "bench/shell/completions.h"

#include "bench/shell/commands.h"
#include "bench/shell/complete.h"
#include "cli/commands.h"

#include <string.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_completions = {
    .name = "completions",
    .summary = "print the completion script of a shell",
    .synopsis = "bash|zsh|fish",
    .text =
        "The scripts know the commands, their options and what these take, from the tables that\n"
        "parse them. `make install` puts them where shells look.\n\n"
        "  raybench completions bash >~/.local/share/bash-completion/completions/raybench\n"
        "  raybench completions zsh >\"${fpath[1]}/_raybench\"\n"
        "  raybench completions fish >~/.config/fish/completions/raybench.fish",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){NULL},
    .run = run,
};

static const struct {
    const char *name;
    void (*put)(FILE *out, const struct rb_command *const *commands);
} shells[] = {{"bash", rb_complete_bash}, {"zsh", rb_complete_zsh}, {"fish", rb_complete_fish}};

static int run(const struct rb_arguments *arguments)
{
    const char *name = arguments->positional[0];
    for (size_t i = 0; i < sizeof shells / sizeof *shells; i++)
        if (strcmp(name, shells[i].name) == 0) {
            shells[i].put(stdout, rb_commands);
            return 0;
        }
    struct rb_error error = {0};
    rb_error_set(&error, RB_INVALID, "completions of which shell? bash, zsh or fish, not '%.200s'",
                 name);
    return rb_report(RB_INVALID, &error);
}
