// Recording the rays of a frame as a sub-command.
#ifndef RB_REPLAY_RECORD_H
#define RB_REPLAY_RECORD_H

#include "bench/replay/record_file.h"
#include "cli/options.h"

extern const struct rb_command rb_command_record;

// What is in a record, a line for each class, kernel and bounce, on standard output.
void rb_record_print(const struct rb_record_header *header,
                     const struct rb_record_contents *contents);

#endif
