#include "bench/run/event_columns.h"

#include <math.h>

// What is known of the events of a kernel at a bounce. Figures of one place have one source: where
// hardware has counted any of them, what it has not counted is not known.
struct known {
    bool counted, categorised; // by hardware
    bool simulated;
    struct rb_hardware_figures hardware;
    struct rb_simulated_figures simulation;
};

static double hardware_value(const struct rb_line *line, const struct known *known,
                             const char *name)
{
    return rb_hardware_value(line->cell->hardware, &known->hardware, name);
}

static struct known find(const struct rb_line *line)
{
    struct known known = {.counted = false};
    const struct rb_cell *cell = line->cell;
    if (!line->counts || line->stage >= RB_KERNEL_COUNT)
        return known;
    if (cell->hardware) {
        known.hardware = rb_hardware_figures(cell->hardware, line->stage, line->bounce);
        for (int i = 0; i < cell->hardware->file->event_count; i++)
            known.counted |= isfinite(known.hardware.numbers[i]);
        known.categorised = isfinite(known.hardware.compute_pct);
    }
    if (cell->simulated) {
        known.simulation = rb_simulated_figures(&cell->simulated->place[line->stage][line->bounce]);
        known.simulated = !isnan(known.simulation.cycles);
    }
    return known;
}

// By hardware, unless what it counts are no events of a processor.
static bool has_counters(const struct rb_line *line, const struct known *known)
{
    return known->counted && (isfinite(hardware_value(line, known, "cycles")) ||
                              isfinite(hardware_value(line, known, "instructions")));
}

#define EVENT(column, value, field)                                                                \
    struct rb_value rb_column_##column(const struct rb_line *line)                                 \
    {                                                                                              \
        struct known known = find(line);                                                           \
        if (has_counters(line, &known))                                                            \
            return rb_number(hardware_value(line, &known, value));                                 \
        return known.simulated ? rb_number(known.simulation.field) : rb_none();                    \
    }
EVENT(instructions_per_ray, "instructions", instructions)
EVENT(l1d_misses_per_ray, "l1d_misses", l1_misses)
EVENT(llc_misses_per_ray, "llc_misses", ll_misses)
EVENT(branch_misses_per_ray, "branch_misses", branch_misses)

#define HARDWARE(column, value)                                                                    \
    struct rb_value rb_column_##column(const struct rb_line *line)                                 \
    {                                                                                              \
        struct known known = find(line);                                                           \
        return known.counted ? rb_number(hardware_value(line, &known, value)) : rb_none();         \
    }
HARDWARE(cycles_per_ray, "cycles")
HARDWARE(task_clock_ns_per_ray, "task_clock")
HARDWARE(page_faults_per_ray, "page_faults")
HARDWARE(kernel_switches_per_ray, "context_switches")

#define CATEGORY(column, modelled)                                                                 \
    struct rb_value rb_column_##column(const struct rb_line *line)                                 \
    {                                                                                              \
        struct known known = find(line);                                                           \
        if (known.categorised)                                                                     \
            return rb_number(known.hardware.column);                                               \
        return known.simulated ? rb_number(modelled) : rb_none();                                  \
    }
CATEGORY(compute_pct, known.simulation.compute_pct)
CATEGORY(compute_stall_pct, (double)NAN) // which no simulator of this kind sees
CATEGORY(memory_stall_pct, known.simulation.memory_stall_pct)
CATEGORY(other_pct, known.simulation.other_pct)

struct rb_value rb_column_category_sum_pct(const struct rb_line *line)
{
    struct known known = find(line);
    return known.categorised ? rb_number(known.hardware.sum_pct) : rb_none();
}

struct rb_value rb_column_model_cycles_per_ray(const struct rb_line *line)
{
    struct known known = find(line);
    return known.simulated ? rb_number(known.simulation.cycles) : rb_none();
}

struct rb_value rb_column_counter_source(const struct rb_line *line)
{
    struct known known = find(line);
    if (has_counters(line, &known))
        return rb_text(rb_event_file_source(line->cell->hardware->file));
    return rb_text(known.simulated ? RB_SIM_SOURCE : NULL);
}

// The texts live until the next call.
struct rb_value rb_column_category_source(const struct rb_line *line)
{
    static char text[96];
    struct known known = find(line);
    if (!known.categorised)
        return rb_text(known.simulated ? RB_SIM_MODEL : NULL);
    rb_hardware_category_source(line->cell->hardware, text);
    return rb_text(text);
}

struct rb_value rb_column_simulated_rays(const struct rb_line *line)
{
    struct known known = find(line);
    return known.simulated
               ? rb_integer((int64_t)line->cell->simulated->place[line->stage][line->bounce].rays)
               : rb_none();
}

struct rb_value rb_column_simulated_by(const struct rb_line *line)
{
    static char text[RB_SIMULATED_TEXT];
    struct known known = find(line);
    if (!known.simulated)
        return rb_none();
    rb_simulated_describe(line->cell->simulated, text);
    return rb_text(text);
}

struct rb_value rb_column_counter_overhead_pct(const struct rb_line *line)
{
    struct known known = find(line);
    return line->cell->hardware && line->counts ? rb_number(known.hardware.overhead_pct)
                                                : rb_none();
}

struct rb_value rb_column_counted_by(const struct rb_line *line)
{
    static char text[RB_HARDWARE_TEXT];
    struct known known = find(line);
    if (!known.counted)
        return rb_none();
    rb_hardware_describe(line->cell->hardware, text);
    return rb_text(text);
}

struct rb_value rb_column_hardware_note(const struct rb_line *line)
{
    static char text[RB_HARDWARE_TEXT];
    if (!line->cell->hardware || !line->counts || line->stage >= RB_KERNEL_COUNT)
        return rb_none();
    rb_hardware_reason(line->cell->hardware, line->stage, line->bounce, text);
    return rb_text(text);
}
