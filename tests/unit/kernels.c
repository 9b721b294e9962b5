// Every kernel of every row against the reference, bit for bit, on random inputs and on those that
// are meant to break it: after FFmpeg's checkasm.
//
//   kernels [RAYS [SEED [BATCH]]]
//
// A batch is made from the seed and its number alone: a failure names both, and BATCH repeats that
// one. It goes through all five kernels: pixels are generated; rays are traced; what they hit, and
// hits nobody would expect, become surfaces and secondary rays; surfaces are lit; the shadow rays,
// or others along the rays, are decided. All queues end at guard pages (tests/support/guard.h), and
// two of three batches have 0 to 33 rays. Every row traces RAYS (800 000, about 3 s); memory does
// not depend on it.
#include "base/hash.h"
#include "render/variants.h"
#include "tests/support/inputs.h"
#include "tests/support/zoo.h"
#include "tests/unit/tap.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 32, SHOWN_MAX = 12, QUEUE_MAX = INPUT_MAX + 64 };
enum { PATTERN = 0xa5 }; // in outputs before a kernel runs
enum kernel { GENERATE, TRACE, SURFACE, LIGHT, TRACE_SHADOW, KERNEL_COUNT };

static const char *const kernel_names[] = {"generate", "trace", "surface", "light", "trace_shadow"};

// A distinct kernel set of the table.
static struct row {
    const char *name;
    const struct rb_kernels *kernels;
    uint64_t checked[KERNEL_COUNT], wrong[KERNEL_COUNT]; // elements of inputs; calls
} rows[ROWS_MAX];
static int row_count;

static struct zoo_scene scenes[ZOO_COUNT];

// What the kernels read.
static struct {
    struct rb_world world;
    struct rb_shading shading;
    struct rb_light_sample sample;
    struct rb_view view;
    struct rb_span span;
    struct queue rays, hits, surfaces, shadows;
    bool last;              // no secondary rays
    uint32_t before, spare; // elements of outputs before and behind what the kernel may append
    enum queue_padding padding;
} input;

// What they write: the reference and the row under test.
static struct output {
    struct queue camera, hits, surfaces, reflected, refracted, lit, shadows;
    struct guard film_memory;
    struct rb_film film;
} expected, got;

// What is being done, for whoever has to report it.
static struct {
    uint64_t seed, batch;
    const char *row, *kernel, *scene, *class;
} now;

static void print_now(void)
{
    printf("# %s, %s: seed %llu, batch %llu: scene %s, rays %s, %u of them\n", now.row, now.kernel,
           (unsigned long long)now.seed, (unsigned long long)now.batch, now.scene, now.class,
           input.rays.rays.count);
}

// Calls one kernel of a set.
static void call(enum kernel kernel, const struct rb_kernels *set, struct output *out)
{
    const struct rb_rays *rays = &input.rays.rays;
    const struct rb_surfaces *surfaces = &input.surfaces.surfaces;
    switch (kernel) {
    case GENERATE:
        set->generate(&input.view, &input.span, &out->camera.rays);
        break;
    case TRACE:
        set->trace(&input.world, rays, &out->hits.hits);
        break;
    case SURFACE:
        set->surface(&input.world, &input.shading, rays, &input.hits.hits, &out->surfaces.surfaces,
                     input.last ? NULL : &out->reflected.rays,
                     input.last ? NULL : &out->refracted.rays, &out->film);
        break;
    case LIGHT:
        set->light(&input.world, &input.shading, surfaces, &input.sample, &out->lit.shadows);
        break;
    default:
        set->trace_shadow(&input.world, &out->shadows.shadows);
        break;
    }
}

// The queues a kernel writes, all in the same order; returns how many.
static int outputs_of(enum kernel kernel, struct output *out, struct queue *queues[3])
{
    static const int counts[] = {1, 1, 3, 1, 1};
    queues[0] = kernel == GENERATE  ? &out->camera
                : kernel == TRACE   ? &out->hits
                : kernel == SURFACE ? &out->surfaces
                : kernel == LIGHT   ? &out->lit
                                    : &out->shadows;
    queues[1] = &out->reflected;
    queues[2] = &out->refracted;
    return counts[kernel];
}

