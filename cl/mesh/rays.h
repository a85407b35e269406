// Rays of the eye against the tree, LANES side by side with one stack, so that what they have in common is read once.
//
// Corners are seen along the axes of the picture, where a ray is x = x0 + slope z; with x and y taken from it, the edge
// functions of Woop, Benthin, Wald 2013 tell what it meets, as cl/mesh/trace.h says. The depth z is the corners', in
// the shares of the triangle that the edges span.
#pragma once
#include "../block.h"
#include "trace.h"

#pragma OPENCL FP_CONTRACT OFF

typedef struct {
    floatv offset_x, offset_y, slope_x, slope_y;
    float3v origin, way; // from where depths begin, and by a depth of 1 along the ray, world axes
    floatv longer;       // lengths along the ray to a depth of 1
} EyeRays;

// What rays meet first.
typedef struct {
    floatv depth; // along the axis of view; infinite: nothing
    uintv triangle;
} Met;

// Returns the rays of a place of the grid, in rays from the first one.
INLINE EyeRays eye_rays(const MeshSight *const sight, const floatv column, const floatv row) {
    const floatv x = fma(column, sight->step_x, splat(sight->first_x));
    const floatv y = fma(row, sight->step_y, splat(sight->first_y));
    const float3v right = uniform3(sight->right), down = uniform3(sight->down);
    const float3v eye = uniform3(sight->eye), forward = uniform3(sight->forward);
    EyeRays rays;
    rays.offset_x = rays.offset_y = rays.slope_x = rays.slope_y = splat(0.0f);
    rays.origin = eye;
    rays.way = forward;
    if (sight->is_parallel) {
        rays.offset_x = x;
        rays.offset_y = y;
        rays.origin = fma3(right, x, fma3(down, y, eye));
    } else {
        rays.slope_x = x;
        rays.slope_y = y;
        rays.way = fma3(right, x, fma3(down, y, forward));
    }
    rays.longer = sqrt(dot3(rays.way, rays.way));
    return rays;
}

INLINE floatv safe_inverses(const floatv x) {
    return 1.0f / copysign(fmax(fabs(x), LEAST_COMPONENT), x);
}

INLINE floatv edge_sides(const floatv a_x, const floatv a_y, const floatv b_x, const floatv b_y) {
    return a_x * b_y - a_y * b_x;
}

// Returns a corner along the axes of the picture.
INLINE float3 in_picture(const MeshSight *const sight, const float x, const float y, const float z) {
    const float3 place = (float3)(x, y, z) - sight->eye.xyz - sight->eye_rest.xyz;
    return (float3)(dot(sight->to_right.xyz, place), dot(sight->to_down.xyz, place), dot(sight->to_forward.xyz, place));
}

INLINE void meet_triangle(const MeshSight *const sight, const EyeRays *const rays,
                          __global const MeshTriangle *const triangles, const uint number, Met *const met) {
    __global const MeshTriangle *const triangle = triangles + number;
    const float3 a = in_picture(sight, triangle->a_x, triangle->a_y, triangle->a_z);
    const float3 b = in_picture(sight, triangle->b_x, triangle->b_y, triangle->b_z);
    const float3 c = in_picture(sight, triangle->c_x, triangle->c_y, triangle->c_z);
    const floatv a_x = a.x - fma(rays->slope_x, splat(a.z), rays->offset_x);
    const floatv a_y = a.y - fma(rays->slope_y, splat(a.z), rays->offset_y);
    const floatv b_x = b.x - fma(rays->slope_x, splat(b.z), rays->offset_x);
    const floatv b_y = b.y - fma(rays->slope_y, splat(b.z), rays->offset_y);
    const floatv c_x = c.x - fma(rays->slope_x, splat(c.z), rays->offset_x);
    const floatv c_y = c.y - fma(rays->slope_y, splat(c.z), rays->offset_y);
    const floatv of_a = edge_sides(c_x, c_y, b_x, b_y);
    const floatv of_b = edge_sides(a_x, a_y, c_x, c_y);
    const floatv of_c = edge_sides(b_x, b_y, a_x, a_y);
#ifdef OPEN_EDGES
    const intv is_inside = (fmin(of_a, fmin(of_b, of_c)) > 0.0f) | (fmax(of_a, fmax(of_b, of_c)) < 0.0f);
#else
    const intv is_inside = (fmin(of_a, fmin(of_b, of_c)) >= 0.0f) | (fmax(of_a, fmax(of_b, of_c)) <= 0.0f);
#endif
    const floatv all = of_a + of_b + of_c;
    const floatv depth = (of_a * a.z + of_b * b.z + of_c * c.z) / all;
    const intv is_met = is_inside & (all != 0.0f) & (depth > 0.0f) & (depth < met->depth);
    met->depth = select(met->depth, depth, is_met);
    met->triangle = select(met->triangle, (uintv)(number), is_met);
}

