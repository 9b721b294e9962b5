#include "bench/commands.h"

#include "bench/bench.h"
#include "bench/export.h"
#include "cli/commands.h"

#include <stddef.h>

const struct rb_command *const rb_commands[] = {
    &rb_command_render, &rb_command_pixel, &rb_command_info,   &rb_command_scene,
    &rb_command_list,   &rb_command_bench, &rb_command_export, NULL,
};
