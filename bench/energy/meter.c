#define _POSIX_C_SOURCE 200809L
#include "bench/energy/meter.h"

#include "bench/machine/machine_read.h"
#include "measure/events.h"
#include "measure/perf_event.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POWER    "/sys/bus/event_source/devices/power"
#define POWERCAP "/sys/class/powercap"

enum { SOCKETS_MAX = 16, PARTS_MAX = 8 };

// NULL if there is no room.
static struct rb_meter_zone *add_zone(struct rb_meter *meter, enum rb_energy_domain domain)
{
    if (meter->zone_count == RB_METER_ZONES_MAX)
        return NULL;
    struct rb_meter_zone *zone = &meter->zones[meter->zone_count++];
    *zone = (struct rb_meter_zone){.domain = domain, .fd = -1};
    return zone;
}

#ifdef __linux__
#include <linux/perf_event.h>

// Event `name` on every processor that stands for a socket; why not goes to `reason`.
static bool open_event(struct rb_meter *meter, enum rb_energy_domain domain, const char *name,
                       char reason[192])
{
    char path[128], event[64], cpus[256];
    double type, scale;
    int first, last;
    snprintf(path, sizeof path, POWER "/events/%s", name);
    rb_machine_line("", path, event, sizeof event);
    snprintf(path, sizeof path, POWER "/events/%s.scale", name);
    rb_machine_line("", POWER "/cpumask", cpus, sizeof cpus);
    if (!rb_machine_number("", POWER "/type", &type) || strncmp(event, "event=", 6) != 0 ||
        !rb_machine_number("", path, &scale)) {
        snprintf(reason, 192, "no %s in " POWER, name);
        return false;
    }
    for (const char *list = cpus; rb_machine_next_range(&list, &first, &last);)
        for (int cpu = first; cpu <= last; cpu++) {
            struct perf_event_attr attributes = {.type = (uint32_t)type,
                                                 .config = strtoull(event + 6, NULL, 0)};
            int fd = rb_perf->open(&attributes, -1, cpu, -1);
            struct rb_meter_zone *zone = fd < 0 ? NULL : add_zone(meter, domain);
            if (!zone) {
                snprintf(reason, 192, "%s",
                         fd < 0 ? rb_event_state_text(rb_event_state_of(errno)) : "many sockets");
                return false;
            }
            zone->fd = fd;
            zone->joules_per_count = scale;
        }
    return meter->zone_count > 0;
}

static bool open_perf(struct rb_meter *meter, char reason[192])
{
    char ignored[192];
    meter->perf = true;
    if (!open_event(meter, RB_ENERGY_PACKAGE, "energy-pkg", reason)) {
        rb_meter_close(meter);
        return false;
    }
    open_event(meter, RB_ENERGY_DRAM, "energy-ram", ignored); // servers have it
    return true;
}
#else
static bool open_perf(struct rb_meter *meter, char reason[192])
{
    (void)meter;
    snprintf(reason, 192, "perf events are Linux's");
    return false;
}
#endif

static bool read_file(const struct rb_meter_zone *zone, const char *name, uint64_t *value)
{
    char path[1100], line[64], *end;
    snprintf(path, sizeof path, "%s/%s", zone->path, name);
    if (!rb_machine_line("", path, line, sizeof line))
        return false;
    *value = strtoull(line, &end, 10);
    return end != line && *end == '\0';
}

