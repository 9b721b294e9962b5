// Reads the dumps of callgrind, all in one text (--combine-dumps=yes), made by measure/simulate.h.
//
// Format: the Callgrind manual, "Callgrind Format Specification". Of each dump we take the
// trigger's label, the names of the columns and the totals; costs at the end of a line that are 0
// are left out by callgrind.
#ifndef RB_SIMULATE_CALLGRIND_H
#define RB_SIMULATE_CALLGRIND_H

#include "bench/simulate/simulated.h"

// Adds the laps in `text` to the places of `simulated`, and fills hash and row from the record's
// end. RB_FAILED where the text is not such a record or is cut short; error->line is then the line,
// and `simulated` is of no use. A pure function.
enum rb_status rb_callgrind_parse(const char *text, struct rb_simulated *simulated,
                                  struct rb_error *error);

#endif
