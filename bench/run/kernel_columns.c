// The columns of kernels.csv. Columns are only ever appended.
#include "bench/run/event_columns.h"

#include <math.h>

static struct rb_value kernel(const struct rb_line *line)
{
    return rb_text(line->kernel);
}

static struct rb_value bounce(const struct rb_line *line)
{
    return line->bounce >= 0 ? rb_integer(line->bounce) : rb_none();
}

static struct rb_value rays(const struct rb_line *line)
{
    return line->counts ? rb_integer((int64_t)line->counts->rays) : rb_none();
}

static struct rb_value calls(const struct rb_line *line)
{
    return line->counts && !line->cell->group_tiles ? rb_integer((int64_t)line->counts->calls)
                                                    : rb_none();
}

// Rays that enter a bounce by reflection or refraction: rows of the kernel trace.
static struct rb_value reflection_rays(const struct rb_line *line)
{
    bool told = line->counts && line->stage == RB_STAGE_TRACE;
    return told ? rb_integer((int64_t)line->cell->reference->frame.reflected[line->bounce])
                : rb_none();
}

static struct rb_value refraction_rays(const struct rb_line *line)
{
    bool told = line->counts && line->stage == RB_STAGE_TRACE;
    return told ? rb_integer((int64_t)line->cell->reference->frame.refracted[line->bounce])
                : rb_none();
}

static struct rb_value ns_per_ray(const struct rb_line *line)
{
    return rb_number(line->per_ray.value);
}

static struct rb_value ns_per_ray_lo(const struct rb_line *line)
{
    return rb_number(line->per_ray.low);
}

static struct rb_value ns_per_ray_hi(const struct rb_line *line)
{
    return rb_number(line->per_ray.high);
}

static struct rb_value ns_per_ray_min(const struct rb_line *line)
{
    return rb_number(line->per_ray.min);
}

static struct rb_value ns_per_ray_p10(const struct rb_line *line)
{
    return rb_number(line->per_ray.p10);
}

static struct rb_value ci_level(const struct rb_line *line)
{
    return rb_number(line->per_ray.level);
}

static struct rb_value mdape_pct(const struct rb_line *line)
{
    return rb_number(line->per_ray.mdape_pct);
}

static struct rb_value wall_ns_per_ray(const struct rb_line *line)
{
    return line->counts ? rb_number(line->wall_ns / (double)line->counts->rays) : rb_none();
}

static struct rb_value mrays_per_s(const struct rb_line *line)
{
    return line->counts ? rb_number(1e3 * (double)line->counts->rays / line->wall_ns) : rb_none();
}

static struct rb_value ns_per_pixel(const struct rb_line *line)
{
    const struct rb_settings *s = &line->cell->settings;
    return rb_number(line->ns / ((double)s->width * s->height));
}

static struct rb_value n(const struct rb_line *line)
{
    return rb_integer(line->cell->process_count);
}

static struct rb_value share_pct(const struct rb_line *line)
{
    return rb_number(100.0 * line->share);
}

// What happened to the cell's processes while they measured, all repetitions together.
static struct rb_value sum(const struct rb_cell *cell, double of(const struct rb_sample *))
{
    double total = 0;
    for (size_t i = 0; i < cell->sample_count; i++)
        total += of(&cell->samples[i]);
    return cell->sample_count ? rb_number(total) : rb_none();
}

static double switches_of(const struct rb_sample *sample)
{
    return (double)sample->context_switches;
}

static double migrations_of(const struct rb_sample *sample)
{
    return sample->migrations < 0 ? (double)NAN : (double)sample->migrations;
}

static double steal_of(const struct rb_sample *sample)
{
    return sample->steal_ms;
}

static struct rb_value context_switches(const struct rb_line *line)
{
    return sum(line->cell, switches_of);
}

static struct rb_value migrations(const struct rb_line *line)
{
    return sum(line->cell, migrations_of);
}

static struct rb_value steal_ms(const struct rb_line *line)
{
    return sum(line->cell, steal_of);
}

// What a kernel did at a bounce, and for how many rays; nothing where it was not counted.
static const struct rb_counts *counted(const struct rb_line *line, double *per_ray)
{
    if (!line->cell->counted || !line->counts)
        return NULL;
    uint64_t entries = line->cell->counted->sample.stage[line->stage][line->bounce].rays;
    *per_ray = entries ? 1.0 / (double)entries : (double)NAN;
    return entries ? &line->cell->counted->table.at[line->stage][line->bounce] : NULL;
}

#define COUNTED(column, counter)                                                                   \
    static struct rb_value column(const struct rb_line *line)                                      \
    {                                                                                              \
        double per_ray;                                                                            \
        const struct rb_counts *counts = counted(line, &per_ray);                                  \
        return counts ? rb_number((double)counts->of[counter] * per_ray) : rb_none();              \
    }
