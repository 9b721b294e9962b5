// The columns of kernels.csv. Columns are only ever appended.
#include "bench/run/columns.h"

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

// Filled by later kinds of runs.
static struct rb_value later(const struct rb_line *line)
{
    (void)line;
    return rb_none();
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
    {"cycles_per_ray", later},
    {"instructions_per_ray", later},
    {"l1d_misses_per_ray", later},
    {"llc_misses_per_ray", later},
    {"branch_misses_per_ray", later},
    {"compute_pct", later},
    {"compute_stall_pct", later},
    {"memory_stall_pct", later},
    {"other_pct", later},
    {"counter_source", later},
    {"nj_per_ray", later},
    {"energy_source", later},
    {"schema_version", rb_schema_version},
    {.name = NULL},
};
