// Counting events between laps, against a kernel that is made up here: what it answers to opening,
// reading and mapping is written down by each case.
#include "measure/events.h"
#include "measure/perf_event.h"
#include "tests/unit/tap.h"

#include <errno.h>
#include <string.h>

#ifdef __linux__
#include <linux/perf_event.h>

enum { FIRST_FD = 100 };

// The made-up kernel. Each read of a group advances its values by `step`, and its clocks.
static struct {
    int problem[RB_EVENTS_MAX]; // errno of opening the i-th event; 0: it opens
    int asked, opened, closed, mapped, unmapped, reads;
    int end_at;       // the read from which on the group has lost its counters; 0: never
    uint64_t running; // per mille of the time enabled
    uint64_t enabled_ns, running_ns;
    uint64_t value[RB_EVENTS_MAX], step[RB_EVENTS_MAX];
    bool user_space;
    struct perf_event_mmap_page page[RB_EVENTS_MAX];
    uint64_t raw; // what rdpmc gives next
    struct perf_event_attr attributes[RB_EVENTS_MAX];
    int group[RB_EVENTS_MAX];
} kernel;

static int fake_open(struct perf_event_attr *attributes, int pid, int cpu, int group)
{
    int i = kernel.asked++;
    kernel.attributes[i] = *attributes;
    kernel.group[i] = group;
    errno = kernel.problem[i];
    return kernel.problem[i] || pid != 0 || cpu != -1 ? -1 : FIRST_FD + kernel.opened++;
}

static int fake_enable(int fd)
{
    return fd == FIRST_FD ? 0 : -1;
}

static long fake_read(int fd, void *to, size_t bytes)
{
    uint64_t *words = to;
    size_t count = (size_t)kernel.opened;
    if (fd != FIRST_FD || bytes != (3 + count) * 8)
        return -1;
    if (kernel.end_at && ++kernel.reads >= kernel.end_at)
        return 0;
    kernel.enabled_ns += 1000000;
    kernel.running_ns += 1000 * kernel.running;
    words[0] = count;
    words[1] = kernel.enabled_ns;
    words[2] = kernel.running_ns;
    for (size_t i = 0; i < count; i++)
        words[3 + i] = kernel.value[i] += kernel.step[i];
    return (long)bytes;
}

static const void *fake_map(int fd)
{
    struct perf_event_mmap_page *page = &kernel.page[fd - FIRST_FD];
    kernel.mapped += kernel.user_space;
    return kernel.user_space ? page : NULL;
}

static void fake_unmap(const void *page)
{
    kernel.unmapped += page != NULL;
}

static uint64_t fake_counter(uint32_t counter)
{
    kernel.raw += 10;
    return (kernel.raw + counter) & 0xffffffffffff; // 48 bits wide
}

static void fake_close(int fd)
{
    kernel.closed += fd >= FIRST_FD;
}

static const struct rb_perf_system fake = {fake_open,  fake_enable,  fake_read, fake_map,
                                           fake_unmap, fake_counter, fake_close};

static struct rb_event_counter counter;

static void reset(void)
{
    memset(&kernel, 0, sizeof kernel);
    kernel.running = 1000;
    for (int i = 0; i < RB_EVENTS_MAX; i++)
        kernel.step[i] = 1;
}

static struct rb_event_group group_of(int count)
{
    struct rb_event_group group = {.count = count};
    for (int i = 0; i < count; i++)
        group.of[i] = (struct rb_event){.type = 4, .config = 0x3c + (uint64_t)i};
    return group;
}

static void open_group(int count)
{
    const struct rb_event_group group = group_of(count);
    rb_events_open(&counter, &group);
}

static void all_closed(const char *what)
{
    ok(kernel.closed == kernel.opened && kernel.unmapped == kernel.mapped,
       "%s: everything is closed", what);
}

