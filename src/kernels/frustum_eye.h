// Leaves met by packets that are rectangles on a plane before the eye: 8 spheres or triangles
// against one packet after the other, then the pairs that are left ray by ray. What tests of one
// origin have in common is computed once per leaf, as the norm has it, bit by bit.
#ifndef RB_KERNELS_FRUSTUM_EYE_H
#define RB_KERNELS_FRUSTUM_EYE_H

#include "kernels/frustum_frame.h"

struct eye_spheres {
    const struct rb_wide_spheres *block;
    unsigned present;
    struct rects rects;
    float l[3][RB_WIDE], square[RB_WIDE]; // from the eye to the centre; radius squared
};

// The discriminant is off by 2^-19 of the distance at most; the slack is eight times that.
RB_INLINE void eye_spheres_open(const struct bundle *bundle, const struct rb_wide_spheres *block,
                                struct eye_spheres *eye)
{
    eye->block = block;
    eye->present = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        struct v8vec l = v8_sub(v8_vec(block->center, lane), bundle_eye(bundle));
        v8float radius = v8_load(block->radius + lane);
        v8_vec_store(eye->l, lane, l);
        v8_store(eye->square + lane, radius * radius);
        v8float reach = v8_abs(radius) + v8_reach(l) * 0x1p-16f + 1e-18f;
        v8float depth = v8_dot(l, v8_vec_set(bundle->axes[2])), inverse = 1.0f / depth;
        v8float near = depth - reach, wide = reach * bundle->bend;
        for (int k = 0; k < 2; k++) {
            v8float at = v8_dot(l, v8_vec_set(bundle->axes[k]));
            rects_project(&eye->rects, k, lane, at - wide, at + wide, inverse, inverse,
                          near > 0.0f);
        }
        v8_store(eye->rects.near + lane, near);
        eye->present |= v8_present(block->id + lane) << lane;
    }
}

RB_INLINE unsigned eye_spheres_meet(const struct bundle *bundle, const struct eye_spheres *eye,
                                    int p)
{
    unsigned bits = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES)
        bits |= v8_bits(~rects_miss(bundle, &eye->rects, lane, p)) << lane;
    return bits & eye->present;
}

RB_INLINE struct vvec eye_vec(const float of[3][RB_WIDE], int lane)
{
    return (struct vvec){vf_set(of[0][lane]), vf_set(of[1][lane]), vf_set(of[2][lane])};
}

RB_INLINE vint eye_sphere_hit(const struct bundle *bundle, const struct eye_spheres *eye, int lane,
                              int p, struct hits *hit)
{
    struct sphere_line line =
        sphere_pass(eye_vec(eye->l, lane), bundle_vector(bundle->d, p), eye->square[lane]);
    vint active = bundle->active[p], inside = active & (line.discriminant >= 0.0f);
    count_primitive(RB_COUNT_SPHERES, active, inside, sizeof(struct rb_sphere));
    if (!vi_any(inside))
        return inside;
    struct packet packet = bundle_packet(bundle, p, false);
    const float(*center)[RB_WIDE] = eye->block->center, radius = eye->block->radius[lane];
    struct rb_sphere sphere = {{center[0][lane], center[1][lane], center[2][lane]}, radius};
    float low[3], high[3];
    rb_sphere_bounds(&sphere, low, high);
    hit->prim = vi_set(eye->block->id[lane]);
    vint own = packet.self == hit->prim;
    inside = sphere_root(&line, radius < 0.0f, low, high, &packet, inside, own, hit);
    return inside & (hit->t > 0.0f);
}

struct eye_triangles {
    const struct rb_wide_triangles *block;
    unsigned present;
    struct rects rects;
    float s[3][RB_WIDE], e1[3][RB_WIDE], e2[3][RB_WIDE], q[3][RB_WIDE]; // as rb_triangle_test
    float along[RB_WIDE], slack[RB_WIDE];                               // e2 . q
    float edge[3][3][RB_WIDE], wide[RB_WIDE]; // planes through the eye and an edge, on the axes
};

// A ray d has u = d . (e2 x s), v = d . q, and u + v + w = d . (e2 x e1), all of one sign if it
// hits. `wide` is twice what the norm's tolerance and all roundings add up to, 2^-16 of the longest
// edge times it and the distance.
RB_INLINE void eye_edges(const struct bundle *bundle, struct eye_triangles *eye, int lane,
                         struct v8vec s, struct v8vec e1, struct v8vec e2)
{
    struct v8vec q = v8_cross(s, e1), u = v8_cross(e2, s), all = v8_cross(e2, e1);
    struct v8vec edge[3] = {u, q, v8_sub(v8_sub(all, u), q)};
    v8float far = v8_reach(s), longest = v8_max(v8_reach(e1), v8_reach(e2));
    v8_vec_store(eye->q, lane, q);
    v8_store(eye->along + lane, v8_dot(e2, q));
    v8_store(eye->slack + lane, RB_EDGE_TOLERANCE * far * longest);
    v8_store(eye->wide + lane, 0x1p-15f * longest * (far + longest));
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            v8_store(eye->edge[i][k] + lane, v8_dot(edge[i], v8_vec_set(bundle->axes[k])));
}

