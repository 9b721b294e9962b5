#include "bench/shell/man.h"

#include "bench/shell/commands.h"
#include "bench/shell/complete.h"
#include "cli/commands.h"

#include <string.h>

static int run(const struct rb_arguments *arguments);

const struct rb_command rb_command_man = {
    .name = "man",
    .summary = "print the manual page",
    .synopsis = "",
    .text = "The page is for man, in roff. `make install` puts it where man looks.\n\n"
            "  raybench man | man -l -",
    .groups = (const struct rb_option *const[]){NULL},
    .run = run,
};

// What roff would take for its own, or a typographer for another character.
static const struct rb_escape escapes[] = {
    {'\\', "\\(rs"}, {'-', "\\-"},   {'\'', "\\(aq"}, {'`', "\\(ga"},
    {'^', "\\(ha"},  {'~', "\\(ti"}, {'"', "\\(dq"},  {0, NULL},
};

// A line of text; roff would take a full stop at its beginning for a request.
static void put_line(FILE *out, const char *line, size_t length)
{
    if (length && line[0] == '.')
        fputs("\\&", out);
    rb_put_escaped_part(out, line, length, escapes);
    fputc('\n', out);
}

static void put_item(FILE *out, const char *name, const char *value, const char *text)
{
    fprintf(out, ".TP\n\\fB");
    rb_put_escaped(out, name, escapes);
    fprintf(out, "\\fR%s", value ? " \\fI" : "");
    if (value) {
        rb_put_escaped(out, value, escapes);
        fprintf(out, "\\fR");
    }
    fputc('\n', out);
    put_line(out, text, strlen(text));
}

// Walks over the lines of a command's text: *line is the next one, of *length bytes.
static bool next_line(const char **rest, const char **line, size_t *length)
{
    *line = *rest;
    *length = strcspn(*rest, "\n");
    *rest += *length + ((*rest)[*length] == '\n');
    return **line != '\0';
}

static bool is_example(const char *line)
{
    return strncmp(line, "  raybench ", 11) == 0;
}

// The paragraphs of a text without its examples. Other indented lines stay as they are: roff keeps
// them.
static void put_paragraphs(FILE *out, const char *text)
{
    const char *line;
    size_t length;
    bool paragraph = true;
    while (next_line(&text, &line, &length)) {
        if (length && !is_example(line)) {
            if (paragraph)
                fprintf(out, ".PP\n");
            put_line(out, line, length);
            paragraph = false;
        }
        paragraph |= length == 0;
    }
}

static void put_command(FILE *out, const struct rb_command *command)
{
    const struct rb_option *option;
    fprintf(out, ".SS raybench ");
    rb_put_escaped(out, command->name, escapes);
    fputc(' ', out);
    put_line(out, command->synopsis, strlen(command->synopsis));
    put_line(out, command->summary, strlen(command->summary));
    put_paragraphs(out, command->text);
    for (int i = 0; (option = rb_options_at(command, i)); i++)
        put_item(out, option->name, option->value, option->help);
}

// Returns whether the command has any.
static bool put_examples(FILE *out, const struct rb_command *command, bool begun)
{
    const char *rest = command->text, *line;
    size_t length;
    bool any = false;
    while (next_line(&rest, &line, &length)) {
        if (!is_example(line))
            continue;
        if (!any)
            fprintf(out, "%sTo %s:\n.PP\n.nf\n.RS 4\n", begun ? ".PP\n" : "", command->summary);
        any = true;
        put_line(out, line + 2, length - 2);
    }
    if (any)
        fprintf(out, ".RE\n.fi\n");
    return any;
}

static void put_scenes(FILE *out)
{
    char name[64], text[256];
    fprintf(out, ".SH SCENES\nWhat a SCENE may be, wherever one is wanted.\n");
    put_paragraphs(out, RB_HELP_SCENE);
    for (const struct rb_preset *preset = rb_presets; preset->name; preset++) {
        snprintf(text, sizeof text, "%s%d, %.0f objects; the 2019 report took %g s",
                 preset->generator, preset->size,
                 rb_generator_find(preset->generator)->object_count(preset->size), preset->paper_s);
        put_item(out, preset->name, NULL, text);
    }
    for (const struct rb_generator *generator = rb_generators; generator->name; generator++) {
        snprintf(name, sizeof name, "%sN", generator->name);
        snprintf(text, sizeof text, "%s, N from %d to %d", generator->summary, generator->size_min,
                 generator->size_max);
        put_item(out, name, NULL, text);
    }
}

