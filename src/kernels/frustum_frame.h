// Bundles whose rays have one origin, the eye: each packet is a rectangle on a plane before it, and
// what a packet may meet is what its rectangle overlaps. Far tighter than intervals of inverse
// directions where primitives are as small as pixels, and a few comparisons once the primitives
// are on the plane, too.
#ifndef RB_KERNELS_FRUSTUM_FRAME_H
#define RB_KERNELS_FRUSTUM_FRAME_H

#include "kernels/eights.h"
#include "kernels/frustum_bundle.h"
#include "kernels/frustum_range.h"

// Axes of the plane, those of the image if the first rays are neighbours in a row, and the
// direction in which it lies. Any will do: they decide how tight the rectangles are.
static void frame_axes(struct bundle *bundle)
{
    int last = bundle->count * RB_LANES - 1;
    const float *dx = bundle->d[0], *dy = bundle->d[1], *dz = bundle->d[2];
    struct rb_vec z =
        rb_normalize((struct rb_vec){dx[0] + dx[last], dy[0] + dy[last], dz[0] + dz[last]});
    struct rb_vec x = {dx[RB_CELL - 1] - dx[0], dy[RB_CELL - 1] - dy[0], dz[RB_CELL - 1] - dz[0]};
    x = rb_normalize(rb_vec_mad(x, -rb_dot(x, z), z));
    struct rb_vec axes[3] = {x, rb_cross(z, x), z};
    for (int k = 0; k < 3; k++) {
        bundle->axes[k][0] = axes[k].x;
        bundle->axes[k][1] = axes[k].y;
        bundle->axes[k][2] = axes[k].z;
    }
}

// Along axis k the least and the largest that the directions of a packet have; returns the largest
// magnitude of all. Packets that are not finite do not count.
static float frame_range(struct bundle *bundle, int k)
{
    float at[BUNDLE];
    struct vvec axis = vv_set(bundle->axes[k]);
    vfloat most = vf_set(0.0f);
    for (int p = 0; p < bundle->count; p++)
        vf_store(at + p * RB_LANES, vv_dot(bundle_vector(bundle->d, p), axis));
    for (int part = 0; part < WHOLES; part++) {
        vfloat low, high;
        lanes_range(at, part * RB_LANES, bundle->count, &low, &high);
        vf_store(bundle->low[k] + part * RB_LANES, low);
        vf_store(bundle->high[k] + part * RB_LANES, high);
        most = vf_max(vf_max(vf_abs(low), vf_abs(high)), most);
    }
    return vf_max_lane(most)[0];
}

// Are all rays on the side of the plane, their z above 0? A comparison with what is no number is
// not true, so packets that are not finite do not count.
static bool frame_before(const struct bundle *bundle)
{
    struct vvec z = vv_set(bundle->axes[2]);
    vint behind = vi_set(0);
    for (int p = 0; p < bundle->count; p++)
        behind |= vv_dot(bundle_vector(bundle->d, p), z) <= 0.0f;
    return !vi_any(behind);
}

// A direction is at x / z on the plane. For those of a packet z is between the least cosine of the
// bundle and 1; 2^-20 and 2^-18 are some ulps of what unit directions have.
static void bundle_frame(struct bundle *bundle)
{
    frame_axes(bundle);
    float x = frame_range(bundle, 0), y = frame_range(bundle, 1);
    float square = 1.0f - x * x - y * y;
    bundle->frame = square > 0.25f && frame_before(bundle) ? FRAME_KNOWN : FRAME_NONE;
    bundle->bend = 1.0f / (sqrtf(square) - 0x1p-18f);
    for (int k = 0; k < 2; k++)
        for (int part = 0; part < WHOLES; part++) {
            float *from = bundle->low[k] + part * RB_LANES, *to = bundle->high[k] + part * RB_LANES;
            vfloat low = vf_load(from), high = vf_load(to);
            vf_store(from, vf_min(low, low * bundle->bend) - 0x1p-20f);
            vf_store(to, vf_max(high, high * bundle->bend) + 0x1p-20f);
        }
}

// Is each packet a rectangle? Asked first where the first leaf is met: many bundles meet none.
static inline bool bundle_framed(struct bundle *bundle)
{
    if (bundle->frame == FRAME_UNKNOWN)
        bundle_frame(bundle);
    return bundle->frame == FRAME_KNOWN;
}

RB_INLINE struct v8vec bundle_eye(const struct bundle *bundle)
{
    const float o[3] = {bundle->o[0][0], bundle->o[1][0], bundle->o[2][0]};
    return v8_vec_set(o);
}

// 8 things on the plane, and how near they are. What is not before the eye is everywhere.
struct rects {
    float low[2][RB_WIDE], high[2][RB_WIDE], near[RB_WIDE];
};

