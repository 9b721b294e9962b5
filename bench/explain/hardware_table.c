#include "bench/explain/hardware_table.h"

#include "bench/explain/wrap.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 9, NOTES_MAX = 8 };

// Different reasons, each told once below the table.
struct notes {
    char text[NOTES_MAX][RB_HARDWARE_TEXT];
    int count;
};

static bool is_category(const char *name)
{
    static const char *const names[] = {"compute", "compute_stall", "memory_stall", "other",
                                        "total"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

static int width_of(const char *name)
{
    int length = (int)strlen(name);
    return length > WIDTH ? length : WIDTH;
}

static void print_number(double value, int width)
{
    if (isfinite(value))
        printf(" %*.4g", width, value);
    else
        printf(" %*s", width, "-");
}

// The number of the reason, from 1; 0 for none, or where there is no room for another one.
static int note(struct notes *notes, const char *text)
{
    int i = 0;
    while (i < notes->count && strcmp(notes->text[i], text) != 0)
        i++;
    if (!text[0] || i == NOTES_MAX)
        return 0;
    if (i == notes->count)
        snprintf(notes->text[notes->count++], RB_HARDWARE_TEXT, "%s", text);
    return i + 1;
}

static void print_place(const struct rb_hardware *hardware, enum rb_stage stage, int bounce,
                        struct notes *notes)
{
    const struct rb_values *values = &hardware->file->values;
    struct rb_hardware_figures figures = rb_hardware_figures(hardware, stage, bounce);
    char reason[RB_HARDWARE_TEXT];
    printf("  %-12s %6d", rb_stage_names[stage], bounce);
    for (int i = 0; i < values->count; i++)
        if (!is_category(values->names[i]))
            print_number(figures.numbers[i], width_of(values->names[i]));
    if (rb_event_file_has_categories(hardware->file)) {
        print_number(figures.compute_pct, WIDTH);
        print_number(figures.compute_stall_pct, WIDTH);
        print_number(figures.memory_stall_pct, WIDTH);
        print_number(figures.other_pct, WIDTH);
        print_number(figures.sum_pct, WIDTH);
    }
    rb_hardware_reason(hardware, stage, bounce, reason);
    int number = note(notes, reason);
    if (number)
        printf("  [%d]", number);
    printf("\n");
}

void rb_hardware_table_print(const struct rb_hardware *hardware)
{
    static struct notes notes; // too large for the stack
    const struct rb_values *values = &hardware->file->values;
    char text[RB_HARDWARE_TEXT], line[RB_HARDWARE_TEXT + 16];
    notes.count = 0;
    printf("  %-12s %6s", "kernel", "bounce");
    for (int i = 0; i < values->count; i++)
        if (!is_category(values->names[i]))
            printf(" %*s", width_of(values->names[i]), values->names[i]);
    if (rb_event_file_has_categories(hardware->file))
        printf(" %9s %9s %9s %9s %9s", "compute %", "c.stall %", "m.stall %", "other %",
               "of total");
    printf("\n");
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++)
            if (hardware->place[stage][bounce].rays[0])
                print_place(hardware, (enum rb_stage)stage, bounce, &notes);
    for (int i = 0; i < notes.count; i++) {
        snprintf(line, sizeof line, "[%d] %s", i + 1, notes.text[i]);
        rb_wrap_print(2, line);
    }
    rb_hardware_describe(hardware, text);
    snprintf(line, sizeof line, "Per ray. %s.", text);
    rb_wrap_print(2, line);
    rb_wrap_print(2, hardware->file->prose);
}
