// The entities of NFF but for the view and the polygons: what each holds, and numbers in general.
#include "scene/nff_reader.h"

#include <math.h>

#define ANY (-RB_COORDINATE_MAX)

// "the radius of the sphere", "a coordinate of vertex 7 of the polygon".
static const char *full_name(const struct rb_nff_reader *reader, const char *what, char *out,
                             size_t size)
{
    if (reader->vertex)
        snprintf(out, size, "%s of vertex %u of the %s", what, reader->vertex, reader->entity);
    else
        snprintf(out, size, "%s of the %s", what, reader->entity);
    return out;
}

static enum rb_status bad_number(struct rb_nff_reader *reader, const char *what,
                                 const char *problem)
{
    char name[128], quote[RB_NFF_QUOTE];
    full_name(reader, what, name, sizeof name);
    if (reader->lexer.token == RB_NFF_END)
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "the file ends inside the %s that begins at line %lu: %s is missing",
                            reader->entity, reader->entity_line, name);
    return rb_error_set(rb_nff_here(reader), RB_INVALID, "%s %s; %s belongs here",
                        rb_nff_lex_quote(&reader->lexer, quote), problem, name);
}

enum rb_status rb_nff_number(struct rb_nff_reader *reader, const char *what, double low,
                             double *out)
{
    double value = 0.0;
    const char *problem = rb_nff_lex_number(&reader->lexer, &value);
    if (!problem && fabs(value) > RB_COORDINATE_MAX)
        problem = "is too large (a scene may span +-1e12)";
    else if (!problem && value < low)
        problem = "is negative";
    if (problem)
        return bad_number(reader, what, problem);
    reader->number_line = reader->lexer.line;
    reader->number_column = reader->lexer.column;
    *out = value;
    rb_nff_lex_next(&reader->lexer);
    return RB_OK;
}

enum rb_status rb_nff_vector(struct rb_nff_reader *reader, const char *what, double out[3])
{
    enum rb_status status = RB_OK;
    for (int i = 0; i < 3 && status == RB_OK; i++)
        status = rb_nff_number(reader, what, ANY, &out[i]);
    return status;
}

enum rb_status rb_nff_color(struct rb_nff_reader *reader, const char *what, double out[3])
{
    enum rb_status status = RB_OK;
    for (int i = 0; i < 3 && status == RB_OK; i++)
        status = rb_nff_number(reader, what, 0.0, &out[i]);
    return status;
}

enum rb_status rb_nff_whole(struct rb_nff_reader *reader, const char *what, long low, long high,
                            long *out)
{
    char name[128], quote[RB_NFF_QUOTE];
    double value = 0.0;
    if (!rb_nff_lex_number(&reader->lexer, &value) &&
        (value != floor(value) || value < (double)low || value > (double)high))
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "%s: %s must be a whole number from %ld to %ld",
                            rb_nff_lex_quote(&reader->lexer, quote),
                            full_name(reader, what, name, sizeof name), low, high);
    enum rb_status status = rb_nff_number(reader, what, ANY, &value);
    *out = (long)value;
    return status;
}

enum rb_status rb_nff_background(struct rb_nff_reader *reader)
{
    double color[3];
    enum rb_status status = rb_nff_color(reader, "the colour", color);
    for (int i = 0; i < 3 && status == RB_OK; i++)
        reader->builder.background[i] = (float)color[i];
    return status;
}

// The colour is there if another number follows, on whatever line.
enum rb_status rb_nff_light(struct rb_nff_reader *reader)
{
    double position[3], color[3] = {1.0, 1.0, 1.0};
    enum rb_status status = rb_nff_vector(reader, "a coordinate", position);
    if (status == RB_OK && reader->lexer.token == RB_NFF_NUMBER)
        status = rb_nff_color(reader, "the colour", color);
    if (status != RB_OK)
        return status;
    return rb_scene_add_light(&reader->builder, position, color, rb_nff_at_entity(reader));
}

enum rb_status rb_nff_material(struct rb_nff_reader *reader)
{
    static const char *const names[] = {"Kd", "Ks", "Shine", "T"};
    double color[3], parts[4], ior = 0.0;
    enum rb_status status = rb_nff_color(reader, "the colour", color);
    for (int i = 0; i < 4 && status == RB_OK; i++)
        status = rb_nff_number(reader, names[i], 0.0, &parts[i]);
    if (status == RB_OK)
        status = rb_nff_number(reader, "the index of refraction", ANY, &ior);
    if (status != RB_OK)
        return status;
    return rb_scene_add_material(&reader->builder, color, parts[0], parts[1], parts[2], parts[3],
                                 ior, rb_nff_at_number(reader));
}

enum rb_status rb_nff_sphere(struct rb_nff_reader *reader)
{
    double center[3], radius = 0.0;
    enum rb_status status = rb_nff_vector(reader, "a coordinate", center);
    if (status == RB_OK)
        status = rb_nff_number(reader, "the radius", ANY, &radius);
    if (status != RB_OK)
        return status;
    return rb_scene_add_sphere(&reader->builder, center, radius, rb_nff_at_entity(reader));
}

enum rb_status rb_nff_cone(struct rb_nff_reader *reader)
{
    double base[3], base_radius = 0.0, apex[3], apex_radius = 0.0;
    enum rb_status status = rb_nff_vector(reader, "a coordinate of the base", base);
    if (status == RB_OK)
        status = rb_nff_number(reader, "the radius of the base", ANY, &base_radius);
    if (status == RB_OK)
        status = rb_nff_vector(reader, "a coordinate of the apex", apex);
    if (status == RB_OK)
        status = rb_nff_number(reader, "the radius of the apex", ANY, &apex_radius);
    if (status != RB_OK)
        return status;
    return rb_scene_add_cone(&reader->builder, base, base_radius, apex, apex_radius,
                             rb_nff_at_number(reader));
}

enum rb_status rb_nff_plane(struct rb_nff_reader *reader)
{
    double points[3][3];
    enum rb_status status = RB_OK;
    for (int i = 0; i < 3 && status == RB_OK; i++)
        status = rb_nff_vector(reader, "a coordinate", points[i]);
    if (status != RB_OK)
        return status;
    return rb_scene_add_plane(&reader->builder, (const double(*)[3])points,
                              rb_nff_at_entity(reader));
}