// What element i of output number `which` was made from: the ray, for a light kernel the surface.
static void print_source(enum kernel kernel, int which, const struct queue *queue, uint32_t i)
{
    if (kernel == GENERATE)
        printf("#   span {%d, %d, %d, %d, %u} of %d x %d pixels, aa %u\n", input.span.x0,
               input.span.y0, input.span.x1, input.span.y1, input.span.sample, input.view.width,
               input.view.height, input.view.aa);
    uint32_t ray = i;
    if (kernel == SURFACE && i < queue->room)
        ray = which ? queue->rays.path[i] / 2 % INPUT_MAX : queue->surfaces.path[i] % INPUT_MAX;
    if (kernel == LIGHT && i < queue->room)
        ray = queue->shadows.pixel[i] % INPUT_MAX;
    if (kernel == TRACE || kernel == SURFACE) {
        printf("#   ray %u: ", ray);
        queue_print(stdout, &input.rays, ray);
        printf("\n");
    }
    if (kernel == SURFACE || kernel == LIGHT) {
        printf("#   %s %u: ", kernel == SURFACE ? "hit" : "surface", ray);
        queue_print(stdout, kernel == SURFACE ? &input.hits : &input.surfaces, ray);
        printf("\n");
    }
}

static bool show(struct row *row, enum kernel kernel)
{
    if (row->wrong[kernel] >= SHOWN_MAX)
        return false;
    print_now();
    return true;
}

// Output number `which` of a kernel; false if it is not as expected.
static bool check_queue(struct row *row, enum kernel kernel, int which, const struct queue *a,
                        const struct queue *b)
{
    long element;
    const char *array = queue_trespass(b, &element);
    if (array && show(row, kernel))
        printf("#   output %d: writes %s[%ld], may write from %u to %u rounded up\n", which, array,
               element, b->before, b->promised);
    uint32_t i = queue_difference(a, b);
    if (i != RB_NONE && show(row, kernel)) {
        printf("#   output %d, element %u of %u and %u\n", which, i, queue_count(a),
               queue_count(b));
        print_source(kernel, which, i < queue_count(a) ? a : b, i);
        printf("#   expected: ");
        queue_print(stdout, a, i);
        printf("\n#   got:      ");
        queue_print(stdout, b, i);
        printf("\n");
    }
    return !array && i == RB_NONE;
}

static bool check_film(struct row *row)
{
    for (size_t i = 0; i < 3 * FILM_PIXELS; i++) {
        uint64_t a = expected.film.rgb[i], b = got.film.rgb[i];
        if (a == b)
            continue;
        if (!show(row, SURFACE))
            return false;
        printf("#   film, component %d of pixel %u: expected %#llx, got %#llx\n", (int)(i % 3),
               (unsigned)(i / 3), (unsigned long long)a, (unsigned long long)b);
        for (uint32_t ray = 0; ray < input.rays.rays.count; ray++)
            if (input.rays.rays.pixel[ray] == i / 3)
                print_source(SURFACE, 0, &(struct queue){.room = 0}, ray);
        return false;
    }
    return true;
}

static void clear_film(struct output *out)
{
    memset(out->film.rgb, 0, 3 * FILM_PIXELS * sizeof *out->film.rgb);
}

// Makes the outputs ready for a kernel that is given `count` elements.
static void prepare(enum kernel kernel, struct output *out, uint32_t count)
{
    struct queue *queues[3];
    int queue_count = outputs_of(kernel, out, queues);
    bool appends = kernel != TRACE && kernel != TRACE_SHADOW;
    for (int k = 0; k < queue_count; k++)
        queue_place(queues[k], appends ? input.before : 0, count, input.spare, PATTERN);
    if (kernel == SURFACE)
        clear_film(out);
    if (kernel == TRACE_SHADOW) {
        queue_copy(&out->shadows, 0, &input.shadows, 0, count);
        queue_set_count(&out->shadows, count);
        queue_pad(&out->shadows, input.padding);
    }
}

