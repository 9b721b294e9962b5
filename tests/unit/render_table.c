// The render-time table without measuring: plan, CSV, Markdown, README, what is complete.
#define _POSIX_C_SOURCE 200809L
#include "base/memory.h"
#include "bench/times/render_measure.h"
#include "bench/times/render_report.h"
#include "bench/times/render_select.h"
#include "scene/load.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fmax(1.0, fabs(b));
}

static void check_plan(void)
{
    struct rb_render_cell cells[] = {{.estimate_s = 60},
                                     {.estimate_s = 5},
                                     {.estimate_s = 0.1},
                                     {.estimate_s = 210},
                                     {.estimate_s = 20}};
    // One run of 60, 210 and 20 s; three and a warm-up of 5 s; ten and a warm-up of 0.1 s.
    double total = rb_render_plan(cells, 5, 10, 1000);
    ok(near(total, 290 + 20 + 1.1), "the seconds of a plan add up");
    ok(cells[0].runs == 1 && cells[0].warmups == 0 && cells[1].runs == 3 && cells[1].warmups == 1 &&
           cells[2].runs == 10 && cells[3].runs == 1,
       "long runs once, short ones often");
    total = rb_render_plan(cells, 5, 10, 300);
    ok(near(total, 291.1) && (cells[1].runs == 0) != (cells[4].runs == 0) && cells[0].runs == 1 &&
           cells[3].runs == 1,
       "the cheapest that frees enough gives way");
    total = rb_render_plan(cells, 5, 10, 40);
    ok(near(total, 20 + 1.1), "the dearest go first");
    ok(cells[3].runs == 0 && cells[0].runs == 0, "the two longest are extrapolated");
    total = rb_render_plan(cells, 5, 10, 0.5);
    ok(near(total, 0.5) && cells[2].runs == 4, "then short ones are repeated less often");
    total = rb_render_plan(cells, 5, 10, 0);
    ok(near(total, 0.2) && cells[2].runs == 1, "but run once whatever the budget");
    total = rb_render_plan(cells, 5, 1, 1000);
    ok(cells[1].runs == 1 && cells[2].runs == 1, "one run if that is asked for");

    // 0.2 s and 1 ms a pixel.
    ok(near(rb_render_extrapolate(0.456, 256, 4.296, 4096, 262144), 0.2 + 262.144),
       "an extrapolation by hand");
    ok(near(rb_render_extrapolate(0.5, 256, 0.4, 4096, 262144), 0.4), "never below what was seen");
}

static void check_selection(void)
{
    struct rb_render_cell *cells = NULL;
    size_t count = 0;
    struct rb_error error = {0};
    struct rb_render_selection some = {"balls_*,mount_low", "bvh"};
    ok(rb_render_select(&some, &cells, &count, &error) == RB_OK && count == 4 &&
           strcmp(cells[3].scene->name, "mount_low") == 0 &&
           strcmp(cells[0].variant->name, "bvh") == 0,
       "names and globs");
    rb_free(cells);
    struct rb_render_selection alias = {NULL, "bvh,packet"};
    ok(rb_render_select(&alias, &cells, &count, &error) == RB_INVALID &&
           strstr(error.text, "'packet'"),
       "an alias is no row");
    struct rb_render_selection none = {"balls_low,nix", NULL};
    ok(rb_render_select(&none, &cells, &count, &error) == RB_INVALID, "an unknown scene");
    char available[RB_AVAILABLE_ROOM];
    rb_render_available(available);
    ok(strncmp(available, "naive ", 6) == 0 && !strstr(available, "packet "),
       "available: naive first, no aliases");
}

// The images are as large as the estimates take them to be.
static void check_edges(void)
{
    static const char *const names[] = {"balls_low", "mount_low"};
    for (int i = 0; i < 2; i++) {
        struct rb_scene scene;
        struct rb_error error = {0};
        struct rb_nff_options options = {0};
        bool loaded = rb_scene_load(names[i], &options, &scene, &error) == RB_OK;
        ok(loaded && scene.camera.width == RB_RENDER_EDGE && scene.camera.height == RB_RENDER_EDGE,
           "%s has the size that is extrapolated to", names[i]);
        if (loaded)
            rb_scene_free(&scene);
    }
}

