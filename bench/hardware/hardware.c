#include "bench/hardware/hardware.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void rb_hardware_make_groups(const struct rb_event_file *file, const char *root,
                             struct rb_hardware_groups *groups, struct rb_hardware *hardware)
{
    memset(groups, 0, sizeof *groups);
    groups->count = file->group_count;
    for (int g = 0; g < groups->count; g++)
        groups->group[g].by_read = file->by_read[g];
    for (int i = 0; i < file->event_count; i++) {
        int g = file->events[i].group;
        struct rb_event_group *group = &groups->group[g];
        struct rb_error ignored = {0};
        hardware->state[i] = RB_EVENT_ABSENT;
        if (rb_event_encode(root, file, i, &group->of[group->count], &ignored) == RB_OK)
            groups->of[g][group->count++] = i;
    }
}

void rb_hardware_book(struct rb_hardware *hardware, const struct rb_hardware_groups *groups,
                      int group, const struct rb_event_table *table,
                      const struct rb_recorder *recorder, double ns_per_tick)
{
    for (int stage = 0; stage < RB_KERNEL_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            const struct rb_tally *tally = &recorder->tally[stage][bounce];
            struct rb_hardware_place *place = &hardware->place[stage][bounce];
            place->rays[group] += tally->rays;
            place->laps[group] += table->laps[stage][bounce];
            place->ns[group] += (uint64_t)((double)tally->ticks * ns_per_tick);
            for (int i = 0; i < groups->group[group].count; i++)
                place->count[groups->of[group][i]] += table->count[stage][bounce][i];
        }
    double lap_ns = (double)table->cost_ticks * ns_per_tick;
    hardware->lap_ns[group] = fmax(hardware->lap_ns[group], lap_ns);
    for (int i = 0; i < groups->group[group].count; i++) {
        int event = groups->of[group][i];
        enum rb_event_state *state = &hardware->state[event];
        bool first = *state == RB_EVENT_ABSENT || *state == RB_EVENT_UNTRIED;
        *state = first || table->state[i] > *state ? table->state[i] : *state;
        if (first || table->empty[i] < hardware->empty[event])
            hardware->empty[event] = table->empty[i];
    }
    hardware->in_user_space =
        table->in_user_space && (hardware->repetitions == 0 || hardware->in_user_space);
    hardware->repetitions++;
}

static struct rb_hardware_place place_of(const struct rb_hardware *hardware, enum rb_stage stage,
                                         int bounce)
{
    struct rb_hardware_place sum = {{0}, {0}, {0}, {0}};
    for (int b = 0; b < RB_BOUNCE_MAX; b++) {
        const struct rb_hardware_place *place = &hardware->place[stage][b];
        if (bounce >= 0 && b != bounce)
            continue;
        for (int g = 0; g < RB_HARDWARE_GROUPS; g++) {
            sum.rays[g] += place->rays[g];
            sum.laps[g] += place->laps[g];
            sum.ns[g] += place->ns[g];
        }
        for (int i = 0; i < RB_HARDWARE_EVENTS; i++)
            sum.count[i] += place->count[i];
    }
    return sum;
}

// The most of all groups.
static double overhead_pct(const struct rb_hardware *hardware,
                           const struct rb_hardware_place *place)
{
    double most = 0;
    for (int g = 0; g < hardware->file->group_count; g++)
        if (place->ns[g])
            most = fmax(most,
                        100 * hardware->lap_ns[g] * (double)place->laps[g] / (double)place->ns[g]);
    return most;
}

void rb_hardware_categorise(const struct rb_values *values, struct rb_hardware_figures *figures)
{
    static const char *const names[] = {"compute", "compute_stall", "memory_stall", "other"};
    double *const shares[] = {&figures->compute_pct, &figures->compute_stall_pct,
                              &figures->memory_stall_pct, &figures->other_pct};
    double sum = 0, raw = 0, total = (double)NAN;
    int at = rb_values_find(values, "total");
    if (at >= 0)
        total = figures->numbers[at];
    for (int i = 0; i < 4; i++) {
        int value = rb_values_find(values, names[i]);
        double number = value < 0 ? (double)NAN : figures->numbers[value];
        *shares[i] = number < 0 ? 0 : number;
        sum += *shares[i];
        raw += number;
    }
    bool known = sum > 0 && total > 0; // neither is NaN
    for (int i = 0; i < 4; i++)
        *shares[i] = known ? 100 * *shares[i] / sum : (double)NAN;
    figures->sum_pct = known ? 100 * raw / total : (double)NAN;
}

