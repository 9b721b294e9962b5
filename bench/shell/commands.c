#include "bench/shell/commands.h"

#include "bench/compare/compare.h"
#include "bench/explain/count.h"
#include "bench/explain/explain.h"
#include "bench/explain/simulate_command.h"
#include "bench/export/export.h"
#include "bench/gate/gate.h"
#include "bench/gate/regress.h"
#include "bench/history/history.h"
#include "bench/machine/doctor.h"
#include "bench/machine/peaks.h"
#include "bench/replay/record.h"
#include "bench/replay/replay.h"
#include "bench/replay/replay_worker.h"
#include "bench/run/bench.h"
#include "bench/run/worker.h"
#include "bench/shell/completions.h"
#include "bench/shell/man.h"
#include "bench/times/render_command.h"
#include "bench/versus/versus.h"
#include "cli/commands.h"

#include <stddef.h>

// A command a line, as --help lists them, whatever fits.
// clang-format off
const struct rb_command *const rb_commands[] = {
    &rb_command_render,
    &rb_command_pixel,
    &rb_command_info,
    &rb_command_scene,
    &rb_command_list,
    &rb_command_bench,
    &rb_command_simulate,
    &rb_command_count,
    &rb_command_explain,
    &rb_command_compare,
    &rb_command_gate,
    &rb_command_regress,
    &rb_command_history,
    &rb_command_export,
    &rb_command_table,
    &rb_command_record,
    &rb_command_replay,
    &rb_command_versus,
    &rb_command_doctor,
    &rb_command_peaks,
    &rb_command_completions,
    &rb_command_man,
    &rb_command_worker,
    &rb_command_replay_worker,
    NULL,
};
