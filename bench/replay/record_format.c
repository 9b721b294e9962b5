#include "bench/replay/record_format.h"

#include "base/hash.h"

#include <string.h>

const char rb_record_magic[8] = {'R', 'B', 'R', 'A', 'Y', 'S', '\r', '\n'};

const char *const rb_ray_class_names[RB_CLASS_COUNT] = {
    [RB_CLASS_IMAGE] = "image",           [RB_CLASS_DIFFUSE] = "diffuse",
    [RB_CLASS_REFLECTION] = "reflection", [RB_CLASS_REFRACTION] = "refraction",
    [RB_CLASS_SHADOW] = "shadow",
};

bool rb_record_machine_fits(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

uint64_t rb_record_checksum(uint64_t hash, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i += sizeof(uint64_t)) {
        uint64_t word = 0;
        size_t rest = count - i;
        memcpy(&word, (const char *)bytes + i, rest < sizeof word ? rest : sizeof word);
        hash = rb_hash_word(hash, word);
    }
    return hash;
}

// A record of fixed fields on its way into bytes or out of them.
struct fields {
    unsigned char *bytes;
    size_t at;
    bool writing;
};

static void field(struct fields *fields, void *value, size_t size)
{
    unsigned char *at = fields->bytes + fields->at;
    memcpy(fields->writing ? at : value, fields->writing ? value : at, size);
    fields->at += size;
}

static void int_field(struct fields *fields, int *value)
{
    uint32_t word = (uint32_t)*value;
    field(fields, &word, sizeof word);
    *value = word <= INT32_MAX ? (int)word : -1;
}

static void bool_field(struct fields *fields, bool *value)
{
    int word = *value;
    int_field(fields, &word);
    *value = word == 1;
}

bool rb_record_header_fields(unsigned char bytes[RB_RECORD_HEADER_BYTES], bool writing,
                             struct rb_record_header *header)
{
    struct fields fields = {.bytes = bytes, .writing = writing, .at = 16};
    struct rb_settings *s = &header->settings;
    int *const numbers[] = {&s->width, &s->height, &s->depth, &s->aa, &s->light_samples, &s->tile};
    field(&fields, &header->scene_hash, sizeof header->scene_hash);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        int_field(&fields, numbers[i]);
    bool_field(&fields, &s->phong);
    bool_field(&fields, &s->spd);
    field(&fields, &s->light_size, sizeof s->light_size);
    field(&fields, &s->light_scale, sizeof s->light_scale);
    field(&fields, &s->ambient, sizeof s->ambient);
    field(&fields, &s->seed, sizeof s->seed);
    field(&fields, header->row, sizeof header->row);
    field(&fields, header->scene, sizeof header->scene);
    uint64_t sum = rb_record_checksum(fields.at, bytes, fields.at), kept = sum;
    field(&fields, &kept, sizeof kept);
    return kept == sum;
}

bool rb_record_chunk_fields(unsigned char bytes[RB_RECORD_CHUNK_BYTES], bool writing,
                            uint64_t number, struct rb_record_chunk *chunk)
{
    struct fields fields = {.bytes = bytes, .writing = writing};
    uint32_t *const words[] = {&chunk->kind, &chunk->ray_class, &chunk->bounce, &chunk->count};
    int *const corners[] = {&chunk->span.x0, &chunk->span.y0, &chunk->span.x1, &chunk->span.y1};
    uint32_t nothing = 0;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        field(&fields, words[i], sizeof *words[i]);
    for (size_t i = 0; i < sizeof corners / sizeof *corners; i++)
        int_field(&fields, corners[i]);
    field(&fields, &chunk->span.sample, sizeof chunk->span.sample);
    field(&fields, &nothing, sizeof nothing);
    field(&fields, &chunk->checksum, sizeof chunk->checksum);
    uint64_t sum = rb_record_checksum(number, bytes, fields.at), kept = sum;
    field(&fields, &kept, sizeof kept);
    return kept == sum;
}

// The arrays of a batch in the order of the file.
static size_t arrays_of(struct rb_batch *batch, struct rb_members queues[2])
{
    if (batch->kind == RB_BATCH_SHADOWS) {
        queues[0] = rb_shadows_members(&batch->shadows);
        return 1;
    }
    queues[0] = rb_rays_members(&batch->rays);
    queues[1] = rb_hits_members(&batch->hits);
    return 2;
}

size_t rb_record_ray_bytes(enum rb_batch_kind kind)
{
    struct rb_batch batch = {.kind = kind};
    struct rb_members queues[2];
    size_t bytes = 0, count = arrays_of(&batch, queues);
    for (size_t q = 0; q < count; q++)
        for (size_t i = 0; i < queues[q].count; i++)
            bytes += queues[q].member[i].size;
    return bytes;
}

void rb_record_pack(struct rb_batch *batch, char *buffer, bool writing)
{
    struct rb_members queues[2];
    size_t count = arrays_of(batch, queues);
    for (size_t q = 0; q < count; q++)
        for (size_t i = 0; i < queues[q].count; i++) {
            const struct rb_member *member = &queues[q].member[i];
            size_t bytes = rb_batch_count(batch) * member->size;
            char *array = rb_member_array(member);
            memcpy(writing ? buffer : array, writing ? array : buffer, bytes);
            buffer += bytes;
        }
}

void rb_record_count(struct rb_record_contents *contents, const struct rb_record_chunk *chunk)
{
    contents->of[chunk->ray_class][chunk->kind][chunk->bounce].batches++;
    contents->of[chunk->ray_class][chunk->kind][chunk->bounce].rays += chunk->count;
    contents->chunks++;
}