static void counts(void)
{
    reset();
    kernel.step[1] = 7;
    open_group(2);
    ok(kernel.attributes[0].pinned && kernel.attributes[0].disabled &&
           !kernel.attributes[1].pinned && kernel.attributes[1].exclude_kernel &&
           kernel.attributes[1].config == 0x3d && kernel.group[0] == -1 &&
           kernel.group[1] == FIRST_FD,
       "a pinned leader, and the other in its group, of user mode");
    ok(counter.table.empty[0] == 1 && counter.table.empty[1] == 7 && counter.table.cost_ticks > 0,
       "a lap with nothing in it is measured");
    kernel.step[1] = 107;
    rb_events_lap(&counter, RB_STAGE_TRACE, 2);
    rb_events_lap(&counter, RB_STAGE_TRACE, 2);
    rb_events_lap(&counter, RB_STAGE_SHADE, 0);
    rb_events_close(&counter);
    ok(counter.table.count[RB_STAGE_TRACE][2][1] == 214 &&
           counter.table.laps[RB_STAGE_TRACE][2] == 2 &&
           counter.table.count[RB_STAGE_SHADE][0][1] == 107 &&
           counter.table.count[RB_STAGE_GENERATE][RB_BOUNCE_MAX - 1][1] == 0,
       "laps are booked where they belong, and those of the calibration nowhere");
    ok(counter.table.state[0] == RB_EVENT_COUNTED && counter.table.state[1] == RB_EVENT_COUNTED,
       "both have counted");
    all_closed("counted");
}

static void wraps(void)
{
    reset();
    kernel.value[0] = UINT64_MAX - 500;
    kernel.step[0] = 0;
    open_group(1);
    kernel.step[0] = 1000;
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    rb_events_close(&counter);
    ok(counter.table.count[RB_STAGE_TRACE][0][0] == 1000,
       "a count that wraps around is a difference like any other");
}

