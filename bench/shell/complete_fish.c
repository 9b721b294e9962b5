// fish has one line for each option, guarded by the command it belongs to.
#include "bench/shell/complete.h"

static const struct rb_escape escapes[] = {{'\'', "\\'"}, {'\\', "\\\\"}, {0, NULL}};

static void put_candidates(FILE *out, const char *value)
{
    unsigned takes = rb_complete_takes(value);
    bool list = takes & RB_TAKES_LIST;
    fprintf(out, (takes & RB_TAKES_FILES) && !list ? " -F" : " -f");
    if (takes & RB_TAKES_FOLDERS)
        fprintf(out, " -a '(__fish_complete_directories)'");
    if (takes & RB_TAKES_WORDS) {
        fprintf(out, list ? " -a '(__raybench_list " : " -a '");
        rb_complete_words(out, value);
        fprintf(out, list ? ")'" : "'");
    }
}

// CONDITION are the arguments of __raybench_at.
static void put_line(FILE *out, const char *condition, const char *summary)
{
    fprintf(out, "complete -c raybench -n '__raybench_at%s' -d '", condition);
    rb_put_escaped(out, summary, escapes);
    fputc('\'', out);
}

static void put_command(FILE *out, const struct rb_command *command)
{
    struct rb_position positions[RB_POSITIONS_MAX];
    const struct rb_option *option;
    char condition[96];
    put_line(out, "", command->summary);
    fprintf(out, " -a %s\n", command->name);
    snprintf(condition, sizeof condition, " %s", command->name);
    for (int i = 0; (option = rb_options_at(command, i)); i++) {
        bool is_long = option->name[1] == '-';
        put_line(out, condition, option->help);
        fprintf(out, is_long ? " -l %s" : " -s %s", option->name + 1 + is_long);
        if (option->value) {
            fprintf(out, " -r");
            put_candidates(out, option->value);
        }
        fputc('\n', out);
    }
    int count = rb_complete_positions(command, positions);
    for (int i = 0; i < count; i++) {
        snprintf(condition, sizeof condition, " %s %d%s", command->name, i + 1,
                 positions[i].repeated ? " more" : "");
        put_line(out, condition, positions[i].value);
        put_candidates(out, positions[i].value);
        fputc('\n', out);
    }
}

// What takes a value, as COMMAND:OPTION.
static void put_valued(FILE *out, const struct rb_command *command)
{
    const struct rb_option *option;
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        if (option->value)
            fprintf(out, " \\\n        %s:%s", command->name, option->name);
}

static const char head[] = "# fish completion of raybench, made by `raybench completions fish`.\n"
                           "\n"
                           "# WORD...: the words, behind what a list with commas has already.\n"
                           "function __raybench_list\n"
                           "    set -l token (commandline -ct | string replace -r '^--[^=]*=' '')\n"
                           "    set -l before (string match -r '.*,' -- $token)\n"
                           "    printf '%s\\n' \"$before\"$argv\n"
                           "end\n"
                           "\n"
                           "# Is the cursor in the place of the command; or in COMMAND; or at its "
                           "argument POSITION; or at\n"
                           "# this one and more?\n"
                           "function __raybench_at # [COMMAND [POSITION [more]]]\n"
                           "    set -l words (commandline -opc)\n"
                           "    set -e words[1]\n"
                           "    test \"$words[1]\" = \"$argv[1]\"; or return 1\n"
                           "    set -q argv[2]; or return 0\n"
                           "    set -l position 0\n"
                           "    set -l option\n"
                           "    set -l valued";

static const char tail[] = "\n"
                           "    for word in $words\n"
                           "        if test -n \"$option\"\n"
                           "            set option\n"
                           "        else if contains -- \"$argv[1]:$word\" $valued\n"
                           "            set option $word\n"
                           "        else if not string match -qr '^-.' -- $word\n"
                           "            set position (math $position + 1)\n"
                           "        end\n"
                           "    end\n"
                           "    test -z \"$option\"; or return 1\n"
                           "    test $position -eq $argv[2]; and return 0\n"
                           "    set -q argv[3]; and test $position -gt $argv[2]\n"
                           "end\n"
                           "\n"
                           "complete -c raybench -f\n"
                           "complete -c raybench -n __raybench_at -l help -d 'this text'\n"
                           "complete -c raybench -n __raybench_at -l version -d 'the version'\n";

void rb_complete_fish(FILE *out, const struct rb_command *const *commands)
{
    const struct rb_command *const *command = rb_complete_shown(commands);
    fputs(head, out);
    for (; *command; command = rb_complete_shown(command + 1))
        put_valued(out, *command);
    fputs(tail, out);
    for (command = rb_complete_shown(commands); *command; command = rb_complete_shown(command + 1))
        put_command(out, *command);
}
