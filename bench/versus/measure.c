// Both sides of all contests of a scene in processes, one after the other: so that both have the
// same neighbours in time.
#include "bench/data/names.h"
#include "bench/run/process.h"
#include "bench/versus/session.h"
#include "cli/commands.h"
#include "measure/affinity.h"

#include <stdio.h>
#include <unistd.h>

enum { PROCESSES_DEFAULT = 6, PROCESSES_LEAST = 2, CPUS_MAX = 1024 };
static const double MEASURE_S = 0.5, MEASURE_LEAST_S = 0.05;

static int process_count(const struct rb_versus_session *session)
{
    int wanted = session->arguments->bench.processes;
    return wanted ? wanted : PROCESSES_DEFAULT;
}

static bool is_wanted(const struct rb_versus_session *session, const struct rb_contest *contest)
{
    const char *list = session->arguments->bench.classes;
    return contest->ray_count && rb_names_match(list, contest->rays_name);
}

void rb_versus_tell(const struct rb_versus_session *session, const char *scene, const char *what)
{
    if (!session->arguments->quiet && isatty(STDERR_FILENO))
        fprintf(stderr, "\r%s: %s\033[K\r", scene, what);
}

// How often both sides of all contests of a scene run, and how long each process measures.
struct rounds {
    int count;
    double measure_s;
};

// What is left of the budget is shared among the scenes. First all rounds that were asked for get
// the least time; what then remains is theirs.
static struct rounds plan_rounds(const struct rb_versus_session *session,
                                 const struct rb_contest *contests, int scene)
{
    const struct rb_arguments *arguments = session->arguments;
    struct rounds rounds = {process_count(session), MEASURE_S};
    double fixed_s = 0; // of a round
    int processes = 0;
    if (arguments->budget_s == 0)
        return rounds;
    for (int c = 0; c < session->scene_contests; c++)
        for (int side = 0; side < 2 && is_wanted(session, &contests[c]); side++, processes++)
            fixed_s += contests[c].side[side].load_s + 2 * contests[c].side[side].round_s;
    double share_s = (arguments->budget_s - (double)(rb_clock_ns() - session->start_ns) * 1e-9) /
                     (session->scene_count - scene);
    double affordable = share_s / (fixed_s + processes * MEASURE_LEAST_S);
    if (rounds.count > affordable && !arguments->bench.processes)
        rounds.count = affordable > PROCESSES_LEAST ? (int)affordable : PROCESSES_LEAST;
    double each_s = (share_s / rounds.count - fixed_s) / (processes ? processes : 1);
    rounds.measure_s = each_s > MEASURE_LEAST_S ? each_s : MEASURE_LEAST_S;
    return rounds;
}

// One processor for both sides of a round.
static int choose_cpu(int round)
{
    static int cpus[CPUS_MAX], count = -1;
    if (count < 0)
        count = rb_affinity_list(cpus, CPUS_MAX);
    return count < 1 ? -1 : cpus[round % count];
}

static bool keep_sample(void *user, const struct rb_sample *sample)
{
    return sample->mismatch || rb_cell_add(user, sample);
}

static void run_process(struct rb_versus_session *session, struct rb_contest *contest, int side,
                        int round, double seconds, const char *path)
{
    struct rb_versus_side *one = &contest->side[side];
    struct rb_worker_words words = {.count = 0};
    struct rb_error error = {0}, told = {0};
    if (one->cell.state != RB_CELL_OPEN)
        return;
    rb_worker_word(&words, "%s", session->program);
    rb_worker_word(&words, "replay-worker");
    rb_worker_word(&words, "--variant=%s", one->row->name);
    rb_worker_word(&words, "--kernel=%s", rb_stage_names[contest->rays->rays.kernel]);
    rb_worker_word(&words, "--class=%s", rb_ray_class_names[contest->rays->rays.ray_class]);
    rb_worker_word(&words, "--bounce=%d", contest->rays->rays.bounce);
    rb_worker_word(&words, "--slice=%.4f", one->load_s + 2 * one->round_s + seconds);
    rb_worker_word(&words, "--threads=%d", contest->threads);
    rb_worker_word(&words, "--cpu=%d", contest->single ? -1 : choose_cpu(round));
    rb_worker_word(&words, "--process=%d", round);
    rb_worker_word(&words, "--");
    rb_worker_word(&words, "%s", path);
    enum rb_status status =
        rb_process_run(&words, false, sizeof(struct rb_sample), keep_sample, &one->cell, &error);
    if (status == RB_OK || rb_process_interrupted())
        return;
    one->cell.state = status == RB_INVALID ? RB_CELL_INVALID : RB_CELL_CRASHED;
    session->failed = true;
    rb_error_set(&told, status, "%s, %s, %s: %.200s", contest->scene, contest->rays_name,
                 one->row->name, error.text[0] ? error.text : "not as recorded");
    rb_report(status, &told);
}

void rb_versus_measure(struct rb_versus_session *session, struct rb_contest *contests, int scene,
                       const char *path)
{
    struct rounds rounds = plan_rounds(session, contests, scene);
    for (int round = 0; round < rounds.count; round++)
        for (int c = 0; c < session->scene_contests; c++)
            for (int turn = 0; turn < 2 && !rb_process_interrupted(); turn++) {
                if (!is_wanted(session, &contests[c]))
                    continue;
                rb_versus_tell(session, contests[c].scene, contests[c].rays_name);
                run_process(session, &contests[c], (turn + round) % 2, round, rounds.measure_s,
                            path);
            }
}