// One kernel of the reference, which is the first row, then of the others.
static void check_kernel(enum kernel kernel, uint32_t count)
{
    struct queue *a[3], *b[3];
    int outputs = outputs_of(kernel, &expected, a);
    outputs_of(kernel, &got, b);
    for (int r = 0; r < row_count; r++) {
        struct output *out = r ? &got : &expected;
        struct row *row = &rows[r];
        now.kernel = kernel_names[kernel];
        now.row = row->name;
        prepare(kernel, out, count);
        call(kernel, row->kernels, out);
        bool right = true;
        for (int k = 0; k < outputs; k++)
            right = check_queue(row, kernel, k, a[k], r ? b[k] : a[k]) && right;
        right = (kernel != SURFACE || r == 0 || check_film(row)) && right;
        row->checked[kernel] += count;
        row->wrong[kernel] += !right;
    }
    now.row = rows[0].name;
}

// The `count` elements of an output that were appended become an input.
static void take(struct queue *to, const struct queue *from, uint32_t count)
{
    queue_place(to, 0, count, 0, 0);
    queue_copy(to, 0, from, from->kind == QUEUE_HITS ? 0 : input.before, count);
    queue_set_count(to, count);
}

// The rays that the input rays spawn instead of these; the results of the reference serve.
static void replace_by_children(void)
{
    uint32_t count = input.rays.rays.count;
    prepare(TRACE, &expected, count);
    call(TRACE, &rb_kernels_naive, &expected);
    take(&input.hits, &expected.hits, count);
    prepare(SURFACE, &expected, count);
    call(SURFACE, &rb_kernels_naive, &expected);
    uint32_t reflected = expected.reflected.rays.count - input.before;
    uint32_t refracted = expected.refracted.rays.count - input.before;
    reflected = reflected < INPUT_MAX - refracted ? reflected : INPUT_MAX - refracted;
    queue_place(&input.rays, 0, reflected + refracted, 0, 0);
    queue_copy(&input.rays, 0, &expected.reflected, input.before, reflected);
    queue_copy(&input.rays, reflected, &expected.refracted, input.before, refracted);
    input.rays.rays.count = reflected + refracted;
}

static void make_rays(struct ref_random *random, const struct zoo_scene *scene)
{
    uint32_t count = ref_below(random, 3) ? ref_below(random, 2 * RB_LANES_MAX + 2)
                                          : ref_below(random, INPUT_MAX + 1);
    queue_place(&input.rays, 0, count, 0, 0);
    input.world.one_sided = false;
    input.last = false;
    now.class = input_rays(random, &scene->stage.scene, scene->classes, count, &input.rays.rays);
    input_stamp_rays(random, &scene->stage.scene, &input.rays.rays);
    if (ref_below(random, 4) == 0) {
        now.class = "secondary";
        replace_by_children();
        input_stamp_rays(random, &scene->stage.scene, &input.rays.rays);
    }
    queue_pad(&input.rays, input.padding);
}

// Everything about a batch that is not rays.
static const struct zoo_scene *begin_batch(struct ref_random *random)
{
    struct zoo_scene *scene = scenes;
    for (uint32_t at = ref_below(random, ZOO_WEIGHTS); at >= scene->weight; scene++)
        at -= scene->weight;
    now.scene = scene->name;
    input.world = scene->stage.world;
    input.shading = input_shading(random, &scene->stage.scene, &input.sample);
    input_view(random, 1 + (int)ref_below(random, 2 * RB_LANES_MAX + 1), &input.view, &input.span);
    expected.film.limit = got.film.limit = RB_FILM_RANGE / (float)(input.view.aa * input.view.aa);
    input.before = ref_below(random, 2) ? ref_below(random, 2 * RB_LANES_MAX) : 0;
    input.spare = ref_below(random, 2) ? ref_below(random, 2 * RB_LANES_MAX) : 0;
    input.padding = (enum queue_padding)ref_below(random, PADDING_COUNT);
    return scene;
}