INLINE bool meet_box(const EyeRays *const rays, const float3v inverse, const float wider, const floatv most,
                     __global const TreeNode *const node) {
    const floatv low_x = (node->low_x - wider - rays->origin.x) * inverse.x;
    const floatv low_y = (node->low_y - wider - rays->origin.y) * inverse.y;
    const floatv low_z = (node->low_z - wider - rays->origin.z) * inverse.z;
    const floatv high_x = (node->high_x + wider - rays->origin.x) * inverse.x;
    const floatv high_y = (node->high_y + wider - rays->origin.y) * inverse.y;
    const floatv high_z = (node->high_z + wider - rays->origin.z) * inverse.z;
    const floatv first = fmax(fmax(fmin(low_x, high_x), fmin(low_y, high_y)), fmax(fmin(low_z, high_z), 0.0f));
    const floatv last = fmin(fmin(fmax(low_x, high_x), fmax(low_y, high_y)), fmin(fmax(low_z, high_z), most));
    return any_lane(first <= last * WIDER_BOX);
}

// Returns whether the second of two boxes is nearer to where rays begin, by the way of the first of them.
INLINE bool is_second_nearer(const EyeRays *const rays, __global const TreeNode *const nodes) {
    const float x = nodes[1].low_x + nodes[1].high_x - nodes[0].low_x - nodes[0].high_x;
    const float y = nodes[1].low_y + nodes[1].high_y - nodes[0].low_y - nodes[0].high_y;
    const float z = nodes[1].low_z + nodes[1].high_z - nodes[0].low_z - nodes[0].high_z;
    return x * first_lane(rays->way.x) + y * first_lane(rays->way.y) + z * first_lane(rays->way.z) < 0.0f;
}

// Finds the first triangle along each ray, before a depth.
CALL_IF_SCALAR Met meet_tree(TREE_PARAMETERS, const MeshSight *const sight, const EyeRays *const rays,
                             const floatv before) {
    const float3v inverse = {safe_inverses(rays->way.x), safe_inverses(rays->way.y), safe_inverses(rays->way.z)};
    Met met;
    met.depth = before;
    met.triangle = (uintv)(NOTHING);
    uint stack[TREE_STACK];
    uint waiting = 0u, number = 0u;
    if (tree_size == 0u)
        return met;
    for (;;) {
        __global const TreeNode *const node = tree_nodes + number;
        if (meet_box(rays, inverse, sight->margin, met.depth, node)) {
            for (uint index = 0u; index < node->count; ++index)
                meet_triangle(sight, rays, tree_triangles, node->first + index, &met);
            if (node->count == 0u) {
                const uint second = is_second_nearer(rays, tree_nodes + node->first) ? 1u : 0u;
                stack[waiting++] = node->first + 1u - second;
                number = node->first + second;
                continue;
            }
        }
        if (waiting == 0u)
            return met;
        number = stack[--waiting];
    }
}

// A single ray: where it begins, and its way by a depth of 1, world axes.
typedef struct {
    float3 origin, way;
} EyeRay;

INLINE EyeRay eye_ray(const MeshSight *const sight, const float column, const float row) {
    const float x = fma(column, sight->step_x, sight->first_x), y = fma(row, sight->step_y, sight->first_y);
    const float3 beside = x * sight->right.xyz + y * sight->down.xyz;
    EyeRay ray;
    ray.origin = sight->is_parallel ? sight->eye.xyz + beside : sight->eye.xyz;
    ray.way = sight->is_parallel ? sight->forward.xyz : sight->forward.xyz + beside;
    return ray;
}
