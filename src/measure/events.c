#include "measure/events.h"

#include "measure/perf_event.h"

#include <errno.h>
#include <string.h>

static const char *const texts[RB_EVENT_STATE_COUNT] = {
    [RB_EVENT_UNTRIED] = "not tried",
    [RB_EVENT_COUNTED] = "counted",
    [RB_EVENT_MULTIPLEXED] = "multiplexed: others use the counters as well; stop them (perf top, "
                             "other profilers), or sudo sysctl kernel.nmi_watchdog=0",
    [RB_EVENT_UNSCHEDULED] = "unscheduled: it opens but gets no counter; sudo sysctl "
                             "kernel.nmi_watchdog=0, or put fewer events into the group",
    [RB_EVENT_UNFIT] = "unfit: the kernel refuses it in this group; put it into another one",
    [RB_EVENT_ABSENT] = "absent: this processor or virtual machine does not count it; run on "
                        "hardware, or simulate",
    [RB_EVENT_FORBIDDEN] = "forbidden: sudo sysctl kernel.perf_event_paranoid=1, or give a "
                           "container CAP_PERFMON",
    [RB_EVENT_NO_PERF] = "no perf_event_open: the kernel lacks it, or a container's filter hides "
                         "it (docker: --security-opt seccomp=unconfined)",
};

const char *rb_event_state_text(enum rb_event_state state)
{
    return texts[state];
}

enum rb_event_state rb_event_state_of(int problem)
{
    static const struct {
        int problem;
        enum rb_event_state state;
    } states[] = {
        {EACCES, RB_EVENT_FORBIDDEN}, {EPERM, RB_EVENT_FORBIDDEN}, {ENOENT, RB_EVENT_ABSENT},
        {ENODEV, RB_EVENT_ABSENT},    {ENXIO, RB_EVENT_ABSENT},    {EOPNOTSUPP, RB_EVENT_ABSENT},
        {ENOSYS, RB_EVENT_NO_PERF},
    };
    for (size_t i = 0; i < sizeof states / sizeof *states; i++)
        if (states[i].problem == problem)
            return states[i].state;
    return RB_EVENT_UNFIT;
}

void rb_event_table_add(struct rb_event_table *to, const struct rb_event_table *from)
{
    bool first = to->state[0] == RB_EVENT_UNTRIED;
    if (from->state[0] == RB_EVENT_UNTRIED) // of a thread that took no part
        return;
    for (int stage = 0; stage < RB_STAGE_COUNT; stage++)
        for (int bounce = 0; bounce < RB_BOUNCE_MAX; bounce++) {
            to->laps[stage][bounce] += from->laps[stage][bounce];
            for (int i = 0; i < RB_EVENTS_MAX; i++)
                to->count[stage][bounce][i] += from->count[stage][bounce][i];
        }
    for (int i = 0; i < RB_EVENTS_MAX; i++) {
        to->state[i] = to->state[i] > from->state[i] ? to->state[i] : from->state[i];
        to->empty[i] = to->empty[i] > from->empty[i] ? to->empty[i] : from->empty[i];
    }
    to->in_user_space = from->in_user_space && (first || to->in_user_space);
    to->cost_ticks = to->cost_ticks > from->cost_ticks ? to->cost_ticks : from->cost_ticks;
}

#ifdef __linux__
#include <linux/perf_event.h>

// What read(2) gives of a group.
struct reading {
    uint64_t count, enabled, running;
    uint64_t values[RB_EVENTS_MAX];
};

static int open_counter(const struct rb_event *counter, int leader)
{
    struct perf_event_attr attributes = {
        .type = counter->type,
        .config = counter->config,
        .config1 = counter->config1,
        .config2 = counter->config2,
        .disabled = leader < 0,
        .pinned = leader < 0,
        .exclude_kernel = !counter->kernel,
        .exclude_hv = 1,
        .read_format =
            PERF_FORMAT_GROUP | PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING,
    };
    return rb_perf->open(&attributes, 0, -1, leader);
}

// Lets go of all events, which are then in this state.
static void give_up(struct rb_event_counter *counter, enum rb_event_state state)
{
    for (int i = 0; i < counter->count; i++) {
        counter->table.state[counter->index[i]] = state;
        if (counter->page[i])
            rb_perf->unmap(counter->page[i]);
        rb_perf->close(counter->fd[i]);
    }
    counter->count = 0;
}

// A pinned group that has lost its counters reads as the end of a file.
static bool read_group(struct rb_event_counter *counter, struct reading *reading)
{
    size_t bytes = (3 + (size_t)counter->count) * sizeof(uint64_t);
    return rb_perf->read(counter->fd[0], reading, bytes) == (long)bytes &&
           reading->count == (uint64_t)counter->count;
}

// One event in user space, as perf_event.h of the kernel describes it: `lock` changes while the
// page does. False while the event has no counter, which read(2) can still answer.
static bool read_page(const void *mapped, uint64_t *value)
{
    const volatile struct perf_event_mmap_page *page = mapped;
    uint32_t lock, index;
    do {
        lock = page->lock;
        __atomic_signal_fence(__ATOMIC_SEQ_CST);
        index = page->index;
        if (index == 0 || !page->cap_user_rdpmc || page->pmc_width == 0)
            return false;
        int unused_bits = 64 - page->pmc_width;
        uint64_t raw = rb_perf->read_counter(index - 1) << unused_bits;
        *value = (uint64_t)page->offset + (uint64_t)((int64_t)raw >> unused_bits);
        __atomic_signal_fence(__ATOMIC_SEQ_CST);
    } while (page->lock != lock);
    return true;
}

