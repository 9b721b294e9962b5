// The dumps of callgrind, well-formed and not; the geometry of caches; the model; runs of tiles.
#include "base/memory.h"
#include "bench/run/tiles.h"
#include "bench/simulate/caches.h"
#include "bench/simulate/callgrind.h"
#include "tests/unit/tap.h"

#include <math.h>
#include <string.h>

#define HEAD   "# callgrind format\nversion: 1\ncreator: callgrind-3.19.0\ncmd:  raybench worker\n"
#define EVENTS "events: Ir Dr Dw I1mr D1mr D1mw ILmr DLmr DLmw Bc Bcm Bi Bim\n"
#define PART(label, totals)                                                                        \
    "\npart: 1\n\ndesc: I1 cache: 32768 B\ndesc: Trigger: Client Request: " label                  \
    "\n\npositions: line\n" EVENTS "summary: 9 9\n\nfn=(1) main\n16 9\n\ntotals: " totals "\n"
#define LAP(stage, bounce, rays, totals)                                                           \
    PART("stage=" stage " bounce=" bounce " rays=" rays, totals)
#define END PART("end hits=00000000deadbeef row=packet-avx2", "0")

static struct rb_simulated simulated;
static struct rb_error error;

static enum rb_status parse(const char *text)
{
    memset(&simulated, 0, sizeof simulated);
    memset(&error, 0, sizeof error);
    return rb_callgrind_parse(text, &simulated, &error);
}

static void well_formed(void)
{
    const char *text =
        HEAD LAP("1", "02", "0000000000000100", "1000 200 100 1 20 10 0 2 1 50 5 4 3")
            LAP("1", "02", "0000000000000010", "500 1") LAP("5", "00", "0000000000000000", "7") END
        "\npart: 5\ndesc: Trigger: Program termination\n" EVENTS "totals: 0\n";
    ok(parse(text) == RB_OK, "a record is read: %s", error.text);
    const struct rb_simulated_place *place = &simulated.place[RB_STAGE_TRACE][2];
    ok(place->rays == 0x110 && place->laps == 2, "laps of one place add up");
    ok(place->events[RB_SIM_IR] == 1500 && place->events[RB_SIM_DR] == 201, "so do their events");
    ok(place->events[RB_SIM_BIM] == 3, "the last column counts");
    ok(simulated.place[RB_STAGE_OTHER][0].events[RB_SIM_IR] == 7, "places are kept apart");
    ok(strcmp(simulated.simulator, "callgrind-3.19.0") == 0, "the simulator has a name");
    ok(simulated.hits_hash == 0xdeadbeef && strcmp(simulated.row, "packet-avx2") == 0,
       "the end has hash and row");
    struct rb_simulated_place all = rb_simulated_sum(&simulated, -1);
    ok(all.events[RB_SIM_IR] == 1507 && all.laps == 3, "everything together");
}

static void other_columns(void)
{
    ok(parse("desc: Trigger: Client Request: stage=0 bounce=1f rays=1\n"
             "events: Ge Bim Bi Bcm Bc DLmw DLmr ILmr D1mw D1mr I1mr Dw Dr Ir\n"
             "totals: 99 1 2 3 4 5 6 7 8 9 10 11 12 13\n" END) == RB_OK &&
           simulated.place[0][31].events[RB_SIM_IR] == 13 &&
           simulated.place[0][31].events[RB_SIM_BIM] == 1,
       "columns go by their names, and those we do not know are left alone");
}

