// `raybench replay --mode hardware`.
#include "bench/explain/hardware_table.h"
#include "bench/replay/replay_evidence.h"
#include "cli/commands.h"

#include <stdio.h>
#include <string.h>

// What a worker that counts events sends.
struct record {
    struct rb_sample sample;
    struct rb_hardware hardware;
};

static bool keep(void *user, const struct rb_sample *sample)
{
    memcpy(user, sample, sizeof(struct record));
    return true;
}

static enum rb_status count_unit(const struct rb_replay_run *run, const struct rb_replay_unit *unit,
                                 const struct rb_arguments *arguments, const char *events,
                                 struct record *record, struct rb_error *error)
{
    struct rb_worker_words words = {.count = 0};
    rb_replay_unit_words(run, unit, &words);
    rb_worker_word(&words, "--events=%s", events);
    rb_worker_word(&words, "--slice=%g", arguments->budget_s > 0 ? arguments->budget_s : 1);
    rb_worker_word(&words, "--cpu=-1");
    rb_worker_word(&words, "--");
    rb_worker_word(&words, "%s", run->path);
    return rb_process_run(&words, false, sizeof *record, keep, record, error);
}

// Every class of rays has a table of its own: its units follow each other.
static void print_class(const struct rb_replay_run *run, enum rb_ray_class ray_class,
                        struct rb_hardware *hardware)
{
    printf("\nrays of class %s, %s\n", rb_ray_class_names[ray_class], run->in_place.variant->name);
    rb_hardware_table_print(hardware);
}

int rb_replay_hardware(struct rb_replay_run *run, const struct rb_arguments *arguments)
{
    static struct record record; // too large for the stack, as the next ones
    static struct rb_event_file file;
    static struct rb_hardware all;
    struct rb_error error = {0};
    const char *asked = arguments->bench.events;
    enum rb_status status = rb_event_file_choose(rb_hardware_root(), asked, &file, &error);
    rb_process_catch_signals();
    for (int i = 0; i < run->unit_count && status == RB_OK && !rb_process_interrupted(); i++) {
        const struct rb_record_choice *choice = &run->units[i].choice;
        status =
            count_unit(run, &run->units[i], arguments, asked ? asked : file.stem, &record, &error);
        if (status || rb_process_interrupted())
            break;
        struct rb_hardware_place place = record.hardware.place[choice->kernel][choice->bounce];
        memcpy(record.hardware.place, all.place, sizeof all.place);
        all = record.hardware;
        all.place[choice->kernel][choice->bounce] = place;
        all.file = &file;
        if (i + 1 == run->unit_count || run->units[i + 1].choice.ray_class != choice->ray_class) {
            print_class(run, choice->ray_class, &all);
            memset(&all, 0, sizeof all);
        }
    }
    fflush(stdout);
    if (rb_process_interrupted())
        rb_process_raise_again();
    return error.text[0] ? rb_report(status, &error) : (int)status;
}
