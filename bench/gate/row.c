#include "bench/gate/row.h"

#include "bench/compare/compare_print.h"

#include <stdio.h>
#include <string.h>

const char *const rb_moved_names[RB_MOVED_COUNT] = {
    [RB_MOVED_WORSE] = "worse",   [RB_MOVED_UNDECIDED] = "inconclusive",
    [RB_MOVED_BETTER] = "better", [RB_MOVED_WAIVED] = "waived",
    [RB_MOVED_NOT] = "same",
};

void rb_gate_row_place(const struct rb_gate_row *row, char text[RB_GATE_PLACE_MAX])
{
    char label[RB_CELL_LABEL_MAX], bounce[32] = "";
    rb_compare_label(&row->cell, 0, label);
    if (row->bounce >= 0)
        snprintf(bounce, sizeof bounce, " at bounce %d", row->bounce);
    snprintf(text, RB_GATE_PLACE_MAX, "%s, %s%s", label, row->kernel, bounce);
}

bool rb_gate_row_same_place(const struct rb_gate_row *a, const struct rb_gate_row *b)
{
    return a->bounce == b->bounce && strcmp(a->kernel, b->kernel) == 0 &&
           rb_cell_compare(&a->cell, &b->cell, 0) == 0;
}

// A scene is a path that may hold anything but a NUL.
static void quote(const char *text, char quoted[512])
{
    size_t used = 0;
    quoted[used++] = '\'';
    for (; *text && used < 500; text++) {
        if (*text == '\'')
            used += (size_t)snprintf(quoted + used, 5, "'\\'");
        quoted[used++] = *text;
    }
    snprintf(quoted + used, 2, "'");
}

static bool is_plain(const char *text)
{
    return text[0] != '-' && text[strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXY"
                                               "Z0123456789_-./")] == '\0';
}

// Options of record for what is not as it usually is.
static void put_options(const struct rb_timed_cell *cell, char text[160])
{
    static const struct {
        enum rb_key key;
        const char *option, *usual;
    } options[] = {
        {RB_KEY_DEPTH, "--depth", "5"},
        {RB_KEY_AA, "--aa", "1"},
        {RB_KEY_LIGHT_SAMPLES, "--light-samples", "1"},
        {RB_KEY_TILE, "--tile", "64"},
    };
    size_t used = (size_t)snprintf(text, 160, "--size %.8sx%.8s", cell->key[RB_KEY_WIDTH],
                                   cell->key[RB_KEY_HEIGHT]);
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (strcmp(cell->key[options[i].key], options[i].usual) != 0)
            used += (size_t)snprintf(text + used, 160 - used, " %s %.8s", options[i].option,
                                     cell->key[options[i].key]);
}

void rb_gate_row_command(const struct rb_gate_row *row, char text[RB_GATE_COMMAND_MAX])
{
    char scene[512], options[160], place[64] = "";
    const char *variant = row->cell.key[RB_KEY_VARIANT];
    if (is_plain(row->cell.key[RB_KEY_SCENE]))
        snprintf(scene, sizeof scene, "%s", row->cell.key[RB_KEY_SCENE]);
    else
        quote(row->cell.key[RB_KEY_SCENE], scene);
    put_options(&row->cell, options);
    if (strcmp(row->kernel, "frame") != 0)
        snprintf(place, sizeof place, " --kernel %.16s", row->kernel);
    if (row->bounce >= 0)
        snprintf(place + strlen(place), 32, " --bounce %d", row->bounce);
    // A kernel alone has no threads: the row is that without +omp.
    snprintf(text, RB_GATE_COMMAND_MAX,
             "raybench record %s %s -o gate.rays && raybench replay gate.rays --variant %.*s%s "
             "--mode %s",
             scene, options, (int)strcspn(variant, "+"), variant, place, row->mode);
}
