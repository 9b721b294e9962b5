// The energy that the processor says it has taken: RAPL, through the perf events of the PMU
// `power`, else through the files of powercap. Packages and their memory, all sockets together.
//
// Both count since they were opened. The hardware updates its counters about every ms, so that a
// second is measured to 0.2 %. Wraps of powercap's counters are seen as long as a reading comes
// before the next one, some minutes of full power. Not thread-safe.
//
// Sources: Intel SDM volume 3, "Platform specific power management support"; Documentation/power/
// powercap and drivers of Linux. AMD does not say what belongs to its package.
#ifndef RB_ENERGY_METER_H
#define RB_ENERGY_METER_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum rb_energy_domain { RB_ENERGY_PACKAGE, RB_ENERGY_DRAM, RB_ENERGY_DOMAIN_COUNT };

enum { RB_METER_ZONES_MAX = 32 };

struct rb_meter {
    bool perf;                        // else powercap
    bool has[RB_ENERGY_DOMAIN_COUNT]; // at any socket
    int zone_count;
    struct rb_meter_zone {
        enum rb_energy_domain domain;
        int fd;          // of perf
        char path[1024]; // of powercap
        double joules_per_count;
        uint64_t range; // of powercap: where its counter begins again
        uint64_t last, counts;
    } zones[RB_METER_ZONES_MAX];
};

// `root` as in rb_machine_read: of a copy only files are read, so that is powercap. RB_FAILED, with
// one line on what is missing and how to get it.
enum rb_status rb_meter_open(struct rb_meter *meter, const char *root, struct rb_error *error);

// Joules since it was opened, of all domains together. RB_FAILED if a counter cannot be read any
// more.
enum rb_status rb_meter_read(struct rb_meter *meter, double *joules, struct rb_error *error);

void rb_meter_close(struct rb_meter *meter);

// "rapl:powercap package+dram", say.
void rb_meter_describe(const struct rb_meter *meter, char text[64]);

#endif