static void run_batch(uint64_t number)
{
    struct ref_random random = {rb_hash_word(rb_hash_word(0, now.seed), number)};
    const struct zoo_scene *scene = begin_batch(&random);
    const struct rb_scene *things = &scene->stage.scene;
    now.batch = number;
    make_rays(&random, scene);
    uint32_t count = input.rays.rays.count;
    check_kernel(GENERATE,
                 (uint32_t)((input.span.x1 - input.span.x0) * (input.span.y1 - input.span.y0)));
    input.world.one_sided = ref_below(&random, 4) == 0;
    check_kernel(TRACE, count);

    take(&input.hits, &expected.hits, count);
    if (ref_below(&random, 2))
        input_twist_hits(&random, things, &input.rays.rays, &input.hits.hits);
    queue_pad(&input.hits, input.padding);
    input.last = ref_below(&random, 4) == 0;
    check_kernel(SURFACE, count);

    uint32_t met = expected.surfaces.surfaces.count - input.before;
    take(&input.surfaces, &expected.surfaces, met);
    input_twist_surfaces(&random, &things->lights[input.sample.light], &input.surfaces.surfaces);
    queue_pad(&input.surfaces, input.padding);
    check_kernel(LIGHT, met);

    if (ref_below(&random, 2)) {
        take(&input.shadows, &expected.lit, expected.lit.shadows.count - input.before);
    } else {
        queue_place(&input.shadows, 0, count, 0, 0);
        input_shadows(&random, &input.rays.rays, &expected.hits.hits, &input.shadows.shadows);
    }
    check_kernel(TRACE_SHADOW, input.shadows.shadows.count);
}

static void list_rows(void)
{
    for (const struct rb_variant *variant = rb_variants; variant->name; variant++) {
        bool known = !variant->kernels || !rb_variant_available(variant) || !variant->exact;
        for (int i = 0; i < row_count; i++)
            known = known || rows[i].kernels == variant->kernels;
        if (!known && row_count < ROWS_MAX)
            rows[row_count++] = (struct row){.name = variant->name, .kernels = variant->kernels};
    }
}

static void open_output(struct output *out)
{
    queue_open(&out->camera, QUEUE_RAYS, QUEUE_MAX + INPUT_MAX);
    queue_open(&out->hits, QUEUE_HITS, QUEUE_MAX);
    queue_open(&out->surfaces, QUEUE_SURFACES, QUEUE_MAX);
    queue_open(&out->reflected, QUEUE_RAYS, QUEUE_MAX);
    queue_open(&out->refracted, QUEUE_RAYS, QUEUE_MAX);
    queue_open(&out->lit, QUEUE_SHADOWS, QUEUE_MAX);
    queue_open(&out->shadows, QUEUE_SHADOWS, QUEUE_MAX);
    size_t bytes = 3 * FILM_PIXELS * sizeof *out->film.rgb;
    guard_open(&out->film_memory, bytes);
    out->film.rgb = guard_tail(&out->film_memory, bytes);
    out->film.width = out->film.height = FILM_EDGE;
}

static void close_output(struct output *out)
{
    struct queue *queues[] = {&out->camera,    &out->hits, &out->surfaces, &out->reflected,
                              &out->refracted, &out->lit,  &out->shadows};
    for (size_t i = 0; i < sizeof queues / sizeof *queues; i++)
        queue_close(queues[i]);
    guard_close(&out->film_memory);
}

static void open_all(void)
{
    list_rows();
    zoo_open(scenes);
    queue_open(&input.rays, QUEUE_RAYS, QUEUE_MAX);
    queue_open(&input.hits, QUEUE_HITS, QUEUE_MAX);
    queue_open(&input.surfaces, QUEUE_SURFACES, QUEUE_MAX);
    queue_open(&input.shadows, QUEUE_SHADOWS, QUEUE_MAX);
    open_output(&expected);
    open_output(&got);
    guard_catch_crashes(print_now);
}

static void close_all(void)
{
    queue_close(&input.rays);
    queue_close(&input.hits);
    queue_close(&input.surfaces);
    queue_close(&input.shadows);
    close_output(&expected);
    close_output(&got);
    zoo_close(scenes);
}

int main(int argc, char **argv)
{
    uint64_t wanted = argc > 1 ? strtoull(argv[1], NULL, 10) : 800000;
    now.seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    note("seed %llu", (unsigned long long)now.seed);
    open_all();
    if (argc > 3)
        run_batch(strtoull(argv[3], NULL, 10));
    for (uint64_t batch = 0; argc <= 3 && rows[0].checked[TRACE] < wanted; batch++)
        run_batch(batch);
    for (int r = 0; r < row_count; r++)
        for (int k = 0; k < KERNEL_COUNT; k++)
            ok(rows[r].wrong[k] == 0, "%s: %s is the reference's for %llu elements", rows[r].name,
               kernel_names[k], (unsigned long long)rows[r].checked[k]);
    close_all();
    return done();
}
