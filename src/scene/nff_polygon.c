// Polygons of NFF, `p` and `pp`: any number of vertices, kept only until the polygon is in
// triangles.
#include "scene/nff_reader.h"

#include <stdint.h>

// Reads one vertex into the arrays, which grow with what the file holds and not with what it
// promises.
static enum rb_status read_vertex(struct rb_nff_reader *reader, bool smooth)
{
    double position[3], normal[3];
    enum rb_status status = rb_nff_vector(reader, "a coordinate", position);
    if (status == RB_OK && smooth) {
        unsigned long line = reader->lexer.line, column = reader->lexer.column;
        status = rb_nff_vector(reader, "the normal", normal);
        if (status == RB_OK && normal[0] == 0.0 && normal[1] == 0.0 && normal[2] == 0.0) {
            reader->error.line = line;
            reader->error.column = column;
            return rb_error_set(&reader->error, RB_INVALID,
                                "the normal of vertex %u of the polygon has length zero",
                                reader->vertex);
        }
    }
    if (status != RB_OK)
        return status;
    if (!rb_array_push(&reader->positions, position, sizeof position) ||
        (smooth && !rb_array_push(&reader->normals, normal, sizeof normal)))
        return rb_error_memory(&reader->error, "the vertices of a polygon");
    return RB_OK;
}

static enum rb_status add_triangle(struct rb_nff_reader *reader, const uint32_t corner[3],
                                   bool smooth)
{
    const double(*positions)[3] = reader->positions.data;
    const double(*normals)[3] = reader->normals.data;
    double v[3][3], n[3][3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            v[i][k] = positions[corner[i]][k];
            n[i][k] = smooth ? normals[corner[i]][k] : 0.0;
        }
    }
    return rb_scene_add_triangle(&reader->builder, (const double(*)[3])v,
                                 smooth ? (const double(*)[3])n : NULL, rb_nff_at_entity(reader));
}

// A polygon counts as without extent only if none of its triangles has any.
static enum rb_status add_polygon(struct rb_nff_reader *reader, bool smooth)
{
    struct rb_polygon *polygon = &reader->polygon;
    struct rb_scene_builder *builder = &reader->builder;
    size_t degenerate = builder->degenerate_count;
    size_t before = builder->primitives[RB_TRIANGLE].count;
    enum rb_status status =
        rb_polygon_triangulate(polygon, reader->positions.data, (uint32_t)reader->positions.count,
                               rb_nff_at_entity(reader));
    const uint32_t(*triangles)[3] = polygon->triangles.data;
    for (size_t i = 0; i < polygon->triangles.count && status == RB_OK; i++)
        status = add_triangle(reader, triangles[i], smooth);
    bool empty = builder->primitives[RB_TRIANGLE].count == before;
    builder->degenerate_count = degenerate + empty;
    return status;
}

static enum rb_status read_polygon(struct rb_nff_reader *reader, bool smooth)
{
    long count = 0;
    enum rb_status status = rb_nff_whole(reader, "the number of vertices", 3, INT32_MAX, &count);
    reader->positions.count = 0;
    reader->normals.count = 0;
    for (long i = 0; i < count && status == RB_OK; i++) {
        reader->vertex = (uint32_t)i + 1;
        status = read_vertex(reader, smooth);
    }
    reader->vertex = 0;
    return status == RB_OK ? add_polygon(reader, smooth) : status;
}

enum rb_status rb_nff_flat_polygon(struct rb_nff_reader *reader)
{
    return read_polygon(reader, false);
}

enum rb_status rb_nff_smooth_polygon(struct rb_nff_reader *reader)
{
    return read_polygon(reader, true);
}