#define HEADER                                                                                     \
    "scene,paper_s,variant,threads,median_s,mean_s,min_s,max_s,runs,source,speedup_over_naive,"    \
    "speedup_over_paper,note,cpu_model,git_commit,utc,available,user_s,system_s\r\n"
#define ORIGIN ",\"A, B | C\",abcdef0,2026-01-02T03:04:05Z,naive bvh bvh+omp,"

static const char csv[] =
    HEADER "balls_low,3,naive,1,2,,,,0,raybench,1,1.5,est.: so" ORIGIN ",\r\n"
           "balls_low,3,bvh,1,0.5,0.55,0.4,0.7,10,hyperfine 1.15.0,4,6," ORIGIN "0.5,0.01\r\n"
           "balls_low,3,bvh+omp,2,0.25,0.25,0.2,0.3,10,hyperfine 1.15.0,8,12," ORIGIN "0.5,0.01\r\n"
           "balls_low,3,packet-x,1,0.125,0.1,0.1,0.1,10,hyperfine 1.15.0,16,24," ORIGIN "0,0\r\n";

static char path[] = "/tmp/raybench-test-XXXXXX";

static enum rb_status load(const char *text, struct rb_render_table *table, struct rb_error *error)
{
    FILE *file = fopen(path, "wb");
    fwrite(text, 1, strlen(text), file);
    fclose(file);
    *error = (struct rb_error){0};
    return rb_render_table_load(path, table, error);
}

typedef void write_fn(FILE *out, const struct rb_render_table *table);

static char *written(write_fn *write, const struct rb_render_table *table)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    write(out, table);
    fclose(out);
    return text;
}

static bool writes(write_fn *write, const struct rb_render_table *table, const char *part)
{
    char *text = written(write, table);
    bool found = strstr(text, part) != NULL;
    if (!found)
        note("no '%s' in: %s", part, text);
    free(text);
    return found;
}

