// Seals a scene: checks the camera, numbers the media, and moves the grown arrays of the builder
// into the scene without copying them.
#include "scene/scene.h"

#include "base/hash.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#define RESOLUTION_MAX 65536
#define PIXELS_MAX     (1L << 28)
#define MEDIA_MAX      65535

// Sine of the angle between `up` and the view direction below which they count as parallel.
#define UP_SINE_MIN 1e-9

static double reach(const double a[3])
{
    return fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
}

static double sine_between(const double a[3], const double b[3])
{
    double ra = reach(a), rb = reach(b), cross2 = 0.0, a2 = 0.0, b2 = 0.0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double c = a[j] / ra * (b[k] / rb) - a[k] / ra * (b[j] / rb);
        cross2 += c * c;
        a2 += a[i] / ra * (a[i] / ra);
        b2 += b[i] / rb * (b[i] / rb);
    }
    return sqrt(cross2 / (a2 * b2));
}

enum rb_status rb_scene_check_camera(const struct rb_camera *camera, struct rb_error *error)
{
    double view[3];
    for (int i = 0; i < 3; i++) {
        view[i] = camera->from[i] - camera->at[i];
        if (!(fabs(camera->from[i]) <= RB_COORDINATE_MAX) ||
            !(fabs(camera->at[i]) <= RB_COORDINATE_MAX) ||
            !(fabs(camera->up[i]) <= RB_COORDINATE_MAX))
            return rb_error_set(error, RB_INVALID,
                                "a coordinate of the view (from, at, up) is not within +-%g",
                                RB_COORDINATE_MAX);
    }
    if (reach(view) == 0.0)
        return rb_error_set(error, RB_INVALID,
                            "'from' and 'at' of the view are the same point; move one of them");
    if (reach(camera->up) == 0.0)
        return rb_error_set(error, RB_INVALID, "'up' of the view has length zero");
    if (!(sine_between(view, camera->up) > UP_SINE_MIN))
        return rb_error_set(error, RB_INVALID,
                            "'up' of the view is parallel to the direction from 'from' to 'at'");
    if (!(camera->angle_deg > 0.0 && camera->angle_deg < 180.0))
        return rb_error_set(error, RB_INVALID,
                            "the angle of the view must lie between 0 and 180 degrees");
    if (!isfinite(camera->hither))
        return rb_error_set(error, RB_INVALID, "'hither' of the view is not finite");
    if (camera->width < 1 || camera->width > RESOLUTION_MAX || camera->height < 1 ||
        camera->height > RESOLUTION_MAX)
        return rb_error_set(error, RB_INVALID, "each side of the resolution must be from 1 to %d",
                            RESOLUTION_MAX);
    if ((long)camera->width * camera->height > PIXELS_MAX)
        return rb_error_set(error, RB_INVALID, "the resolution %d x %d has more than %ld pixels",
                            camera->width, camera->height, PIXELS_MAX);
    return RB_OK;
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

// Position of `ior` among the sorted media from 1 on.
static uint16_t medium_index(const struct rb_array *media, float ior)
{
    const float *sorted = (const float *)media->data + 1;
    size_t low = 0, high = media->count - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (sorted[middle] < ior)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint16_t)(low + 1);
}

// Lists the distinct indices of refraction of transparent materials, in ascending order behind the
// outside, and points the materials at them.
static enum rb_status number_media(struct rb_scene_builder *builder, struct rb_error *error)
{
    struct rb_array *media = &builder->media;
    struct rb_material *materials = builder->materials.data;
    const float outside = 1.0f;
    bool fits = rb_array_push(media, &outside, sizeof outside);
    for (size_t i = 0; fits && i < builder->materials.count; i++) {
        if (materials[i].t > 0.0f)
            fits = rb_array_push(media, &materials[i].ior, sizeof(float));
    }
    if (!fits)
        return rb_error_memory(error, "the media");

