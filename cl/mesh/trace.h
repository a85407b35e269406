// Single rays against a tree of triangles: is anything between two places?
//
// Triangles are met as Woop, Benthin, Wald 2013 do: places are turned and sheared until the ray is the third axis, then
// three edge functions tell on which side of each edge it passes. Two triangles that share an edge compute the same
// number for it but for the sign, so no ray slips between them: products are rounded monotonically, so a rounded
// difference of two has the sign of the true one or is 0, and 0 counts as inside. That holds only if no product is
// fused with the difference. Boxes are met as Ize 2013 does: a little farther than rounding can bring.
#pragma once
#include "../lanes.h"
#include "types.h"

#pragma OPENCL FP_CONTRACT OFF

// What a kernel that looks into the tree has among its parameters, and hands on.
#define TREE_PARAMETERS                                                                                                \
    __global const TreeNode *const restrict tree_nodes, __global const MeshTriangle *const restrict tree_triangles,    \
        const uint tree_size, const float tree_margin
#define TREE_ARGUMENTS tree_nodes, tree_triangles, tree_size, tree_margin

// Boxes that wait, at most: the host builds no deeper tree.
#define TREE_STACK 64

// Relative error of where a ray enters a box or leaves it (Ize 2013): 1 + 2 gamma(3), rounded up.
#define WIDER_BOX 1.0000008f

// A component of a direction is taken for no less: boxes are then met in numbers that are finite.
#define LEAST_COMPONENT 1e-20f

// Returns on which side of the edge from a to b the third axis is: twice the area that they span with it.
INLINE float edge_side(const float a_x, const float a_y, const float b_x, const float b_y) {
#ifdef FUSED_EDGES
    return fma(a_x, b_y, -(a_y * b_x));
#else
    return a_x * b_y - a_y * b_x;
#endif
}

// Returns a normal of 32 bits (octahedral: Meyer et al. 2010).
INLINE float3 normal_of(const uint bits) {
    const float x = (float)(bits & 0xffffu) * (2.0f / 65535.0f) - 1.0f;
    const float y = (float)(bits >> 16) * (2.0f / 65535.0f) - 1.0f;
    const float z = 1.0f - fabs(x) - fabs(y);
    const float fold = fmax(-z, 0.0f);
    return normalize((float3)(x - copysign(fold, x), y - copysign(fold, y), z));
}

INLINE float safe_inverse(const float x) {
    return 1.0f / copysign(fmax(fabs(x), LEAST_COMPONENT), x);
}

// A ray from a place through another, which is at 1 along it.
typedef struct {
    float3 from, inverse;   // where it begins, and one over its direction
    uint axis;              // the one along which it goes farthest
    float shear_x, shear_y; // by how much the others change along that
    float inverse_along;    // one over how far it goes along that
    float least, most;      // what is met between these counts
    float wider;            // boxes are so much wider: turning and shearing moves no corner by more
} TreeRay;

// Returns a vector with an axis as its third, turned.
INLINE float3 turned_to(const float3 v, const uint axis) {
    return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v;
}

INLINE TreeRay tree_ray(const float3 from, const float3 to, const float margin) {
    TreeRay ray;
    const float3 way = to - from, size = fabs(way);
    ray.from = from;
    ray.inverse = (float3)(safe_inverse(way.x), safe_inverse(way.y), safe_inverse(way.z));
    ray.axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
    const float3 turned = turned_to(way, ray.axis);
    ray.inverse_along = 1.0f / turned.z;
    ray.shear_x = turned.x * ray.inverse_along;
    ray.shear_y = turned.y * ray.inverse_along;
    const float3 far = fabs(from);
    ray.wider = fma(3e-7f, fmax(far.x, fmax(far.y, far.z)), margin);
    ray.least = margin / length(way);
    ray.most = 1.0f - ray.least;
    return ray;
}

INLINE bool meets_box(const TreeRay *const ray, __global const TreeNode *const node) {
    const float3 low = ((float3)(node->low_x, node->low_y, node->low_z) - ray->from - ray->wider) * ray->inverse;
    const float3 high = ((float3)(node->high_x, node->high_y, node->high_z) - ray->from + ray->wider) * ray->inverse;
    const float3 enter = fmin(low, high), leave = fmax(low, high);
    const float first = fmax(fmax(enter.x, enter.y), fmax(enter.z, ray->least));
    const float last = fmin(fmin(leave.x, leave.y), fmin(leave.z, ray->most));
    return first <= last * WIDER_BOX;
}

// Returns a corner, seen from the ray's begin, so turned and sheared that the ray is the third axis.
INLINE float3 sheared(const TreeRay *const ray, const float x, const float y, const float z) {
    const float3 turned = turned_to((float3)(x, y, z) - ray->from, ray->axis);
    return (float3)(fma(-ray->shear_x, turned.z, turned.x), fma(-ray->shear_y, turned.z, turned.y), turned.z);
}

INLINE bool meets_triangle(const TreeRay *const ray, __global const MeshTriangle *const triangle) {
    const float3 a = sheared(ray, triangle->a_x, triangle->a_y, triangle->a_z);
    const float3 b = sheared(ray, triangle->b_x, triangle->b_y, triangle->b_z);
    const float3 c = sheared(ray, triangle->c_x, triangle->c_y, triangle->c_z);
    const float of_a = edge_side(c.x, c.y, b.x, b.y);
    const float of_b = edge_side(a.x, a.y, c.x, c.y);
    const float of_c = edge_side(b.x, b.y, a.x, a.y);
#ifdef OPEN_EDGES
    const bool is_inside = fmin(of_a, fmin(of_b, of_c)) > 0.0f || fmax(of_a, fmax(of_b, of_c)) < 0.0f;
#else
    const bool is_inside = fmin(of_a, fmin(of_b, of_c)) >= 0.0f || fmax(of_a, fmax(of_b, of_c)) <= 0.0f;
#endif
    const float all = of_a + of_b + of_c;
    if (!is_inside || all == 0.0f)
        return false;
    const float place = (of_a * a.z + of_b * b.z + of_c * c.z) / all * ray->inverse_along;
    return place > ray->least && place < ray->most;
}

// Returns whether a triangle lies strictly between two places, seen from the tree's origin: those within `tree_margin`
// of either count for nothing, so that a surface does not hide itself. That is a length, which rounding moves no place
// by; where a ray may leave a surface under a small angle, begin as far above it.
CALL bool is_hidden(TREE_PARAMETERS, const float3 from, const float3 to) {
    const TreeRay ray = tree_ray(from, to, tree_margin);
    uint stack[TREE_STACK];
    uint waiting = 0u, number = 0u;
    if (tree_size == 0u || !(ray.least < ray.most))
        return false;
    for (;;) {
        __global const TreeNode *const node = tree_nodes + number;
        if (meets_box(&ray, node)) {
            for (uint index = 0u; index < node->count; ++index)
                if (meets_triangle(&ray, tree_triangles + node->first + index))
                    return true;
            if (node->count == 0u) {
                stack[waiting++] = node->first + 1u;
                number = node->first;
                continue;
            }
        }
        if (waiting == 0u)
            return false;
        number = stack[--waiting];
    }
}