// From what they are along an axis, the plane being 1 away, at both ends of their depth.
RB_INLINE void rects_project(struct rects *rects, int k, int lane, v8float low, v8float high,
                             v8float inv_near, v8float inv_far, v8int before)
{
    v8float from = v8_min(low * inv_near, low * inv_far);
    v8float to = v8_max(high * inv_near, high * inv_far);
    v8_store(rects->low[k] + lane, v8_select(before, from, v8_set(-INFINITY)));
    v8_store(rects->high[k] + lane, v8_select(before, to, v8_set(INFINITY)));
}

// How much a box of half edges `half` has of a direction.
RB_INLINE v8float v8_extent(struct v8vec half, const float axis[3])
{
    return half.x * fabsf(axis[0]) + half.y * fabsf(axis[1]) + half.z * fabsf(axis[2]);
}

// Boxes from `low` to `high`, seen from the eye; 2^-17 is 60 times what a slab may be off.
RB_INLINE void rects_of_boxes(const struct bundle *bundle, struct rects *rects, int lane,
                              struct v8vec low, struct v8vec high)
{
    struct v8vec middle = {(low.x + high.x) * 0.5f, (low.y + high.y) * 0.5f,
                           (low.z + high.z) * 0.5f};
    struct v8vec half = v8_sub(high, middle);
    v8float slack = v8_max(v8_reach(low), v8_reach(high)) * 0x1p-17f + 1e-18f;
    v8float depth = v8_dot(middle, v8_vec_set(bundle->axes[2]));
    v8float deep = v8_extent(half, bundle->axes[2]) + slack;
    v8float near = depth - deep, inv_near = 1.0f / near, inv_far = 1.0f / (depth + deep);
    for (int k = 0; k < 2; k++) {
        v8float at = v8_dot(middle, v8_vec_set(bundle->axes[k]));
        v8float wide = v8_extent(half, bundle->axes[k]) + slack;
        rects_project(rects, k, lane, at - wide, at + wide, inv_near, inv_far, near > 0.0f);
    }
    v8_store(rects->near + lane, near);
}

// Which of them packet p cannot meet. A comparison with what is no number is not true.
RB_INLINE v8int rects_miss(const struct bundle *bundle, const struct rects *rects, int lane, int p)
{
    v8float limit = v8_set(bundle->by_packet[p / RB_LANES].limit[p % RB_LANES]);
    return (v8_load(rects->low[0] + lane) > bundle->high[0][p]) |
           (v8_load(rects->high[0] + lane) < bundle->low[0][p]) |
           (v8_load(rects->low[1] + lane) > bundle->high[1][p]) |
           (v8_load(rects->high[1] + lane) < bundle->low[1][p]) |
           (v8_load(rects->near + lane) > limit);
}

// The lowest bit of each byte.
static inline uint64_t bytes_bit(uint64_t bytes)
{
    return (bytes & 0x0101010101010101u) * 0x0102040810204080u >> 56;
}

// bundle_reach for the children of a node.
RB_INLINE void rects_reach(const struct bundle *bundle, uint64_t set,
                           const struct rb_wide_node *node, struct reach *reach)
{
    struct rects rects;
    struct v8vec o = bundle_eye(bundle);
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        const float(*of)[2][RB_WIDE] = node->bounds;
        struct v8vec low = {v8_load(of[0][0] + lane), v8_load(of[1][0] + lane),
                            v8_load(of[2][0] + lane)};
        struct v8vec high = {v8_load(of[0][1] + lane), v8_load(of[1][1] + lane),
                             v8_load(of[2][1] + lane)};
        rects_of_boxes(bundle, &rects, lane, v8_sub(low, o), v8_sub(high, o));
    }
    memcpy(reach->enter, rects.near, sizeof reach->enter);
    uint64_t pairs[PACKETS / 8] = {0};
    for (uint64_t left = set; left; left &= left - 1) {
        int p = __builtin_ctzll(left);
        unsigned met = 0;
        for (int lane = 0; lane < RB_WIDE; lane += BOXES)
            met |= v8_bits(~rects_miss(bundle, &rects, lane, p)) << lane;
        bits |= met;
        pairs[p / 8] |= (uint64_t)met << p % 8 * 8;
        RB_COUNT_STEP((1u << RB_WIDE) - 1, RB_WIDE);
    }
    bits &= (1u << node->count) - 1;
    reach->boxes = bits;
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        reach->set[lane] = 0;
        for (int eight = 0; eight < PACKETS / 8; eight++)
            reach->set[lane] |= bytes_bit(pairs[eight] >> lane) << 8 * eight;
    }
}

#endif