    float *all = media->data;
    qsort(all + 1, media->count - 1, sizeof *all, compare_floats);
    size_t kept = 1;
    for (size_t i = 1; i < media->count; i++) {
        if (kept == 1 || all[i] != all[kept - 1])
            all[kept++] = all[i];
    }
    media->count = kept;
    if (kept > MEDIA_MAX + 1)
        return rb_error_set(error, RB_INVALID,
                            "%zu different indices of refraction; at most %d can be told apart",
                            kept - 1, MEDIA_MAX);
    for (size_t i = 0; i < builder->materials.count; i++)
        materials[i].medium = materials[i].t > 0.0f ? medium_index(media, materials[i].ior) : 0;
    return RB_OK;
}

// Joins the material indices of all kinds in the order of the ids. A scene of one kind gives its
// array away as it is.
static bool join_materials(struct rb_scene_builder *builder, struct rb_array *joined)
{
    for (int k = 0; k < RB_KIND_COUNT; k++) {
        struct rb_array *part = &builder->primitive_materials[k];
        if (part->count == 0)
            continue;
        if (joined->count == 0) {
            rb_array_release(joined);
            *joined = *part;
            *part = (struct rb_array){0};
            continue;
        }
        if (!rb_array_reserve(joined, part->count, sizeof(uint32_t)))
            return false;
        memcpy((uint32_t *)joined->data + joined->count, part->data,
               part->count * sizeof(uint32_t));
        joined->count += part->count;
        rb_array_release(part);
    }
    return true;
}

// Moves the array's memory into the scene, which releases it.
static void *take(struct rb_scene *scene, int *slot, struct rb_array *array, size_t size)
{
    void *data = array->data;
    scene->storage[(*slot)++] = data;
    scene->bytes += array->capacity * size;
    *array = (struct rb_array){0};
    return data;
}

static void move_arrays(struct rb_scene_builder *builder, struct rb_array *materials,
                        struct rb_scene *scene)
{
    struct rb_array *primitives = builder->primitives;
    uint32_t first = 0;
    for (int k = 0; k < RB_KIND_COUNT; k++) {
        scene->count[k] = (uint32_t)primitives[k].count;
        scene->first[k] = first;
        first += scene->count[k];
    }
    scene->primitive_count = first;
    scene->bounded_count = scene->first[RB_PLANE];
    scene->light_count = (uint32_t)builder->lights.count;
    scene->material_count = (uint32_t)builder->materials.count;
    scene->media_count = (uint32_t)builder->media.count;

    int slot = 0;
#define TAKE(field, array) (scene->field = take(scene, &slot, (array), sizeof *scene->field))
    TAKE(lights, &builder->lights);
    TAKE(materials, &builder->materials);
    TAKE(media, &builder->media);
    TAKE(spheres, &primitives[RB_SPHERE]);
    TAKE(triangles, &primitives[RB_TRIANGLE]);
    TAKE(cones, &primitives[RB_CONE]);
    TAKE(planes, &primitives[RB_PLANE]);
    TAKE(triangle_normals, &builder->triangle_normals);
    TAKE(triangle_smooth, &builder->triangle_smooth);
    TAKE(smooth_normals, &builder->smooth_normals);
    TAKE(material_of, materials);
#undef TAKE
}

// Hashes `bytes` bytes, a multiple of 4, eight at a time.
static uint64_t hash_bytes(uint64_t hash, const void *data, size_t bytes)
{
    const char *at = data;
    uint64_t word;
    uint32_t half;
    hash = rb_hash_word(hash, bytes);
    for (; bytes >= sizeof word; bytes -= sizeof word, at += sizeof word) {
        memcpy(&word, at, sizeof word);
        hash = rb_hash_word(hash, word);
    }
    if (bytes) {
        memcpy(&half, at, sizeof half);
        hash = rb_hash_word(hash, half);
    }
    return hash;
}

// Adding zero turns -0 into +0, as for everything that is not the camera on its way in.
static void drop_signs_of_zero(struct rb_camera *camera)
{
    double *vectors[] = {camera->from, camera->at, camera->up};
    for (int i = 0; i < 9; i++)
        vectors[i / 3][i % 3] += 0.0;
    camera->hither += 0.0;
}

