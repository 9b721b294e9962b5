#define _POSIX_C_SOURCE 200809L
#include "bench/energy/model.h"

#include "bench/hardware/sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char *const inputs[] = {"instructions", "accesses", "l1_misses", "ll_misses",
                                     "branch_misses"};
enum { INPUT_COUNT = sizeof inputs / sizeof *inputs };

static enum rb_status take_name(void *user, char *text, struct rb_error *error)
{
    struct rb_energy_model *model = user;
    return rb_sheet_text(model->title, sizeof model->title, text, error);
}

static enum rb_status take_node(void *user, char *text, struct rb_error *error)
{
    struct rb_energy_model *model = user;
    return rb_sheet_text(model->node, sizeof model->node, text, error);
}

static enum rb_status take_source(void *user, char *text, struct rb_error *error)
{
    struct rb_energy_model *model = user;
    return rb_sheet_append(model->source, sizeof model->source, text, error);
}

static enum rb_status take_prose(void *user, char *text, struct rb_error *error)
{
    struct rb_energy_model *model = user;
    return rb_sheet_append(model->prose, sizeof model->prose, text, error);
}

static enum rb_status take_value(void *user, char *text, struct rb_error *error)
{
    struct rb_energy_model *model = user;
    return rb_sheet_value(&model->values, text, error);
}

static enum rb_status read_file(const char *path, struct rb_energy_model *model,
                                struct rb_error *error)
{
    static const struct rb_sheet_key keys[] = {
        {"name", take_name},   {"node", take_node},   {"source", take_source},
        {"prose", take_prose}, {"value", take_value}, {NULL, NULL},
    };
    *model = (struct rb_energy_model){.stem = ""};
    rb_sheet_stem(path, model->stem);
    snprintf(model->label, sizeof model->label, "model:%s", model->stem);
    for (int i = 0; i < INPUT_COUNT; i++)
        rb_values_add(&model->values, inputs[i], NULL);
    enum rb_status status = rb_sheet_read(path, keys, model, error);
    if (status == RB_OK && (!model->title[0] || !model->node[0] || !model->source[0] ||
                            rb_values_find(&model->values, "pj") < INPUT_COUNT))
        status = rb_error_set(error, RB_INVALID,
                              "a model of energy needs name, node, source and a value pj");
    if (status)
        snprintf(error->file, sizeof error->file, "%.255s", path);
    return status;
}

enum rb_status rb_energy_model_read(const char *asked, struct rb_energy_model *model,
                                    struct rb_error *error)
{
    char path[1200];
    const char *folder;
    size_t length = strlen(asked);
    if (length > 7 && strcmp(asked + length - 7, ".energy") == 0)
        return read_file(asked, model, error);
    for (int i = 0; (folder = rb_sheet_folder("bench/energy", "energy", i)); i++) {
        snprintf(path, sizeof path, "%s/%.64s.energy", folder, asked);
        if (access(path, R_OK) == 0)
            return read_file(path, model, error);
    }
    return rb_error_set(error, RB_INVALID,
                        "--energy-model %.64s: no such file in bench/energy; there are "
                        "horowitz14-45nm and jouppi21-7nm",
                        asked);
}

double rb_energy_model_joules(const struct rb_energy_model *model,
                              const struct rb_simulated_place *place)
{
    struct rb_simulated_figures figures = rb_simulated_figures(place);
    double reads = (double)place->events[RB_SIM_DR], writes = (double)place->events[RB_SIM_DW];
    double numbers[RB_VALUES_MAX] = {
        figures.instructions,  place->rays ? (reads + writes) / (double)place->rays : (double)NAN,
        figures.l1_misses,     figures.ll_misses,
        figures.branch_misses,
    };
    rb_values_compute(&model->values, numbers);
    return 1e-12 * numbers[rb_values_find(&model->values, "pj")];
}

void rb_energy_model_describe(const struct rb_energy_model *model, char text[640])
{
    snprintf(text, 640,
             "%s: modelled from simulated events, %s (%s). +-3 x as joules; for shares and ratios "
             "only",
             model->label, model->title, model->source);
}