COUNTED(nodes_per_ray, RB_COUNT_NODES)
COUNTED(boxes_per_ray, RB_COUNT_BOXES)
COUNTED(spheres_per_ray, RB_COUNT_SPHERES)
COUNTED(triangles_per_ray, RB_COUNT_TRIANGLES)
COUNTED(cones_per_ray, RB_COUNT_CONES)
COUNTED(planes_per_ray, RB_COUNT_PLANES)
COUNTED(hits_per_ray, RB_COUNT_HITS)
COUNTED(occluded_per_ray, RB_COUNT_OCCLUDED)
COUNTED(steps_per_ray, RB_COUNT_STEPS)
COUNTED(lanes_active_per_ray, RB_COUNT_LANES_ACTIVE)
COUNTED(lanes_possible_per_ray, RB_COUNT_LANES_POSSIBLE)
COUNTED(tree_bytes_per_ray, RB_COUNT_TREE_BYTES)
COUNTED(primitive_bytes_per_ray, RB_COUNT_PRIMITIVE_BYTES)
COUNTED(stack_per_ray, RB_COUNT_STACK)
COUNTED(shadings_per_ray, RB_COUNT_SHADINGS)

static struct rb_value stack_max(const struct rb_line *line)
{
    double per_ray;
    const struct rb_counts *counts = counted(line, &per_ray);
    return counts ? rb_integer((int64_t)counts->stack_max) : rb_none();
}

static struct rb_value lane_use_pct(const struct rb_line *line)
{
    double per_ray;
    const struct rb_counts *counts = counted(line, &per_ray);
    return counts ? rb_number(rb_counts_lane_use_pct(counts)) : rb_none();
}

static struct rb_value counted_rays(const struct rb_line *line)
{
    double per_ray;
    return counted(line, &per_ray)
               ? rb_integer(
                     (int64_t)line->cell->counted->sample.stage[line->stage][line->bounce].rays)
               : rb_none();
}

const struct rb_column rb_kernel_columns[] = {
    RB_KEY_COLUMNS,
    {"kernel", kernel},
    {"bounce", bounce},
    {"rays", rays},
    {"ns_per_ray", ns_per_ray},
    {"ns_per_ray_lo", ns_per_ray_lo},
    {"ns_per_ray_hi", ns_per_ray_hi},
    {"ns_per_pixel", ns_per_pixel},
    {"n", n},
    {"note", rb_cell_note_text},
    {"reflection_rays", reflection_rays},
    {"refraction_rays", refraction_rays},
    {"calls", calls},
    {"ns_per_ray_min", ns_per_ray_min},
    {"ns_per_ray_p10", ns_per_ray_p10},
    {"ci_level", ci_level},
    {"mdape_pct", mdape_pct},
    {"wall_ns_per_ray", wall_ns_per_ray},
    {"mrays_per_s", mrays_per_s},
    {"share_pct", share_pct},
    {"overhead_pct", rb_cell_overhead_pct},
    {"context_switches", context_switches},
    {"migrations", migrations},
    {"steal_ms", steal_ms},
    {"flags", rb_cell_flag_words},
    {"cycles_per_ray", rb_column_cycles_per_ray},
    {"instructions_per_ray", rb_column_instructions_per_ray},
    {"l1d_misses_per_ray", rb_column_l1d_misses_per_ray},
    {"llc_misses_per_ray", rb_column_llc_misses_per_ray},
    {"branch_misses_per_ray", rb_column_branch_misses_per_ray},
    {"compute_pct", rb_column_compute_pct},
    {"compute_stall_pct", rb_column_compute_stall_pct},
    {"memory_stall_pct", rb_column_memory_stall_pct},
    {"other_pct", rb_column_other_pct},
    {"counter_source", rb_column_counter_source},
    {"nj_per_ray", rb_column_nj_per_ray},
    {"energy_source", rb_column_energy_source},
    {"schema_version", rb_schema_version},
    {"model_cycles_per_ray", rb_column_model_cycles_per_ray},
    {"category_source", rb_column_category_source},
    {"simulated_rays", rb_column_simulated_rays},
    {"simulated_by", rb_column_simulated_by},
    {"counted_rays", counted_rays},
    {"nodes_per_ray", nodes_per_ray},
    {"boxes_per_ray", boxes_per_ray},
    {"spheres_per_ray", spheres_per_ray},
    {"triangles_per_ray", triangles_per_ray},
    {"cones_per_ray", cones_per_ray},
    {"planes_per_ray", planes_per_ray},
    {"hits_per_ray", hits_per_ray},
    {"occluded_per_ray", occluded_per_ray},
    {"steps_per_ray", steps_per_ray},
    {"lanes_active_per_ray", lanes_active_per_ray},
    {"lanes_possible_per_ray", lanes_possible_per_ray},
    {"lane_use_pct", lane_use_pct},
    {"tree_bytes_per_ray", tree_bytes_per_ray},
    {"primitive_bytes_per_ray", primitive_bytes_per_ray},
    {"stack_per_ray", stack_per_ray},
    {"stack_max", stack_max},
    {"shadings_per_ray", shadings_per_ray},
    {"category_sum_pct", rb_column_category_sum_pct},
    {"task_clock_ns_per_ray", rb_column_task_clock_ns_per_ray},
    {"page_faults_per_ray", rb_column_page_faults_per_ray},
    {"kernel_switches_per_ray", rb_column_kernel_switches_per_ray},
    {"counter_overhead_pct", rb_column_counter_overhead_pct},
    {"counted_by", rb_column_counted_by},
    {"hardware_note", rb_column_hardware_note},
    {"gross_nj_per_ray", rb_column_gross_nj_per_ray},
    {"energy_note", rb_column_energy_note},
    {.name = NULL},
};
