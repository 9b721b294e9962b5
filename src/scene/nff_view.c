// The view of an NFF file: `v` and its six fields, in any order.
#include "scene/nff_reader.h"

#include <string.h>

enum field { FROM, AT, UP, ANGLE, HITHER, RESOLUTION, FIELD_COUNT };

static const char *const field_names[FIELD_COUNT] = {"from",  "at",     "up",
                                                     "angle", "hither", "resolution"};

// The field that comes next; FIELD_COUNT if it is none.
static enum field next_field(const struct rb_nff_reader *reader)
{
    enum field field = FROM;
    while (field < FIELD_COUNT && !rb_nff_lex_is(&reader->lexer, field_names[field]))
        field++;
    return field;
}

bool rb_nff_is_view_field(const struct rb_nff_reader *reader)
{
    return next_field(reader) < FIELD_COUNT;
}

static enum rb_status read_angle(struct rb_nff_reader *reader, double *angle)
{
    enum rb_status status =
        rb_nff_number(reader, "the angle in degrees", -RB_COORDINATE_MAX, angle);
    if (status == RB_OK && !(*angle > 0.0 && *angle < 180.0))
        return rb_error_set(rb_nff_at_number(reader), RB_INVALID,
                            "the angle of the view must lie between 0 and 180 degrees");
    return status;
}

static enum rb_status read_resolution(struct rb_nff_reader *reader, struct rb_camera *camera)
{
    long width = 0, height = 0;
    enum rb_status status = rb_nff_whole(reader, "the resolution", 1, 65536, &width);
    if (status == RB_OK)
        status = rb_nff_whole(reader, "the resolution", 1, 65536, &height);
    camera->width = (int)width;
    camera->height = (int)height;
    return status;
}

static enum rb_status read_field(struct rb_nff_reader *reader, enum field field)
{
    struct rb_camera *camera = &reader->builder.camera;
    switch (field) {
    case FROM:
        return rb_nff_vector(reader, "'from'", camera->from);
    case AT:
        return rb_nff_vector(reader, "'at'", camera->at);
    case UP:
        return rb_nff_vector(reader, "'up'", camera->up);
    case ANGLE:
        return read_angle(reader, &camera->angle_deg);
    case HITHER:
        return rb_nff_number(reader, "'hither'", -RB_COORDINATE_MAX, &camera->hither);
    default:
        return read_resolution(reader, camera);
    }
}

// Something else came where a field of the view should be.
static enum rb_status bad_field(struct rb_nff_reader *reader, unsigned seen)
{
    char missing[96] = "", quote[RB_NFF_QUOTE];
    for (int i = 0; i < FIELD_COUNT; i++) {
        size_t length = strlen(missing);
        if (!(seen & 1u << i))
            snprintf(missing + length, sizeof missing - length, "%s'%s'", length ? ", " : "",
                     field_names[i]);
    }
    struct rb_error *error = rb_nff_here(reader);
    if (reader->lexer.token == RB_NFF_END)
        return rb_error_set(error, RB_INVALID,
                            "the file ends inside the view that begins at line %lu: %s missing",
                            reader->entity_line, missing);
    if (reader->lexer.token == RB_NFF_NUMBER)
        return rb_error_set(error, RB_INVALID,
                            "number %s where a field of the view belongs (missing: %s); does the "
                            "field before it have too many?",
                            rb_nff_lex_quote(&reader->lexer, quote), missing);
    return rb_error_set(error, RB_INVALID,
                        "the view that begins at line %lu is not complete: add %s",
                        reader->entity_line, missing);
}

enum rb_status rb_nff_view(struct rb_nff_reader *reader)
{
    if (reader->view_line)
        return rb_error_set(rb_nff_at_entity(reader), RB_INVALID,
                            "a second view; a scene has one, and line %lu begins it",
                            reader->view_line);
    reader->view_line = reader->entity_line;
    unsigned seen = 0;
    enum rb_status status = RB_OK;
    while (status == RB_OK && seen != (1u << FIELD_COUNT) - 1) {
        enum field field = next_field(reader);
        if (field < FIELD_COUNT) {
            if (seen & 1u << field)
                return rb_error_set(rb_nff_here(reader), RB_INVALID,
                                    "a second '%s' in one view; remove one", field_names[field]);
            seen |= 1u << field;
            rb_nff_lex_next(&reader->lexer);
            status = read_field(reader, field);
        } else if (reader->lexer.token == RB_NFF_WORD && !rb_nff_is_keyword(reader)) {
            status = rb_nff_unknown(reader);
        } else {
            status = bad_field(reader, seen);
        }
    }
    if (status != RB_OK)
        return status;
    return rb_scene_check_camera(&reader->builder.camera, rb_nff_at_entity(reader));
}