static void malformed(void)
{
    static const struct {
        const char *what, *text;
    } cases[] = {
        {"nothing", ""},
        {"no dump", HEAD},
        {"a record without its end", HEAD LAP("1", "00", "01", "5")},
        {"a dump without totals", HEAD "desc: Trigger: Client Request: stage=1 bounce=0 rays=1\n"},
        {"a dump within a dump", "desc: Trigger: Client Request: stage=1 bounce=0 rays=1\n" END},
        {"laps behind the end", HEAD END LAP("1", "00", "01", "5")},
        {"a stage that is none", LAP("6", "00", "01", "5") END},
        {"a bounce that is none", LAP("1", "20", "01", "5") END},
        {"a number too large", LAP("1", "00", "10000000000000000", "5") END},
        {"a negative number", LAP("1", "00", "-1", "5") END},
        {"a label with more to it", LAP("1", "00", "01 x", "5") END},
        {"a label of another program", PART("hello", "5") END},
        {"an end without a row", PART("end hits=1", "0")},
        {"a row with a long name", PART("end hits=1 row=123456789012345678901234567890123", "0")},
        {"totals without numbers", LAP("1", "00", "01", "") END},
        {"totals that are no numbers", LAP("1", "00", "01", "5 x") END},
        {"negative totals", LAP("1", "00", "01", "-5") END},
        {"totals too large", LAP("1", "00", "01", "18446744073709551616") END},
        {"more totals than columns", LAP("1", "00", "01", "1 2 3 4 5 6 7 8 9 10 11 12 13 14") END},
        {"totals before columns", "totals: 5\n" END},
        {"a missing column", "events: Ir Dr Dw\n" END},
        {"a column twice", "events: Ir Ir Dr Dw I1mr D1mr D1mw ILmr DLmr DLmw Bc Bcm Bi Bim\n" END},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        ok(parse(cases[i].text) == RB_FAILED && error.text[0], "%s: %s", cases[i].what, error.text);
    parse("events: Ir\n");
    ok(error.line == 1, "a mistake has its line");
}

// Every beginning of a record and every damaged byte: no crash, and no whole record but the whole.
static void damaged(void)
{
    static const char whole[] = HEAD LAP("1", "02", "01", "10 2") LAP("3", "00", "02", "7") END;
    char text[sizeof whole];
    int accepted = 0;
    for (size_t length = 0; length + sizeof "0\n" <= sizeof whole; length++) {
        memcpy(text, whole, length);
        text[length] = '\0';
        accepted += parse(text) == RB_OK;
    }
    ok(accepted == 0, "a record that is cut short is refused, wherever it was cut");
    for (size_t at = 0; at + 1 < sizeof whole; at++)
        for (int change = 1; change < 256; change <<= 1) {
            memcpy(text, whole, sizeof whole);
            text[at] = (char)(text[at] ^ change);
            enum rb_status status = parse(text);
            accepted += status != RB_OK && !error.text[0];
        }
    ok(accepted == 0, "a damaged record is refused with a reason, if it is refused");
}

static void long_lines(void)
{
    static char text[8192];
    memset(text, 'x', 4000);
    strcpy(text + 4000, "\n" LAP("1", "02", "01", "10 2") END);
    ok(parse(text) == RB_OK, "lines of any length");
}

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fabs(b);
}

static void model(void)
{
    const struct rb_simulated_place place = {
        .rays = 10,
        .laps = 1,
        .events = {[RB_SIM_IR] = 1000,
                   [RB_SIM_I1MR] = 3,
                   [RB_SIM_D1MR] = 20,
                   [RB_SIM_D1MW] = 10,
                   [RB_SIM_ILMR] = 1,
                   [RB_SIM_DLMR] = 4,
                   [RB_SIM_DLMW] = 2,
                   [RB_SIM_BCM] = 5,
                   [RB_SIM_BIM] = 2},
    };
    struct rb_simulated_figures figures = rb_simulated_figures(&place);
    double cycles = 1000 + 10 * (5 + 2) + 10 * (3 + 20 + 10) + 100 * (1 + 4 + 2);
    ok(near(figures.cycles, cycles / 10), "cycles are Ir + 10 Bm + 10 L1m + 100 LLm");
    ok(near(figures.instructions, 100) && near(figures.l1_misses, 3) &&
           near(figures.ll_misses, 0.7) && near(figures.branch_misses, 0.7),
       "events per ray");
    ok(near(figures.compute_pct + figures.memory_stall_pct + figures.other_pct, 100),
       "the categories add up to all cycles");
    ok(near(figures.memory_stall_pct, 100.0 * (300 + 600) / cycles), "memory stalls are of data");
    struct rb_simulated_place none = {.events = {[RB_SIM_IR] = 5}};
    figures = rb_simulated_figures(&none);
    ok(isnan(figures.instructions) && isnan(figures.cycles) && near(figures.compute_pct, 100),
       "without rays nothing is per ray");
    none.events[RB_SIM_IR] = 0;
    ok(isnan(rb_simulated_figures(&none).compute_pct), "and without cycles nothing is a share");
}

