// Every command is one call of zsh's _arguments, whose specifications have the help texts. In these
// brackets end a text, colons end a message, and each specification is a quoted word.
#include "bench/shell/complete.h"

static const struct rb_escape escapes[] = {
    {'\'', "'\\''"}, {'\\', "\\\\"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}, {0, NULL},
};

// ":VALUE:ACTION", what a value is called and what offers some.
static void put_action(FILE *out, const char *value)
{
    static const struct {
        unsigned bit;
        const char *flag;
    } flags[] = {{RB_TAKES_FILES, " -f"}, {RB_TAKES_FOLDERS, " -d"}, {RB_TAKES_LIST, " -l"}};
    unsigned takes = rb_complete_takes(value);
    fputc(':', out);
    rb_put_escaped(out, value, escapes);
    fprintf(out, takes ? ": _raybench_offer" : ": ");
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        if (takes & flags[i].bit)
            fprintf(out, "%s", flags[i].flag);
    if (takes & RB_TAKES_WORDS) {
        fputc(' ', out);
        rb_complete_words(out, value);
    }
}

static void put_option(FILE *out, const struct rb_option *option)
{
    bool is_long = option->name[1] == '-';
    fprintf(out, " \\\n            '%s%s[", option->name, option->value && is_long ? "=" : "");
    rb_put_escaped(out, option->help, escapes);
    fputc(']', out);
    if (option->value)
        put_action(out, option->value);
    fputc('\'', out);
}

static void put_command(FILE *out, const struct rb_command *command)
{
    struct rb_position positions[RB_POSITIONS_MAX];
    const struct rb_option *option;
    fprintf(out, "    %s)\n        _arguments", command->name);
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        put_option(out, option);
    int count = rb_complete_positions(command, positions);
    for (int i = 0; i < count; i++) {
        fprintf(out, positions[i].repeated ? " \\\n            '*" : " \\\n            '%d", i + 1);
        put_action(out, positions[i].value);
        fputc('\'', out);
    }
    fprintf(out, "\n        ;;\n");
}

static const char head[] =
    "#compdef raybench\n"
    "# zsh completion of raybench, made by `raybench completions zsh`.\n"
    "\n"
    "# [-f] [-d] [-l] [WORD...]: offers the words, files, folders; -l in a list with commas.\n"
    "_raybench_offer() {\n"
    "    local -a kinds candidates suffix\n"
    "    while [[ $1 == -* ]]; do\n"
    "        case $1 in\n"
    "        -f) kinds+=('files:file:_files') ;;\n"
    "        -d) kinds+=('folders:folder:_files -/') ;;\n"
    "        -l) compset -P '*,'; suffix=(-S '') ;;\n"
    "        esac\n"
    "        shift\n"
    "    done\n"
    "    candidates=(\"$@\")\n"
    "    (( $# )) && kinds+=('words:value:compadd \"$suffix[@]\" -a candidates')\n"
    "    _alternative $kinds\n"
    "}\n"
    "\n"
    "_raybench() {\n"
    "    local -a commands=(\n";

static const char middle[] = "    )\n"
                             "    if (( CURRENT == 2 )); then\n"
                             "        _describe -t commands command commands\n"
                             "        _arguments '--help[this text]' '--version[the version]'\n"
                             "        return\n"
                             "    fi\n"
                             "    shift words\n"
                             "    (( CURRENT-- ))\n"
                             "    case $words[1] in\n";

static const char tail[] = "    esac\n"
                           "}\n"
                           "\n"
                           "_raybench \"$@\"\n";

void rb_complete_zsh(FILE *out, const struct rb_command *const *commands)
{
    const struct rb_command *const *command = rb_complete_shown(commands);
    fputs(head, out);
    for (; *command; command = rb_complete_shown(command + 1)) {
        fprintf(out, "        '%s:", (*command)->name);
        rb_put_escaped(out, (*command)->summary, escapes);
        fprintf(out, "'\n");
    }
    fputs(middle, out);
    for (command = rb_complete_shown(commands); *command; command = rb_complete_shown(command + 1))
        put_command(out, *command);
    fputs(tail, out);
}
