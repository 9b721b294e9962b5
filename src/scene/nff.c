// The NFF reader: one entity after another until the file ends. What an entity holds is up to its
// handler; everything is read free-form, so line ends mean nothing but to comments and to what is
// skipped behind an unknown keyword.
#include "scene/nff_reader.h"

#include "base/fpenv.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

#define KEYWORDS "b v l f s c p pp pl"

static const struct keyword {
    const char *word;
    const char *entity; // for messages
    rb_nff_entity *read;
} keywords[] = {
    {"p", "polygon", rb_nff_flat_polygon},
    {"s", "sphere", rb_nff_sphere},
    {"pp", "polygon", rb_nff_smooth_polygon},
    {"c", "cone", rb_nff_cone},
    {"f", "material", rb_nff_material},
    {"l", "light", rb_nff_light},
    {"pl", "plane", rb_nff_plane},
    {"gpl", "plane", rb_nff_plane}, // gpl: before 2014
    {"b", "background", rb_nff_background},
    {"v", "view", rb_nff_view},
};

static const struct keyword *find_keyword(const struct rb_nff_lexer *lexer)
{
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++) {
        if (rb_nff_lex_is(lexer, keywords[i].word))
            return &keywords[i];
    }
    return NULL;
}

bool rb_nff_is_keyword(const struct rb_nff_reader *reader)
{
    return find_keyword(&reader->lexer) != NULL;
}

static struct rb_error *place(struct rb_nff_reader *reader, unsigned long line,
                              unsigned long column)
{
    reader->error.line = line;
    reader->error.column = column;
    return &reader->error;
}

struct rb_error *rb_nff_here(struct rb_nff_reader *reader)
{
    return place(reader, reader->lexer.line, reader->lexer.column);
}

struct rb_error *rb_nff_at_entity(struct rb_nff_reader *reader)
{
    return place(reader, reader->entity_line, reader->entity_column);
}

struct rb_error *rb_nff_at_number(struct rb_nff_reader *reader)
{
    return place(reader, reader->number_line, reader->number_column);
}

// Line 0 means the whole file.
__attribute__((format(printf, 4, 5))) static void warn(const struct rb_nff_reader *reader,
                                                       unsigned long line, unsigned long column,
                                                       const char *format, ...)
{
    const struct rb_nff_options *options = reader->options;
    if (!options || !options->warn)
        return;
    struct rb_error warning = {.line = line, .column = column};
    snprintf(warning.file, sizeof warning.file, "%s", reader->name);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(warning.text, sizeof warning.text, format, arguments);
    va_end(arguments);
    options->warn(options->user, &warning);
}

// Letters, digits and '_', a letter first. Anything else is not NFF of any dialect.
static bool plausible_keyword(const struct rb_nff_lexer *lexer)
{
    if (lexer->length > RB_NFF_KEYWORD_MAX)
        return false;
    for (size_t i = 0; i < lexer->length; i++) {
        char c = lexer->text[i];
        bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (!letter && (i == 0 || !((c >= '0' && c <= '9') || c == '_')))
            return false;
    }
    return true;
}

// Remembers the keyword that comes next; whether it is new. One too many stands for all others.
static bool remember_unknown(struct rb_nff_reader *reader)
{
    if (reader->unknown_count > RB_NFF_UNKNOWN_MAX)
        return false;
    for (size_t i = 0; i < reader->unknown_count; i++) {
        if (rb_nff_lex_is(&reader->lexer, reader->unknown[i]))
            return false;
    }
    if (reader->unknown_count < RB_NFF_UNKNOWN_MAX)
        memcpy(reader->unknown[reader->unknown_count], reader->lexer.text, reader->lexer.length);
    reader->unknown_count++;
    return true;
}

enum rb_status rb_nff_unknown(struct rb_nff_reader *reader)
{
    struct rb_nff_lexer *lexer = &reader->lexer;
    char quote[RB_NFF_QUOTE];
    rb_nff_lex_quote(lexer, quote);
    if (!plausible_keyword(lexer))
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "%s is neither a keyword (" KEYWORDS ") nor a number; is this an NFF "
                            "file?",
                            quote);
    if (reader->options && reader->options->strict)
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "unknown keyword %s; NFF knows " KEYWORDS
                            " (without --strict its line is skipped)",
                            quote);
    if (remember_unknown(reader)) {
        if (reader->unknown_count <= RB_NFF_UNKNOWN_MAX)
            warn(reader, lexer->line, lexer->column, "unknown keyword %s: its lines are skipped",
                 quote);
        else
            warn(reader, lexer->line, lexer->column,
                 "unknown keyword %s: skipped; further ones are not reported", quote);
    }
    reader->unknown_line = lexer->line;
    rb_nff_lex_next_line(lexer);
    return RB_OK;
}