static void states(void)
{
    static const struct {
        int problem;
        enum rb_event_state state;
        const char *word;
    } cases[] = {
        {EACCES, RB_EVENT_FORBIDDEN, "perf_event_paranoid"},
        {EPERM, RB_EVENT_FORBIDDEN, "CAP_PERFMON"},
        {ENOENT, RB_EVENT_ABSENT, "absent"},
        {EOPNOTSUPP, RB_EVENT_ABSENT, "simulate"},
        {ENOSYS, RB_EVENT_NO_PERF, "filter"},
        {EINVAL, RB_EVENT_UNFIT, "another one"},
        {EMFILE, RB_EVENT_UNFIT, "group"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        reset();
        kernel.problem[1] = cases[i].problem;
        open_group(3);
        rb_events_lap(&counter, RB_STAGE_TRACE, 0);
        rb_events_close(&counter);
        ok(counter.table.state[1] == cases[i].state &&
               strstr(rb_event_state_text(cases[i].state), cases[i].word) &&
               counter.table.state[0] == RB_EVENT_COUNTED &&
               counter.table.state[2] == RB_EVENT_COUNTED &&
               counter.table.count[RB_STAGE_TRACE][0][1] == 0 &&
               counter.table.count[RB_STAGE_TRACE][0][2] == 1,
           "errno %d is told apart, and the others count: %s", cases[i].problem,
           rb_event_state_text(cases[i].state));
    }
    reset();
    kernel.problem[0] = ENOENT;
    open_group(2);
    ok(kernel.group[1] == -1 && kernel.attributes[1].pinned, "then the next event leads");
    rb_events_close(&counter);
    reset();
    kernel.problem[0] = kernel.problem[1] = EACCES;
    open_group(2);
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    rb_events_close(&counter);
    ok(counter.table.state[0] == RB_EVENT_FORBIDDEN && kernel.closed == 0,
       "nothing could be opened, and nothing happens");
}

static void schedules(void)
{
    reset();
    kernel.end_at = 1;
    open_group(2);
    ok(counter.table.state[1] == RB_EVENT_UNSCHEDULED, "the end of file at once: unscheduled");
    all_closed("unscheduled");
    reset();
    kernel.end_at = 50;
    open_group(2);
    ok(counter.table.state[0] == RB_EVENT_UNSCHEDULED, "while it is calibrated");
    reset();
    kernel.end_at = 104; // enabling, 100 laps, the beginning, one lap
    open_group(2);
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    rb_events_close(&counter);
    ok(counter.table.state[0] == RB_EVENT_UNSCHEDULED && kernel.closed == 2, "or later");
    reset();
    kernel.running = 0;
    open_group(2);
    rb_events_close(&counter);
    ok(counter.table.state[0] == RB_EVENT_UNSCHEDULED, "it never ran");
    reset();
    kernel.running = 500;
    open_group(2);
    rb_events_close(&counter);
    ok(counter.table.state[0] == RB_EVENT_MULTIPLEXED &&
           strstr(rb_event_state_text(RB_EVENT_MULTIPLEXED), "nmi_watchdog"),
       "it ran half of the time: multiplexed");
}

static void user_space(void)
{
    reset();
    kernel.user_space = true;
    for (int i = 0; i < 2; i++) {
        kernel.page[i].index = (uint32_t)i + 1;
        kernel.page[i].pmc_width = 48;
        kernel.page[i].offset = 1 << 20;
        kernel.page[i].cap_user_rdpmc = 1;
    }
    kernel.raw = 0xfffffffff000; // a counter that begins below 0, as the kernel sets it
    open_group(2);
#if defined(__x86_64__)
    ok(counter.table.in_user_space, "read by rdpmc where the kernel allows it");
    ok(counter.table.empty[0] == 20, "signed, 48 bits wide: 10 for each of two counters a lap");
    uint64_t before = counter.last[0];
    kernel.raw += 0x1000; // past 0
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    ok(counter.table.count[RB_STAGE_TRACE][0][0] == 0x1000 + 20 && counter.last[0] > before,
       "across 0");
    kernel.page[1].index = 0; // not on the processor at the moment
    kernel.value[0] = counter.last[0] + 4;
    rb_events_lap(&counter, RB_STAGE_TRACE, 1);
    ok(counter.table.count[RB_STAGE_TRACE][1][0] == 5, "an event without a counter: read(2)");
    rb_events_close(&counter);
    all_closed("rdpmc");
    reset();
    kernel.user_space = true; // mapped, but not allowed
    open_group(2);
    ok(!counter.table.in_user_space && kernel.mapped == kernel.unmapped, "read(2) otherwise");
    rb_events_close(&counter);
    kernel.opened = kernel.asked = 0;
    struct rb_event_group group = group_of(1);
    group.by_read = true;
    kernel.page[0] = (struct perf_event_mmap_page){.index = 1, .pmc_width = 48};
    kernel.page[0].cap_user_rdpmc = 1;
    rb_events_open(&counter, &group);
    ok(!counter.table.in_user_space, "and where rdpmc would give something else");
#endif
    rb_events_close(&counter);
}

static void adds(void)
{
    static struct rb_event_table sum, one, none;
    reset();
    open_group(2);
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    rb_events_close(&counter);
    one = counter.table;
    one.in_user_space = true;
    rb_event_table_add(&sum, &one);
    rb_event_table_add(&sum, &none);
    ok(sum.in_user_space && sum.count[RB_STAGE_TRACE][0][0] == 1, "a thread without work is none");
    one.state[1] = RB_EVENT_UNSCHEDULED;
    one.in_user_space = false;
    rb_event_table_add(&sum, &one);
    ok(sum.count[RB_STAGE_TRACE][0][0] == 2 && sum.laps[RB_STAGE_TRACE][0] == 2 &&
           sum.state[1] == RB_EVENT_UNSCHEDULED && !sum.in_user_space,
       "threads add up, and the worst state stands");
}

// The real kernel, with an event that it always has. A container may forbid even that.
static void real(void)
{
    struct rb_event_group group = {.count = 1, .of = {{.type = PERF_TYPE_SOFTWARE, .config = 1}}};
    rb_perf = &rb_perf_kernel;
    rb_events_open(&counter, &group);
    for (volatile int i = 0; i < 1000000; i++)
        ;
    rb_events_lap(&counter, RB_STAGE_TRACE, 0);
    rb_events_close(&counter);
    enum rb_event_state state = counter.table.state[0];
    note("task-clock: %s", rb_event_state_text(state));
    ok(state == RB_EVENT_COUNTED ? counter.table.count[RB_STAGE_TRACE][0][0] > 0
                                 : state != RB_EVENT_UNTRIED,
       "the real kernel counts, or says why not");
}

int main(void)
{
    rb_perf = &fake;
    counts();
    wraps();
    states();
    schedules();
    user_space();
    adds();
    real();
    return done();
}
#else
int main(void)
{
    ok(true, "# SKIP performance events are Linux's");
    return done();
}
#endif
