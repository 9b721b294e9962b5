// What the parts of the NFF reader share: nff.c reads entity by entity and knows the file,
// nff_entity.c knows what each entity holds, nff_view.c the view, nff_polygon.c the polygons.
#ifndef RB_SCENE_NFF_READER_H
#define RB_SCENE_NFF_READER_H

#include "scene/nff.h"
#include "scene/nff_lex.h"
#include "scene/polygon.h"
#include "scene/scene.h"

enum {
    RB_NFF_KEYWORD_MAX = 31, // bytes of a keyword
    RB_NFF_UNKNOWN_MAX = 32, // unknown keywords told apart
};

struct rb_nff_reader {
    struct rb_nff_lexer lexer;
    struct rb_scene_builder builder;
    const struct rb_nff_options *options;
    const char *name;
    struct rb_error error;

    const char *entity; // "sphere": the one being read, or read last; NULL before the first
    unsigned long entity_line, entity_column;
    unsigned long number_line, number_column; // of the number read last
    uint32_t vertex;                          // of the polygon being read, from 1; else 0
    unsigned long view_line;                  // 0: no view yet

    struct rb_array positions, normals; // of the polygon being read: double[3] each
    struct rb_polygon polygon;

    char unknown[RB_NFF_UNKNOWN_MAX][RB_NFF_KEYWORD_MAX + 1];
    size_t unknown_count;
    unsigned long unknown_line;          // of an unknown keyword that came last; else 0
    unsigned long first_degenerate_line; // of an object without extent
};

// The reader's error with its place set: to the word that comes next, to the entity's keyword, to
// the number read last. For `return rb_error_set(rb_nff_here(reader), RB_INVALID, ...)`.
struct rb_error *rb_nff_here(struct rb_nff_reader *reader);
struct rb_error *rb_nff_at_entity(struct rb_nff_reader *reader);
struct rb_error *rb_nff_at_number(struct rb_nff_reader *reader);

// Reads a number in [low, RB_COORDINATE_MAX]; `what` names it in messages: "the radius".
enum rb_status rb_nff_number(struct rb_nff_reader *reader, const char *what, double low,
                             double *out);
enum rb_status rb_nff_vector(struct rb_nff_reader *reader, const char *what, double out[3]);
enum rb_status rb_nff_color(struct rb_nff_reader *reader, const char *what, double out[3]);
enum rb_status rb_nff_whole(struct rb_nff_reader *reader, const char *what, long low, long high,
                            long *out);

// Warns of the unknown keyword that comes next, or fails if `strict`, and steps over its line.
enum rb_status rb_nff_unknown(struct rb_nff_reader *reader);

// The word that comes next starts an entity.
bool rb_nff_is_keyword(const struct rb_nff_reader *reader);

// One entity each; its keyword has been read.
typedef enum rb_status rb_nff_entity(struct rb_nff_reader *reader);
rb_nff_entity rb_nff_background, rb_nff_view, rb_nff_light, rb_nff_material, rb_nff_sphere,
    rb_nff_cone, rb_nff_flat_polygon, rb_nff_smooth_polygon, rb_nff_plane;

// Whether the word that comes next is a field of the view.
bool rb_nff_is_view_field(const struct rb_nff_reader *reader);

#endif