// A number where an entity should begin.
static enum rb_status stray_number(struct rb_nff_reader *reader)
{
    char quote[RB_NFF_QUOTE], reason[128] = "an NFF file begins with a keyword";
    rb_nff_lex_quote(&reader->lexer, quote);
    if (reader->unknown_line)
        snprintf(reason, sizeof reason, "does the unknown keyword of line %lu go on here?",
                 reader->unknown_line);
    else if (reader->entity)
        snprintf(reason, sizeof reason, "does the %s that begins at line %lu have too many?",
                 reader->entity, reader->entity_line);
    return rb_error_set(rb_nff_here(reader), RB_INVALID,
                        "number %s where a keyword (" KEYWORDS ") belongs; %s", quote, reason);
}

static enum rb_status read_entity(struct rb_nff_reader *reader)
{
    struct rb_nff_lexer *lexer = &reader->lexer;
    const struct keyword *keyword = find_keyword(lexer);
    if (!keyword) {
        if (lexer->token == RB_NFF_NUMBER)
            return stray_number(reader);
        if (!rb_nff_is_view_field(reader))
            return rb_nff_unknown(reader);
        char quote[RB_NFF_QUOTE];
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "%s outside a view; it belongs behind a 'v', once",
                            rb_nff_lex_quote(lexer, quote));
    }
    size_t degenerate = reader->builder.degenerate_count;
    reader->entity = keyword->entity;
    reader->entity_line = lexer->line;
    reader->entity_column = lexer->column;
    reader->unknown_line = 0;
    rb_nff_lex_next(lexer);
    enum rb_status status = keyword->read(reader);
    if (reader->builder.degenerate_count > degenerate && !reader->first_degenerate_line)
        reader->first_degenerate_line = reader->entity_line;
    return status;
}

static enum rb_status read_error(struct rb_nff_reader *reader)
{
    int code = reader->lexer.read_errno;
    return rb_error_set(place(reader, 0, 0), code == ENOMEM ? RB_FAILED : RB_INVALID,
                        "cannot read: %s", strerror(code));
}

static enum rb_status read_all(struct rb_nff_reader *reader, FILE *stream)
{
    enum rb_status status = RB_OK;
    rb_nff_lex_start(&reader->lexer, stream);
    while (status == RB_OK && reader->lexer.token != RB_NFF_END)
        status = read_entity(reader);
    if (reader->lexer.read_errno)
        return read_error(reader);
    if (status != RB_OK)
        return status;
    if (!reader->entity && !reader->unknown_line)
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "nothing in the file; a scene needs at least a view (v)");
    if (!reader->view_line)
        return rb_error_set(rb_nff_here(reader), RB_INVALID,
                            "the file has no view; add 'v' with from, at, up, angle, hither and "
                            "resolution");
    return RB_OK;
}

static enum rb_status finish(struct rb_nff_reader *reader, struct rb_scene *scene)
{
    size_t degenerate = reader->builder.degenerate_count;
    enum rb_status status = rb_scene_finish(&reader->builder, scene, place(reader, 0, 0));
    if (status != RB_OK)
        return status;
    if (degenerate)
        warn(reader, 0, 0, "%zu object%s without extent dropped, the first at line %lu", degenerate,
             degenerate == 1 ? "" : "s", reader->first_degenerate_line);
    if (scene->primitive_count == 0)
        warn(reader, 0, 0, "the scene has no objects; its image is all background");
    return RB_OK;
}

static void release(struct rb_nff_reader *reader)
{
    rb_scene_builder_release(&reader->builder);
    rb_array_release(&reader->positions);
    rb_array_release(&reader->normals);
    rb_polygon_release(&reader->polygon);
    rb_free(reader);
}

enum rb_status rb_nff_read(FILE *stream, const char *name, const struct rb_nff_options *options,
                           struct rb_scene *scene, struct rb_error *error)
{
    *scene = (struct rb_scene){0};
    struct rb_nff_reader *reader = rb_alloc(1, sizeof *reader);
    if (!reader)
        return rb_error_memory(error, "the reader");
    reader->options = options;
    reader->name = name;
    snprintf(reader->error.file, sizeof reader->error.file, "%s", name);

    fenv_t saved;
    rb_fpenv_enter(&saved);
    enum rb_status status = read_all(reader, stream);
    if (status == RB_OK)
        status = finish(reader, scene);
    rb_fpenv_leave(&saved);

    if (status == RB_FAILED)
        place(reader, 0, 0);
    if (status != RB_OK && error)
        *error = reader->error;
    release(reader);
    return status;
}
