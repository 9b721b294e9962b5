// The columns of frame.csv, one line per cell. Columns are only ever appended.
#include "bench/run/event_columns.h"

#include <math.h>

static struct rb_value n(const struct rb_line *line)
{
    return rb_integer(line->cell->process_count);
}

static struct rb_value repetitions(const struct rb_line *line)
{
    return rb_integer((int64_t)line->cell->sample_count);
}

static struct rb_value frame_ms(const struct rb_line *line)
{
    return rb_number(line->per_ray.value * 1e-6);
}

static struct rb_value frame_ms_lo(const struct rb_line *line)
{
    return rb_number(line->per_ray.low * 1e-6);
}

static struct rb_value frame_ms_hi(const struct rb_line *line)
{
    return rb_number(line->per_ray.high * 1e-6);
}

static struct rb_value frame_ms_min(const struct rb_line *line)
{
    return rb_number(line->per_ray.min * 1e-6);
}

static struct rb_value frame_ms_p10(const struct rb_line *line)
{
    return rb_number(line->per_ray.p10 * 1e-6);
}

static struct rb_value ci_level(const struct rb_line *line)
{
    return rb_number(line->per_ray.level);
}

static struct rb_value mdape_pct(const struct rb_line *line)
{
    return rb_number(line->per_ray.mdape_pct);
}

static struct rb_value mrays_per_s(const struct rb_line *line)
{
    return rb_number(1e3 * line->cell->reference->rays / line->per_ray.value);
}

static struct rb_value imbalance(const struct rb_line *line)
{
    return rb_number(rb_cell_imbalance(line->cell));
}

static struct rb_value build_ms(const struct rb_line *line)
{
    return rb_number(rb_cell_build_ns(line->cell).value * 1e-6);
}

static struct rb_value build_ms_lo(const struct rb_line *line)
{
    return rb_number(rb_cell_build_ns(line->cell).low * 1e-6);
}

static struct rb_value build_ms_hi(const struct rb_line *line)
{
    return rb_number(rb_cell_build_ns(line->cell).high * 1e-6);
}

// Resident memory of the whole process, the largest of the cell's processes.
static struct rb_value peak_memory_bytes(const struct rb_line *line)
{
    uint64_t peak = 0;
    for (size_t i = 0; i < line->cell->sample_count; i++)
        if (line->cell->samples[i].peak_bytes > peak)
            peak = line->cell->samples[i].peak_bytes;
    return peak ? rb_integer((int64_t)peak) : rb_none();
}

static uint64_t bytes_of_tree(const struct rb_line *line)
{
    return line->cell->sample_count ? line->cell->samples[0].tree_bytes : 0;
}

static struct rb_value tree_bytes(const struct rb_line *line)
{
    return bytes_of_tree(line) ? rb_integer((int64_t)bytes_of_tree(line)) : rb_none();
}

static struct rb_value tree_bytes_per_primitive(const struct rb_line *line)
{
    double bytes = (double)bytes_of_tree(line);
    return bytes > 0 ? rb_number(bytes / line->cell->reference->primitive_count) : rb_none();
}

static struct rb_value primitives(const struct rb_line *line)
{
    return rb_integer(line->cell->reference->primitive_count);
}

static struct rb_value rays(const struct rb_line *line)
{
    return rb_integer((int64_t)line->cell->reference->rays);
}

static struct rb_value image_hash(const struct rb_line *line)
{
    return rb_hash(line->cell->reference->image_hash);
}

static struct rb_value hits_hash(const struct rb_line *line)
{
    return rb_hash(line->cell->reference->hits_hash);
}

const struct rb_column rb_frame_columns[] = {
    RB_KEY_COLUMNS,
    {"n", n},
    {"repetitions", repetitions},
    {"frame_ms", frame_ms},
    {"frame_ms_lo", frame_ms_lo},
    {"frame_ms_hi", frame_ms_hi},
    {"frame_ms_min", frame_ms_min},
    {"frame_ms_p10", frame_ms_p10},
    {"ci_level", ci_level},
    {"mdape_pct", mdape_pct},
    {"mrays_per_s", mrays_per_s},
    {"imbalance", imbalance},
    {"build_ms", build_ms},
    {"build_ms_lo", build_ms_lo},
    {"build_ms_hi", build_ms_hi},
    {"peak_memory_bytes", peak_memory_bytes},
    {"tree_bytes", tree_bytes},
    {"tree_bytes_per_primitive", tree_bytes_per_primitive},
    {"primitives", primitives},
    {"rays", rays},
    {"image_hash", image_hash},
    {"hits_hash", hits_hash},
    {"overhead_pct", rb_cell_overhead_pct},
    {"flags", rb_cell_flag_words},
    {"note", rb_cell_note_text},
    {"schema_version", rb_schema_version},
    {"frame_j", rb_column_frame_j},
    {"gross_frame_j", rb_column_gross_frame_j},
    {"edp_js", rb_column_edp_js},
    {"energy_source", rb_column_frame_energy_source},
    {"energy_note", rb_column_frame_energy_note},
    {.name = NULL},
};