struct rb_hardware_figures rb_hardware_figures(const struct rb_hardware *hardware,
                                               enum rb_stage stage, int bounce)
{
    const struct rb_event_file *file = hardware->file;
    struct rb_hardware_place place = place_of(hardware, stage, bounce);
    struct rb_hardware_figures figures = {.overhead_pct = overhead_pct(hardware, &place)};
    for (int i = 0; i < RB_VALUES_MAX; i++)
        figures.numbers[i] = (double)NAN;
    for (int i = 0; i < file->event_count; i++) {
        int group = file->events[i].group;
        double own = (double)place.laps[group] * (double)hardware->empty[i];
        if (hardware->state[i] == RB_EVENT_COUNTED && place.rays[group] &&
            figures.overhead_pct <= RB_HARDWARE_OVERHEAD_MOST)
            figures.numbers[i] = fmax(0, (double)place.count[i] - own) / (double)place.rays[group];
    }
    rb_values_compute(&file->values, figures.numbers);
    rb_hardware_categorise(&file->values, &figures);
    return figures;
}

double rb_hardware_value(const struct rb_hardware *hardware,
                         const struct rb_hardware_figures *figures, const char *name)
{
    int value = rb_values_find(&hardware->file->values, name);
    return value < 0 ? (double)NAN : figures->numbers[value];
}

void rb_hardware_reason(const struct rb_hardware *hardware, enum rb_stage stage, int bounce,
                        char text[RB_HARDWARE_TEXT])
{
    const struct rb_event_file *file = hardware->file;
    struct rb_hardware_place place = place_of(hardware, stage, bounce);
    double overhead = overhead_pct(hardware, &place);
    int used = 0;
    text[0] = '\0';
    if (overhead > RB_HARDWARE_OVERHEAD_MOST) {
        snprintf(
            text, RB_HARDWARE_TEXT,
            "overhead: reading the counters takes %.3g %% of so short a stage; raybench replay "
            "--mode hardware reads them less often",
            overhead);
        return;
    }
    // The first event of each kind of trouble names it; the others only themselves.
    for (int state = RB_EVENT_MULTIPLEXED; state < RB_EVENT_STATE_COUNT; state++) {
        const char *separator = used ? "; " : "";
        bool any = false;
        for (int i = 0; i < file->event_count && used < RB_HARDWARE_TEXT; i++)
            if ((int)hardware->state[i] == state) {
                used += snprintf(text + used, (size_t)(RB_HARDWARE_TEXT - used), "%s%s",
                                 any ? ", " : separator, file->values.names[i]);
                any = true;
            }
        if (any && used < RB_HARDWARE_TEXT)
            used += snprintf(text + used, (size_t)(RB_HARDWARE_TEXT - used), " %s",
                             rb_event_state_text((enum rb_event_state)state));
    }
}

void rb_hardware_describe(const struct rb_hardware *hardware, char text[RB_HARDWARE_TEXT])
{
    const struct rb_event_file *file = hardware->file;
    double most = 0;
    for (int g = 0; g < file->group_count; g++)
        most = fmax(most, hardware->lap_ns[g]);
    snprintf(text, RB_HARDWARE_TEXT,
             "%s (%s%s); %d group%s of events in turn, %u repetitions; read by %s, %.0f ns a lap",
             file->title, file->stem, file->verified ? "" : ", unverified", file->group_count,
             file->group_count == 1 ? "" : "s", (unsigned)hardware->repetitions,
             hardware->in_user_space ? "rdpmc" : "read(2)", most);
}

void rb_hardware_category_source(const struct rb_hardware *hardware, char text[96])
{
    const struct rb_event_file *file = hardware->file;
    text[0] = '\0';
    if (rb_event_file_has_categories(file))
        snprintf(text, 96, "%s:%s%s", rb_event_file_source(file), file->stem,
                 file->verified ? "" : " (unverified)");
}
