#define _POSIX_C_SOURCE 200809L
#include "bench/times/render_session.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum rb_status rb_render_session_open(struct rb_render_session *session,
                                      struct rb_render_cell *cells, size_t count,
                                      struct rb_error *error)
{
    *session = (struct rb_render_session){.cells = cells, .count = count};
    ssize_t length = readlink("/proc/self/exe", session->program, sizeof session->program - 1);
    if (length <= 0)
        return rb_error_set(error, RB_FAILED, "cannot find our own program in /proc/self/exe: %s",
                            strerror(errno));
    const char *parent = getenv("TMPDIR");
    int room = snprintf(session->folder, sizeof session->folder, "%s/raybench-table-XXXXXX",
                        parent && parent[0] ? parent : "/tmp");
    if (room >= (int)sizeof session->folder || !mkdtemp(session->folder)) {
        snprintf(error->file, sizeof error->file, "%.*s", (int)sizeof error->file - 1,
                 session->folder);
        return rb_error_set(error, RB_FAILED, "cannot make a temporary folder: %s (set TMPDIR)",
                            strerror(errno));
    }
    snprintf(session->image, sizeof session->image, "%s/image.ppm", session->folder);
    snprintf(session->log, sizeof session->log, "%s/log", session->folder);
    snprintf(session->json, sizeof session->json, "%s/hyperfine.json", session->folder);
    if (!rb_hyperfine_find(session->hyperfine))
        session->hyperfine[0] = '\0';
    session->disagrees = rb_alloc(count, sizeof *session->disagrees);
    if (session->disagrees)
        return RB_OK;
    rb_render_session_close(session);
    return rb_error_memory(error, "the render-time table");
}

void rb_render_session_close(struct rb_render_session *session)
{
    unlink(session->image);
    unlink(session->log);
    unlink(session->json);
    rmdir(session->folder);
    rb_free(session->disagrees);
}

struct command {
    char size[32];
    const char *words[16]; // NULL-ended
};

// What a cell times; with an image of `edge` x `edge` pixels if that is not 0. Then the tiles are
// small, too, so that threads share them as they share those of a large image.
static void make_command(const struct rb_render_session *session, const struct rb_render_cell *cell,
                         int edge, struct command *command)
{
    snprintf(command->size, sizeof command->size, "%dx%d", edge, edge);
    const char *words[] = {session->program,
                           "render",
                           cell->scene->name,
                           "--variant",
                           cell->variant->name,
                           "-o",
                           session->image,
                           "--quiet",
                           edge ? "--size" : NULL,
                           command->size,
                           "--tile",
                           "16",
                           NULL};
    memcpy(command->words, words, sizeof words);
}

enum rb_status rb_render_session_time(const struct rb_render_session *session,
                                      const struct rb_render_cell *cell, int edge,
                                      struct rb_timed_result *time, struct rb_error *error)
{
    struct command command;
    make_command(session, cell, edge, &command);
    return rb_timed_run((char *const *)command.words, NULL, session->log, time, error);
}

enum rb_status rb_render_session_hyperfine(const struct rb_render_session *session,
                                           const struct rb_render_cell *cell,
                                           struct rb_run_times *times, struct rb_error *error)
{
    struct command command;
    make_command(session, cell, 0, &command);
    return rb_hyperfine_run((char *const *)command.words, cell->warmups, cell->runs, session->json,
                            session->log, times, error);
}

static enum rb_status hash_image(const struct rb_render_session *session, uint64_t *hash,
                                 struct rb_error *error)
{
    char *text;
    size_t length;
    enum rb_status status = rb_file_read(session->image, &text, &length, error);
    if (status)
        return status;
    *hash = length;
    for (size_t i = 0; i < length; i++)
        *hash = rb_hash_word(*hash, (unsigned char)text[i]);
    rb_free(text);
    return RB_OK;
}

enum rb_status rb_render_session_compare(struct rb_render_session *session, size_t index,
                                         struct rb_error *error)
{
    uint64_t hash;
    enum rb_status status = hash_image(session, &hash, error);
    if (status)
        return status;
    if (!session->has_reference)
        session->reference = hash;
    session->has_reference = true;
    session->disagrees[index] |= hash != session->reference;
    return RB_OK;
}
