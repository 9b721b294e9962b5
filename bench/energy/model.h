// Energy modelled from simulated events by published energies of operations: data in
// bench/energy/NAME.energy. Good for shares and ratios, by no means for joules. Lines:
//
//     name    Horowitz 2014, 45 nm      what people call it
//     node    45 nm                     process of the circuits
//     source  M. Horowitz, ...          who published the energies
//     prose   words                     what is in it and what is not
//     value   pj = 70 * instructions    picojoules a ray, a formula as in files of events of the
//                                       values instructions, accesses (reads and writes of data),
//                                       l1_misses, ll_misses, branch_misses, each per ray
#ifndef RB_ENERGY_MODEL_H
#define RB_ENERGY_MODEL_H

#include "bench/hardware/formula.h"
#include "bench/simulate/simulated.h"

struct rb_energy_model {
    char stem[48];  // NAME of the file
    char label[64]; // "model:NAME"
    char title[128], node[32], source[256], prose[1024];
    struct rb_values values;
};

// A name of bench/energy, or a path that ends in .energy. RB_INVALID with line and column for a
// file that is none.
enum rb_status rb_energy_model_read(const char *asked, struct rb_energy_model *model,
                                    struct rb_error *error);

// Joules a ray of what was simulated; NaN where nothing was.
double rb_energy_model_joules(const struct rb_energy_model *model,
                              const struct rb_simulated_place *place);

// What the numbers are, in a line that says how little to believe them.
void rb_energy_model_describe(const struct rb_energy_model *model, char text[640]);

#endif
