#include "bench/commands.h"

#include "bench/bench.h"
#include "bench/completions.h"
#include "bench/man.h"
#include "bench/worker.h"
#include "cli/commands.h"

#include <stddef.h>

// A command a line, whatever fits.
// clang-format off
const struct rb_command *const rb_commands[] = {
    &rb_command_render,
    &rb_command_pixel,
    &rb_command_info,
    &rb_command_scene,
    &rb_command_list,
    &rb_command_bench,
    &rb_command_worker,
    &rb_command_completions,
    &rb_command_man,
    NULL,
};
