// The columns of kernels.csv on events (event_columns.c) and energy (energy_columns.c).
#ifndef RB_RUN_EVENT_COLUMNS_H
#define RB_RUN_EVENT_COLUMNS_H

#include "bench/run/columns.h"

struct rb_value rb_column_cycles_per_ray(const struct rb_line *line);
struct rb_value rb_column_instructions_per_ray(const struct rb_line *line);
struct rb_value rb_column_l1d_misses_per_ray(const struct rb_line *line);
struct rb_value rb_column_llc_misses_per_ray(const struct rb_line *line);
struct rb_value rb_column_branch_misses_per_ray(const struct rb_line *line);
struct rb_value rb_column_compute_pct(const struct rb_line *line);
struct rb_value rb_column_compute_stall_pct(const struct rb_line *line);
struct rb_value rb_column_memory_stall_pct(const struct rb_line *line);
struct rb_value rb_column_other_pct(const struct rb_line *line);
struct rb_value rb_column_counter_source(const struct rb_line *line);
struct rb_value rb_column_nj_per_ray(const struct rb_line *line);
struct rb_value rb_column_energy_source(const struct rb_line *line);
struct rb_value rb_column_model_cycles_per_ray(const struct rb_line *line);
struct rb_value rb_column_category_source(const struct rb_line *line);
struct rb_value rb_column_simulated_rays(const struct rb_line *line);
struct rb_value rb_column_simulated_by(const struct rb_line *line);
struct rb_value rb_column_category_sum_pct(const struct rb_line *line);
struct rb_value rb_column_task_clock_ns_per_ray(const struct rb_line *line);
struct rb_value rb_column_page_faults_per_ray(const struct rb_line *line);
struct rb_value rb_column_kernel_switches_per_ray(const struct rb_line *line);
struct rb_value rb_column_counter_overhead_pct(const struct rb_line *line);
struct rb_value rb_column_counted_by(const struct rb_line *line);
struct rb_value rb_column_hardware_note(const struct rb_line *line);
struct rb_value rb_column_gross_nj_per_ray(const struct rb_line *line);
struct rb_value rb_column_energy_note(const struct rb_line *line);

// And of frame.csv.
struct rb_value rb_column_frame_j(const struct rb_line *line);
struct rb_value rb_column_gross_frame_j(const struct rb_line *line);
struct rb_value rb_column_edp_js(const struct rb_line *line);
struct rb_value rb_column_frame_energy_source(const struct rb_line *line);
struct rb_value rb_column_frame_energy_note(const struct rb_line *line);

#endif
