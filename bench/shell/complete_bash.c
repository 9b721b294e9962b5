// bash breaks words at =, so "--depth=3" arrives in three words; the script drops the second. It
// keeps to what bash 3.2 has.
#include "bench/shell/complete.h"

static void put_values(FILE *out, const char *value)
{
    static const struct {
        unsigned bit;
        const char *kind;
    } kinds[] = {{RB_TAKES_FILES, "files"}, {RB_TAKES_FOLDERS, "folders"}, {RB_TAKES_LIST, "list"}};
    unsigned takes = rb_complete_takes(value);
    fprintf(out, " words='");
    rb_complete_words(out, value);
    fprintf(out, "' kind='");
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (takes & kinds[i].bit)
            fprintf(out, "%s ", kinds[i].kind);
    fprintf(out, "' ;;\n");
}

static void put_command_values(FILE *out, const struct rb_command *command)
{
    struct rb_position positions[RB_POSITIONS_MAX];
    const struct rb_option *option;
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        if (option->value) {
            fprintf(out, "    %s:%s)", command->name, option->name);
            put_values(out, option->value);
        }
    int count = rb_complete_positions(command, positions);
    for (int i = 0; i < count; i++) {
        if (positions[i].repeated)
            fprintf(out, "    %s:[0-9]*)", command->name);
        else
            fprintf(out, "    %s:%d)", command->name, i + 1);
        put_values(out, positions[i].value);
    }
}

static void put_options(FILE *out, const struct rb_command *command)
{
    const struct rb_option *option;
    fprintf(out, "    %s) words='", command->name);
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        fprintf(out, "%s%s", i ? " " : "", option->name);
    fprintf(out, "' ;;\n");
}

static const char head[] =
    "# bash completion of raybench, made by `raybench completions bash`.\n"
    "\n"
    "# COMMAND OPTION|POSITION: what can stand there; fails where nothing does.\n"
    "_raybench_values()\n"
    "{\n"
    "    case $1:$2 in\n";

static const char middle[] = "    *) return 1 ;;\n"
                             "    esac\n"
                             "}\n"
                             "\n"
                             "# COMMAND: its options; without one what stands in its place.\n"
                             "_raybench_options()\n"
                             "{\n"
                             "    case $1 in\n";

static const char tail[] =
    "    esac\n"
    "}\n"
    "\n"
    "_raybench()\n"
    "{\n"
    "    local command=${COMP_WORDS[1]} word=${COMP_WORDS[COMP_CWORD]}\n"
    "    local option='' position=1 words='' kind='' prefix='' i\n"
    "    COMPREPLY=()\n"
    "    [[ $word == = ]] && word=\n"
    "    for ((i = 2; i < COMP_CWORD; i++)); do\n"
    "        if [[ ${COMP_WORDS[i]} == = ]]; then\n"
    "            continue\n"
    "        elif [[ $option ]]; then\n"
    "            option=\n"
    "        elif [[ ${COMP_WORDS[i]} != -?* ]]; then\n"
    "            ((position++))\n"
    "        elif _raybench_values \"$command\" \"${COMP_WORDS[i]}\"; then\n"
    "            option=${COMP_WORDS[i]}\n"
    "        fi\n"
    "    done\n"
    "    words='' kind=''\n"
    "    if ((COMP_CWORD == 1)); then\n"
    "        _raybench_options ''\n"
    "    elif [[ $option ]]; then\n"
    "        _raybench_values \"$command\" \"$option\"\n"
    "    elif [[ $word == -* ]]; then\n"
    "        _raybench_options \"$command\"\n"
    "    else\n"
    "        _raybench_values \"$command\" \"$position\"\n"
    "    fi\n"
    "    local actions=(-W \"$words\")\n"
    "    [[ $kind == *files* ]] && actions+=(-f)\n"
    "    [[ $kind == *folders* ]] && actions+=(-d)\n"
    "    [[ $kind == *f* ]] && compopt -o filenames 2>/dev/null\n"
    "    if [[ $kind == *list* ]]; then\n"
    "        compopt -o nospace 2>/dev/null\n"
    "        [[ $word == *,* ]] && prefix=${word%,*},\n"
    "    fi\n"
    "    while IFS= read -r i; do\n"
    "        COMPREPLY+=(\"$i\")\n"
    "    done < <(compgen -P \"$prefix\" \"${actions[@]}\" -- \"${word#\"$prefix\"}\")\n"
    "}\n"
    "\n"
    "complete -F _raybench raybench\n";

void rb_complete_bash(FILE *out, const struct rb_command *const *commands)
{
    const struct rb_command *const *command = rb_complete_shown(commands);
    fputs(head, out);
    for (; *command; command = rb_complete_shown(command + 1))
        put_command_values(out, *command);
    fputs(middle, out);
    fprintf(out, "    '') words='");
    for (command = rb_complete_shown(commands); *command; command = rb_complete_shown(command + 1))
        fprintf(out, "%s ", (*command)->name);
    fprintf(out, "--help --version' ;;\n");
    for (command = rb_complete_shown(commands); *command; command = rb_complete_shown(command + 1))
        put_options(out, *command);
    fputs(tail, out);
}
