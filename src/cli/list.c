#include "cli/commands.h"
#include "embree/embree.h"

#include <stdio.h>
#include <string.h>

static int run(const struct rb_arguments *arguments);

static const struct rb_option options[] = {
    {"--json", NULL, RB_OPTION_FLAG, offsetof(struct rb_arguments, json), 0, 0,
     "as a JSON array of objects"},
    {.name = NULL},
};

const struct rb_command rb_command_list = {
    .name = "list",
    .summary = "list the variants or the scenes there are",
    .synopsis = "variants|scenes [--json]",
    .text = "Variants are ways to render the same image: rows of one table, from the reference to\n"
            "the fastest. Scenes are names that stand for generated files.",
    .positional_min = 1,
    .positional_max = 1,
    .groups = (const struct rb_option *const[]){options, NULL},
    .run = run,
};

// The strings printed here are our own and hold nothing that JSON would want escaped.
static void list_variants(bool json)
{
    if (json)
        printf("[\n");
    for (const struct rb_variant *v = rb_variants; v->name; v++) {
        bool available = rb_variant_available(v);
        const char *stands_for = available ? rb_variant_resolve(v)->name : v->name;
        if (json)
            printf("  {\"name\": \"%s\", \"available\": %s, \"needs\": \"%s\", \"baseline\": "
                   "\"%s\", \"exact\": %s, \"summary\": \"%s\", \"is\": \"%s\"}%s\n",
                   v->name, available ? "true" : "false", v->needs, v->baseline,
                   v->exact ? "true" : "false", v->summary, stands_for, v[1].name ? "," : "");
        else
            printf("%-18s %-12s %s", v->name, available ? "" : "unavailable", v->summary);
        if (!json && !available)
            printf("; needs %s", v->needs);
        if (!json && v->best_of && available)
            printf(": here %s", stands_for);
        if (!json && v->accelerator == RB_ACCEL_EMBREE && available)
            printf(": here libembree %s", rb_embree_version());
        if (!json)
            printf("\n");
    }
    if (json)
        printf("]\n");
    else
        printf("\nThe default is %s.\n", rb_variant_fastest()->name);
}

static void list_scenes(bool json)
{
    if (json)
        printf("[\n");
    for (const struct rb_preset *p = rb_presets; p->name; p++) {
        double objects = rb_generator_find(p->generator)->object_count(p->size);
        if (json)
            printf("  {\"name\": \"%s\", \"generator\": \"%s\", \"size\": %d, \"objects\": %.0f, "
                   "\"paper_s\": %g}%s\n",
                   p->name, p->generator, p->size, objects, p->paper_s, p[1].name ? "," : "");
        else
            printf("%-16s %s%d, %.0f objects; the 2019 report took %g s\n", p->name, p->generator,
                   p->size, objects, p->paper_s);
    }
    if (json) {
        printf("]\n");
        return;
    }
    for (const struct rb_generator *g = rb_generators; g->name; g++)
        printf("%sN%-*s %s, N from %d to %d\n", g->name, (int)(15 - strlen(g->name)), "",
               g->summary, g->size_min, g->size_max);
}

static int run(const struct rb_arguments *arguments)
{
    if (strcmp(arguments->positional[0], "variants") == 0) {
        list_variants(arguments->json);
    } else if (strcmp(arguments->positional[0], "scenes") == 0) {
        list_scenes(arguments->json);
    } else {
        struct rb_error error = {0};
        rb_error_set(&error, RB_INVALID, "list what? variants or scenes, not '%s'",
                     arguments->positional[0]);
        return rb_report(RB_INVALID, &error);
    }
    return 0;
}