static bool read_values(struct rb_event_counter *counter, uint64_t *values)
{
    struct reading reading;
    bool done = counter->table.in_user_space;
    for (int i = 0; i < counter->count && done; i++)
        done = read_page(counter->page[i], &values[i]);
    if (done)
        return true;
    if (!read_group(counter, &reading))
        return false;
    memcpy(values, reading.values, (size_t)counter->count * sizeof *values);
    return true;
}

// Maps all events, or none.
static void map_pages(struct rb_event_counter *counter, bool wanted)
{
    uint64_t value;
    bool all = wanted && counter->count > 0;
#if !defined(__x86_64__)
    all = false; // AArch64 wants its counters asked for in another way
#endif
    for (int i = 0; i < counter->count && all; i++) {
        counter->page[i] = rb_perf->map(counter->fd[i]);
        all = counter->page[i] && read_page(counter->page[i], &value);
    }
    for (int i = 0; i < counter->count && !all; i++) {
        if (counter->page[i])
            rb_perf->unmap(counter->page[i]);
        counter->page[i] = NULL;
    }
    counter->table.in_user_space = all;
}

// The least of 100 laps with nothing in them. They are booked where nothing else is, and forgotten.
static void calibrate(struct rb_event_counter *counter)
{
    struct rb_event_table *table = &counter->table;
    uint64_t *count = table->count[RB_STAGE_GENERATE][RB_BOUNCE_MAX - 1];
    table->cost_ticks = UINT64_MAX;
    memset(table->empty, 0xff, sizeof table->empty);
    for (int run = 0; run < 100 && counter->count; run++) {
        memset(count, 0, sizeof table->empty);
        uint64_t start = rb_clock_ticks();
        rb_events_lap(counter, RB_STAGE_GENERATE, RB_BOUNCE_MAX - 1);
        uint64_t ticks = rb_clock_ticks() - start;
        table->cost_ticks = ticks < table->cost_ticks ? ticks : table->cost_ticks;
        for (int i = 0; i < RB_EVENTS_MAX; i++)
            table->empty[i] = count[i] < table->empty[i] ? count[i] : table->empty[i];
    }
    memset(count, 0, sizeof table->empty);
    table->laps[RB_STAGE_GENERATE][RB_BOUNCE_MAX - 1] = 0;
}

void rb_events_open(struct rb_event_counter *counter, const struct rb_event_group *group)
{
    struct reading reading;
    *counter = (struct rb_event_counter){.count = 0};
    for (int i = 0; i < group->count; i++) {
        int fd = open_counter(&group->of[i], counter->count ? counter->fd[0] : -1);
        counter->table.state[i] = fd < 0 ? rb_event_state_of(errno) : RB_EVENT_COUNTED;
        if (fd < 0)
            continue;
        counter->index[counter->count] = i;
        counter->fd[counter->count++] = fd;
    }
    if (counter->count == 0)
        return;
    if (rb_perf->enable(counter->fd[0]) < 0 || !read_group(counter, &reading)) {
        give_up(counter, RB_EVENT_UNSCHEDULED);
        return;
    }
    counter->enabled = reading.enabled;
    counter->running = reading.running;
    map_pages(counter, !group->by_read);
    calibrate(counter);
    if (counter->count && !read_values(counter, counter->last))
        give_up(counter, RB_EVENT_UNSCHEDULED);
}

void rb_events_lap(struct rb_event_counter *counter, enum rb_stage stage, int bounce)
{
    uint64_t values[RB_EVENTS_MAX];
    uint64_t *count = counter->table.count[stage][bounce];
    if (counter->count == 0)
        return;
    if (!read_values(counter, values)) {
        give_up(counter, RB_EVENT_UNSCHEDULED);
        return;
    }
    counter->table.laps[stage][bounce]++;
    for (int i = 0; i < counter->count; i++) {
        count[counter->index[i]] += values[i] - counter->last[i];
        counter->last[i] = values[i];
    }
}

// A group that ran for all but a thousandth of the time has run all the time: its two clocks are
// not stopped at the very same moment.
void rb_events_close(struct rb_event_counter *counter)
{
    struct reading reading;
    if (counter->count == 0)
        return;
    enum rb_event_state state = RB_EVENT_UNSCHEDULED;
    if (read_group(counter, &reading) && reading.running > counter->running) {
        uint64_t enabled = reading.enabled - counter->enabled;
        uint64_t running = reading.running - counter->running;
        state = running < enabled - enabled / 1000 ? RB_EVENT_MULTIPLEXED : RB_EVENT_COUNTED;
    }
    give_up(counter, state);
}
#else
void rb_events_open(struct rb_event_counter *counter, const struct rb_event_group *group)
{
    *counter = (struct rb_event_counter){.count = 0};
    for (int i = 0; i < group->count; i++)
        counter->table.state[i] = RB_EVENT_NO_PERF;
}

void rb_events_lap(struct rb_event_counter *counter, enum rb_stage stage, int bounce)
{
    (void)counter, (void)stage, (void)bounce;
}

void rb_events_close(struct rb_event_counter *counter)
{
    (void)counter;
}
#endif