static uint64_t hash_scene(const struct rb_scene *scene)
{
    uint64_t hash = hash_bytes(0, &scene->camera, sizeof scene->camera);
    hash = hash_bytes(hash, scene->background, sizeof scene->background);
    hash = hash_bytes(hash, scene->lights, scene->light_count * sizeof *scene->lights);
    for (uint32_t i = 0; i < scene->material_count; i++) {
        const struct rb_material *material = &scene->materials[i];
        hash = hash_bytes(hash, material, offsetof(struct rb_material, medium));
        hash = rb_hash_word(hash, material->medium);
    }
    hash = hash_bytes(hash, scene->media, scene->media_count * sizeof *scene->media);
    const uint32_t *count = scene->count;
    hash = hash_bytes(hash, scene->count, sizeof scene->count);
    hash = hash_bytes(hash, scene->spheres, count[RB_SPHERE] * sizeof *scene->spheres);
    hash = hash_bytes(hash, scene->triangles, count[RB_TRIANGLE] * sizeof *scene->triangles);
    hash = hash_bytes(hash, scene->triangle_normals,
                      count[RB_TRIANGLE] * sizeof *scene->triangle_normals);
    uint32_t smooth_count = 0;
    for (uint32_t i = 0; scene->triangle_smooth && i < count[RB_TRIANGLE]; i++) {
        hash = rb_hash_word(hash, scene->triangle_smooth[i]);
        smooth_count += scene->triangle_smooth[i] != RB_NONE;
    }
    hash = hash_bytes(hash, scene->smooth_normals, smooth_count * sizeof *scene->smooth_normals);
    hash = hash_bytes(hash, scene->cones, count[RB_CONE] * sizeof *scene->cones);
    hash = hash_bytes(hash, scene->planes, count[RB_PLANE] * sizeof *scene->planes);
    return hash_bytes(hash, scene->material_of,
                      scene->primitive_count * sizeof *scene->material_of);
}

enum rb_status rb_scene_finish(struct rb_scene_builder *builder, struct rb_scene *scene,
                               struct rb_error *error)
{
    *scene = (struct rb_scene){0};
    struct rb_array materials = {0};
    enum rb_status status = rb_scene_check_camera(&builder->camera, error);
    if (status == RB_OK)
        status = number_media(builder, error);
    if (status == RB_OK && !join_materials(builder, &materials))
        status = rb_error_memory(error, "the materials of the primitives");
    if (status == RB_OK) {
        scene->camera = builder->camera;
        drop_signs_of_zero(&scene->camera);
        for (int i = 0; i < 3; i++)
            scene->background[i] = builder->background[i] + 0.0f;
        move_arrays(builder, &materials, scene);
        scene->hash = hash_scene(scene);
    }
    rb_array_release(&materials);
    rb_scene_builder_release(builder);
    return status;
}

void rb_scene_builder_release(struct rb_scene_builder *builder)
{
    struct rb_array *arrays[] = {&builder->lights,          &builder->materials,
                                 &builder->media,           &builder->triangle_normals,
                                 &builder->triangle_smooth, &builder->smooth_normals};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rb_array_release(arrays[i]);
    for (int k = 0; k < RB_KIND_COUNT; k++) {
        rb_array_release(&builder->primitives[k]);
        rb_array_release(&builder->primitive_materials[k]);
    }
    *builder = (struct rb_scene_builder){0};
}

void rb_scene_free(struct rb_scene *scene)
{
    for (size_t i = 0; i < sizeof scene->storage / sizeof *scene->storage; i++)
        rb_free(scene->storage[i]);
    *scene = (struct rb_scene){0};
}

void rb_scene_bounds(const struct rb_scene *scene, uint32_t id, float low[3], float high[3])
{
    switch (rb_scene_kind(scene, id)) {
    case RB_SPHERE:
        rb_sphere_bounds(&scene->spheres[id], low, high);
        break;
    case RB_TRIANGLE:
        rb_triangle_bounds(&scene->triangles[id - scene->first[RB_TRIANGLE]], low, high);
        break;
    default: {
        const struct rb_cone *cone = &scene->cones[id - scene->first[RB_CONE]];
        memcpy(low, cone->low, sizeof cone->low);
        memcpy(high, cone->high, sizeof cone->high);
        break;
    }
    }
}