// A zone of powercap, if its name says that it is of one of our domains: "package-0", "dram". A
// package can be a zone of a zone; core and uncore are parts of packages, psys is more than them.
static void add_powercap(struct rb_meter *meter, const char *root, const char *name,
                         char reason[192])
{
    char path[512], domain[64];
    snprintf(path, sizeof path, POWERCAP "/%s/name", name);
    if (!rb_machine_line(root, path, domain, sizeof domain))
        return;
    bool package = strncmp(domain, "package", 7) == 0;
    if (!package && strcmp(domain, "dram") != 0)
        return;
    struct rb_meter_zone *zone = add_zone(meter, package ? RB_ENERGY_PACKAGE : RB_ENERGY_DRAM);
    uint64_t now;
    if (!zone)
        return;
    snprintf(zone->path, sizeof zone->path, "%.500s" POWERCAP "/%s", root, name);
    zone->joules_per_count = 1e-6;
    if (!read_file(zone, "energy_uj", &now) ||
        !read_file(zone, "max_energy_range_uj", &zone->range)) {
        snprintf(reason, 192,
                 "%.20s/energy_uj is not readable for this user; sudo chmod a+r " POWERCAP
                 "/intel-rapl:*/energy_uj",
                 name);
        meter->zone_count--;
    }
}

// AMD's zones are called intel-rapl as well.
static bool open_powercap(struct rb_meter *meter, const char *root, char reason[192])
{
    char name[64];
    snprintf(reason, 192, "no zone in " POWERCAP);
    meter->perf = false;
    for (int socket = 0; socket < SOCKETS_MAX; socket++) {
        snprintf(name, sizeof name, "intel-rapl:%d", socket);
        add_powercap(meter, root, name, reason);
        for (int part = 0; part < PARTS_MAX; part++) {
            snprintf(name, sizeof name, "intel-rapl:%d:%d", socket, part);
            add_powercap(meter, root, name, reason);
        }
    }
    bool package = false;
    for (int i = 0; i < meter->zone_count; i++)
        package |= meter->zones[i].domain == RB_ENERGY_PACKAGE;
    return package;
}

// What a zone counts now.
static bool read_zone(const struct rb_meter *meter, const struct rb_meter_zone *zone,
                      uint64_t *value)
{
    if (meter->perf)
        return rb_perf->read(zone->fd, value, sizeof *value) == (long)sizeof *value;
    return read_file(zone, "energy_uj", value);
}

enum rb_status rb_meter_open(struct rb_meter *meter, const char *root, struct rb_error *error)
{
    char perf[192] = "not tried: a copy of a machine", powercap[192] = "";
    *meter = (struct rb_meter){.perf = false};
    if ((root[0] || !open_perf(meter, perf)) && !open_powercap(meter, root, powercap))
        return rb_error_set(error, RB_FAILED,
                            "no energy can be measured (perf: %.130s; powercap: %.180s)", perf,
                            powercap);
    for (int i = 0; i < meter->zone_count; i++) {
        meter->has[meter->zones[i].domain] = true;
        if (!read_zone(meter, &meter->zones[i], &meter->zones[i].last)) {
            rb_meter_close(meter);
            return rb_error_set(error, RB_FAILED, "a counter of energy cannot be read");
        }
    }
    return RB_OK;
}

enum rb_status rb_meter_read(struct rb_meter *meter, double *joules, struct rb_error *error)
{
    *joules = 0;
    for (int i = 0; i < meter->zone_count; i++) {
        struct rb_meter_zone *zone = &meter->zones[i];
        uint64_t now;
        if (!read_zone(meter, zone, &now))
            return rb_error_set(error, RB_FAILED, "a counter of energy cannot be read any more: %s",
                                meter->perf ? "the PMU power" : zone->path);
        // Perf's are 64 bits wide and do not wrap.
        zone->counts += now >= zone->last ? now - zone->last : now + zone->range - zone->last;
        zone->last = now;
        *joules += (double)zone->counts * zone->joules_per_count;
    }
    return RB_OK;
}

void rb_meter_close(struct rb_meter *meter)
{
    for (int i = 0; i < meter->zone_count && meter->perf; i++)
        rb_perf->close(meter->zones[i].fd);
    meter->zone_count = 0;
}

void rb_meter_describe(const struct rb_meter *meter, char text[64])
{
    snprintf(text, 64, "rapl:%s package%s", meter->perf ? "perf" : "powercap",
             meter->has[RB_ENERGY_DRAM] ? "+dram" : "");
}