RB_INLINE void eye_triangles_open(const struct bundle *bundle,
                                  const struct rb_wide_triangles *block, struct eye_triangles *eye)
{
    struct v8vec o = bundle_eye(bundle);
    eye->block = block;
    eye->present = 0;
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        struct v8vec a = v8_vec(block->v[0], lane), b = v8_vec(block->v[1], lane);
        struct v8vec c = v8_vec(block->v[2], lane);
        struct v8vec s = v8_sub(o, a), e1 = v8_sub(b, a), e2 = v8_sub(c, a);
        v8_vec_store(eye->s, lane, s);
        v8_vec_store(eye->e1, lane, e1);
        v8_vec_store(eye->e2, lane, e2);
        eye_edges(bundle, eye, lane, s, e1, e2);
        rects_of_boxes(bundle, &eye->rects, lane, v8_sub(v8_vec_min(v8_vec_min(a, b), c), o),
                       v8_sub(v8_vec_max(v8_vec_max(a, b), c), o));
        eye->present |= v8_present(block->id + lane) << lane;
    }
}

// The middle of the rectangle of a packet, and half its edges.
struct window {
    float x, y, half_x, half_y;
};

// Triangles of which all rays of the packet are outside of some edge, seen from the front and seen
// from behind.
RB_INLINE v8int eye_outside(const struct eye_triangles *eye, int lane, const struct window *of)
{
    v8int front = {0}, back = {0};
    v8float wide = v8_load(eye->wide + lane);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        struct v8vec n = v8_vec(eye->edge[i], lane);
        v8float at = n.x * of->x + n.y * of->y + n.z;
        v8float half = v8_abs(n.x) * of->half_x + v8_abs(n.y) * of->half_y + wide;
        front |= at<-half, back |= at> half;
    }
    return front & back;
}

RB_INLINE unsigned eye_triangles_meet(const struct bundle *bundle, const struct eye_triangles *eye,
                                      int p)
{
    unsigned bits = 0;
    float x = (bundle->high[0][p] + bundle->low[0][p]) * 0.5f;
    float y = (bundle->high[1][p] + bundle->low[1][p]) * 0.5f;
    struct window window = {x, y, bundle->high[0][p] - x, bundle->high[1][p] - y};
    for (int lane = 0; lane < RB_WIDE; lane += BOXES) {
        v8int miss = rects_miss(bundle, &eye->rects, lane, p) | eye_outside(eye, lane, &window);
        bits |= v8_bits(~miss) << lane;
    }
    return bits & eye->present;
}

RB_INLINE vint eye_triangle_hit(const struct bundle *bundle, const struct eye_triangles *eye,
                                int lane, int p, struct hits *hit)
{
    struct triangle_edges edges =
        triangle_pass(eye_vec(eye->s, lane), eye_vec(eye->e1, lane), eye_vec(eye->e2, lane),
                      eye_vec(eye->q, lane), bundle_vector(bundle->d, p));
    vint active = bundle->active[p];
    vint inside = active & triangle_inside(&edges, vf_set(eye->slack[lane]));
    count_primitive(RB_COUNT_TRIANGLES, active, inside, sizeof(struct rb_triangle));
    if (!vi_any(inside))
        return inside;
    struct packet packet = bundle_packet(bundle, p, false);
    float low[3], high[3];
    for (int k = 0; k < 3; k++) {
        float a = eye->block->v[0][k][lane], b = eye->block->v[1][k][lane];
        float c = eye->block->v[2][k][lane];
        low[k] = rb_min(rb_min(a, b), c), high[k] = rb_max(rb_max(a, b), c);
    }
    hit->prim = vi_set(eye->block->id[lane]);
    inside &= packet.self != hit->prim;
    inside = triangle_root(&edges, vf_set(eye->along[lane]), low, high, &packet, inside, hit);
    return inside & (hit->t > 0.0f);
}

// A leaf of either kind, which is known where this is compiled.
struct eye_leaf {
    enum rb_wide_kind kind;
    union {
        struct eye_spheres spheres;
        struct eye_triangles triangles;
    } of;
};

RB_INLINE void eye_open(const struct bundle *bundle, const struct rb_wide *wide,
                        rb_wide_child child, enum rb_wide_kind kind, struct eye_leaf *leaf)
{
    uint32_t index = rb_wide_index_of(child);
    leaf->kind = kind;
    if (kind == RB_WIDE_SPHERES)
        eye_spheres_open(bundle, &wide->spheres[index], &leaf->of.spheres);
    else
        eye_triangles_open(bundle, &wide->triangles[index], &leaf->of.triangles);
}

// The primitives of the leaf that packet p may meet, one bit each.
RB_INLINE unsigned eye_meet(const struct bundle *bundle, const struct eye_leaf *leaf, int p)
{
    RB_COUNT_STEP((1u << RB_WIDE) - 1, RB_WIDE);
    if (leaf->kind == RB_WIDE_SPHERES)
        return eye_spheres_meet(bundle, &leaf->of.spheres, p);
    return eye_triangles_meet(bundle, &leaf->of.triangles, p);
}

// Lanes of packet p that meet a primitive.
RB_INLINE vint eye_hit(struct bundle *bundle, const struct eye_leaf *leaf, int lane, int p,
                       struct hits *hit)
{
    RB_COUNT_AT(bundle_place(bundle, p));
    *hit = (struct hits){.prim = vi_set(RB_NONE)};
    vint found = leaf->kind == RB_WIDE_SPHERES
                     ? eye_sphere_hit(bundle, &leaf->of.spheres, lane, p, hit)
                     : eye_triangle_hit(bundle, &leaf->of.triangles, lane, p, hit);
    if (!vi_any(found))
        bundle_in_vain(bundle, p);
    return found;
}

#endif