static void caches(void)
{
    static const struct {
        const char *text;
        uint64_t bytes;
        uint32_t ways, line_bytes;
        bool rounded;
    } good[] = {
        {"32K,8", 32768, 8, 64, false},     {"1M,16,128", 1 << 20, 16, 128, false},
        {"49152,12", 49152, 12, 64, false}, {"30M,20", 30 << 20, 30, 64, true},      // 24576 sets
        {"1000,1", 512, 1, 64, true},       {"64K,1024,64", 65536, 1024, 64, false}, // one set
    };
    static const char *const bad[] = {
        "",         "32K",         "32K,",       "32K,0",   "0,8",      "32K,8,",
        "32K,8,48", "32K,8,8",     "32K,8,64,1", "-32K,8",  "32Q,8",    "64,2",
        "64,1",     "32K,1000000", "9999M,8",    "32K 8",   " 32K,8",   "32K,8x",
        "1e3,8",    "nan,8",       "32K,8,0",    "32K,nan", "32K,8,8M", "999999999999M,8"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct rb_caches chosen;
        enum rb_status status =
            rb_caches_choose("/nonexistent", good[i].text, "1M,16", &chosen, &error);
        ok(status == RB_OK && chosen.l1d.bytes == good[i].bytes &&
               chosen.l1d.ways == good[i].ways && chosen.l1d.line_bytes == good[i].line_bytes &&
               chosen.l1d.rounded == good[i].rounded,
           "cache %s", good[i].text);
    }
    int refused = 0;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct rb_caches chosen;
        enum rb_status status = rb_caches_choose("/nonexistent", "32K,8", bad[i], &chosen, &error);
        refused += status == RB_INVALID;
        if (status != RB_INVALID)
            note("'%s' is taken for a cache", bad[i]);
    }
    ok(refused == sizeof bad / sizeof *bad, "what is no cache is refused");
    struct rb_caches chosen;
    ok(rb_caches_choose("/nonexistent", "32K,8", NULL, &chosen, &error) == RB_FAILED,
       "a machine that does not tell its caches: %s", error.text);
}

// Are the first half of the tiles different from each other, of the image, and like the second?
static bool are_runs(const struct rb_run_options *how, uint32_t all, uint32_t count)
{
    static uint8_t seen[4096];
    bool right = how->tile_count == 2 * count && how->simulate_from == count;
    memset(seen, 0, sizeof seen);
    for (uint32_t i = 0; i < count && right; i++) {
        right = how->tiles[i] < all && how->tiles[i] == how->tiles[i + count];
        right = right && !seen[how->tiles[i]]++;
    }
    return right;
}

static void runs(void)
{
    int wrong = 0;
    struct rb_tiles tiles;
    struct rb_run_options how = {0};
    for (uint32_t all = 1; all < 70; all++)
        for (uint32_t count = 1; count <= all; count++)
            for (uint64_t seed = 0; seed < 4; seed++) {
                wrong += rb_tiles_runs(&tiles, all, count, seed, &how, &error) != RB_OK ||
                         !are_runs(&how, all, count);
                rb_free(tiles.order);
            }
    ok(wrong == 0, "runs have as many tiles as asked for, all different, twice");
    rb_tiles_runs(&tiles, 1024, 9, 1, &how, &error);
    ok(how.tiles[1] == how.tiles[0] + 1 && how.tiles[2] == how.tiles[0] + 2 &&
           how.tiles[3] > how.tiles[2],
       "nine tiles are three runs of three");
    ok(how.tiles[0] < 342 && how.tiles[8] >= 682, "spread over the image");
    rb_free(tiles.order);
    rb_tiles_runs(&tiles, 4, 100, 1, &how, &error);
    ok(are_runs(&how, 4, 4), "and never more than there are");
    rb_free(tiles.order);
    rb_memory_fail_at(1);
    ok(rb_tiles_runs(&tiles, 4, 4, 1, &how, &error) == RB_FAILED, "no memory for them");
}

int main(void)
{
    well_formed();
    other_columns();
    malformed();
    damaged();
    long_lines();
    model();
    caches();
    runs();
    return done();
}