static void check_csv(void)
{
    struct rb_render_table table;
    struct rb_error error;
    if (!ok(load(csv, &table, &error) == RB_OK && table.count == 4, "a table is loaded"))
        return;
    char *again = written(rb_render_table_write, &table);
    ok(strcmp(again, csv) == 0, "and written as it was");
    free(again);
    ok(rb_render_row_estimated(&table.rows[0]) && !rb_render_row_estimated(&table.rows[1]),
       "no run in full: an estimate");
    ok(writes(rb_render_report_markdown, &table,
              "| naive | 1 | 3 | 2 est. | - | - | - | 0 | 1 est. | 1.5 est. | raybench | est.: so "
              "|\n"),
       "a row of the Markdown, estimated");
    ok(writes(rb_render_report_markdown, &table,
              "| bvh | 1 | 3 | 0.5 | 0.55 | 0.4 | 0.7 | 10 | 4 est. | 6 | hyperfine 1.15.0 |  |\n"),
       "a row of the Markdown, measured");
    ok(writes(rb_render_report_markdown, &table, "| packet-x | 0.125 |\n"), "the overview");
    ok(writes(rb_render_report_markdown, &table, "A, B \\| C, 2 threads, commit abcdef0"),
       "the machine, which cannot break a table");
    ok(writes(rb_render_report_compact, &table,
              "| balls_low | 3 | 2 est. | 0.5 | 0.125 packet-x | 0.25 bvh+omp |\n"),
       "the compact table");
    ok(!writes(rb_render_report_markdown, &table, "J a frame"), "no energy, no column");
    table.rows[1].frame_j = 12.5;
    ok(writes(rb_render_table_write, &table, "system_s,frame_j\r\n") &&
           writes(rb_render_table_write, &table, "0.5,0.01,12.5\r\n") &&
           writes(rb_render_report_markdown, &table,
                  "| bvh | 1 | 3 | 0.5 | 0.55 | 0.4 | 0.7 | 12.5 | 10 | 4 est. |"),
       "joules a frame, where they were measured");
    char *energetic = written(rb_render_table_write, &table);
    rb_render_table_free(&table);
    ok(load(energetic, &table, &error) == RB_OK && table.rows[1].frame_j == 12.5 &&
           isnan(table.rows[0].frame_j),
       "and they are read again");
    free(energetic);
    rb_render_table_free(&table);

    static const struct {
        const char *text, *problem;
        unsigned long line;
    } bad[] = {
        {"scene,paper_s\r\nballs_low,3\r\n", "no column variant", 0},
        {HEADER "balls,3,bvh,1,1,1,1,1,1,x,,," ORIGIN ",\r\n", "not a scene", 2},
        {HEADER "balls_low,3,bvh,1,1,1,1,1,-1,x,,," ORIGIN ",\r\n", "runs must be", 2},
        {HEADER "balls_low,3,bvh,1,1,1,1,1,1,x,,," ORIGIN ",\r\n"
                "balls_low,3,bvh,1,1,1,1,1,1,x,,," ORIGIN ",\r\n",
         "a second row", 3},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (!ok(load(bad[i].text, &table, &error) == RB_INVALID && error.line == bad[i].line &&
                    strstr(error.text, bad[i].problem),
                "refused: %s", bad[i].problem))
            note("%lu: %s", error.line, error.text);
}

static void check_complete(void)
{
    struct rb_render_table table;
    struct rb_error error;
    struct rb_render_selection low = {"balls_low", NULL}, all = {NULL, NULL};
    load(csv, &table, &error);
    ok(rb_render_complete(&low, &table, &error) == RB_OK, "all rows of a scene");
    ok(rb_render_complete(&all, &table, &error) == RB_INVALID &&
           strstr(error.text, "no row of naive on balls_medium"),
       "a scene is missing");
    table.rows[1].median_s = (double)NAN;
    ok(rb_render_complete(&low, &table, &error) == RB_INVALID &&
           strstr(error.text, "no time of bvh on balls_low"),
       "a time is missing");
    table.rows[1].variant = "bhv";
    ok(rb_render_complete(&low, &table, &error) == RB_INVALID &&
           strstr(error.text, "no row of bvh on balls_low"),
       "a row is missing");
    table.rows[2].git_commit = "1234567";
    ok(rb_render_complete(&low, &table, &error) == RB_INVALID && error.line == 4,
       "rows of two runs");
    rb_render_table_free(&table);
}

static enum rb_status readme(const char *text, const struct rb_render_table *table, char **result,
                             struct rb_error *error)
{
    size_t length;
    *result = NULL;
    *error = (struct rb_error){0};
    FILE *out = open_memstream(result, &length);
    enum rb_status status = rb_render_report_readme(out, text, strlen(text), table, error);
    fclose(out);
    return status;
}

static void check_readme(void)
{
    static const char *const wrong[] = {
        "",
        "a\n" RB_README_BEGIN "\n",
        "a\n" RB_README_END "\n",
        RB_README_END "\n" RB_README_BEGIN "\n",
        RB_README_BEGIN "\n" RB_README_BEGIN "\n" RB_README_END "\n",
        RB_README_BEGIN "\n" RB_README_END "\nb\n" RB_README_END,
        " " RB_README_BEGIN "\n" RB_README_END "\n",
    };
    struct rb_render_table table;
    struct rb_error error;
    char *text, *twice;
    load(csv, &table, &error);
    ok(readme("top\n" RB_README_BEGIN "\nold\n" RB_README_END "\nbottom", &table, &text, &error) ==
               RB_OK &&
           strncmp(text, "top\n" RB_README_BEGIN "\n\n| seconds |", 20) == 0 &&
           strstr(text, ".\n\n" RB_README_END "\nbottom") && !strstr(text, "old"),
       "the block is replaced");
    ok(readme(text, &table, &twice, &error) == RB_OK && strcmp(text, twice) == 0,
       "and again by the same");
    free(text);
    free(twice);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ok(readme(wrong[i], &table, &text, &error) == RB_INVALID && error.text[0],
           "wrong markers %zu: %s", i, error.text);
        free(text);
    }
    rb_render_table_free(&table);
}

int main(void)
{
    int descriptor = mkstemp(path);
    if (descriptor < 0)
        return 1;
    close(descriptor);
    check_plan();
    check_selection();
    check_edges();
    check_csv();
    check_complete();
    check_readme();
    unlink(path);
    ok(rb_memory_live_count() == 0, "all memory is released");
    return done();
}