static void put_variants(FILE *out)
{
    char text[256];
    fprintf(out, ".SH VARIANTS\nWays to render the same image, from the reference to the fastest.\n"
                 "\\(garaybench list variants\\(ga says which of them this machine has.\n");
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++) {
        snprintf(text, sizeof text, "%s%s%s", variant->summary, *variant->needs ? "; needs " : "",
                 variant->needs);
        put_item(out, variant->name, NULL, text);
    }
}

struct item {
    const char *name, *text;
};

static void put_section(FILE *out, const char *title, const struct item *items)
{
    fprintf(out, ".SH %s\n", title);
    for (; items->name; items++)
        put_item(out, items->name, NULL, items->text);
}

static const struct item exit_codes[] = {
    {"0", "Fine."},
    {"1", "The machine let us down: memory, disk, permissions."},
    {"2", "Bad usage or input; or a variant does not render what the reference does."},
    {"3",
     "raybench compare --gate found something slower than the threshold; raybench regress could "
     "not decide."},
    {"4",
     "raybench gate or regress: this machine is not fit for what is asked. Of these two, 1 means "
     "that something got worse, and 2 that there is no verdict for any reason."},
    {NULL, NULL},
};

static const struct item environment[] = {
    {"RAYBENCH_CPU_DISABLE",
     "Features of the processor to do without, separated by commas: sse2, avx2, avx512f, neon. "
     "Rows that need one of them become unavailable."},
    {"OMP_NUM_THREADS",
     "Threads of a +omp row where --threads does not say. OpenMP's other variables hold as well."},
    {"OMP_PROC_BIND, OMP_PLACES, GOMP_CPU_AFFINITY",
     "Where threads run. Without any of them the benchmark binds threads itself where the system "
     "allows."},
    {"RAYBENCH_SYSFS",
     "A folder with a copy of a machine's sys and proc, whose events are to be counted and whose "
     "energy is to be read (powercap alone), for tests."},
    {"TMPDIR", "Where raybench table keeps images while it measures; default /tmp."},
    {"NO_COLOR", "If set, nothing is printed in colour; into a file or a pipe nothing ever is."},
    {NULL, NULL},
};

static const struct item files[] = {
    {"results/latest",
     "The newest folder of results: kernels.csv (time per ray, by kernel and bounce), frame.csv, "
     "samples.csv, env.json, result.json. results/README.md of the sources explains them."},
    {"results/baseline/*.csv",
     "What raybench gate compares with, by plan; waivers.csv has what may grow, and until when."},
    {"results/floor.csv, results/history.ndjson",
     "The noise of this host, as raybench regress has learned it; the runs of raybench history."},
    {"report/table1.md, report/table1.csv", "The render times, as raybench table measured them."},
    {"bench/plans/*.plan, ../share/raybench/plans/*.plan",
     "Plans, in the sources and beside the installed program: what raybench bench measures by "
     "name."},
    {"bench/events/*.events, bench/energy/*.energy",
     "Which hardware events to count on which processor, and models of energy; installed beside "
     "the plans."},
    {NULL, NULL},
};

void rb_man_write(FILE *out, const struct rb_command *const *commands)
{
    const struct rb_command *const *command = rb_complete_shown(commands);
    bool begun = false;
    fprintf(out,
            ".\\\" Made by `raybench man`.\n"
            ".TH RAYBENCH 1 \"\" \"raybench " RB_VERSION "\" \"User Commands\"\n.nh\n"
            ".SH NAME\nraybench \\- measure a ray tracer: time per ray, per kernel, per bounce\n"
            ".SH SYNOPSIS\n.B raybench\n.I COMMAND\n.RI [ arguments ]\n.br\n"
            ".B raybench \\-\\-help\n.br\n.B raybench \\-\\-version\n"
            ".SH DESCRIPTION\n"
            "A ray tracer that tells where its time goes, for every variant of the tracer, on\n"
            "scenes that it generates or reads from NFF files. All variants render the same\n"
            "image to the last bit, or get no time.\n"
            ".SH COMMANDS\n");
    for (; *command; command = rb_complete_shown(command + 1))
        put_command(out, *command);
    put_scenes(out);
    put_variants(out);
    put_section(out, "EXIT STATUS", exit_codes);
    put_section(out, "ENVIRONMENT", environment);
    put_section(out, "FILES", files);
    fprintf(out, ".SH EXAMPLES\n");
    for (command = rb_complete_shown(commands); *command; command = rb_complete_shown(command + 1))
        begun |= put_examples(out, *command, begun);
    fprintf(out, ".SH SEE ALSO\n.BR perf (1),\n.BR hyperfine (1)\n");
}

static int run(const struct rb_arguments *arguments)
{
    (void)arguments;
    rb_man_write(stdout, rb_commands);
    return 0;
}
