// The kernels that find meshes: one ray a pixel, then the finer rays of each pixel. What light meshes throw back,
// shade.cl finds.
//
// Where a pixel and its neighbours see one smooth surface, its finer lengths are those to the plane of its own
// triangle: n.(o + z w) is the same for all of them, o being where a ray begins, w its way and n the plane's normal.
// All other pixels have all of their rays traced.
#include "rays.h"

// A neighbour's depth may lie off the plane by this share of it, and the normals' cosine be so small, in a pixel whose
// finer rays are not traced: then lengths are off by a quarter of that, as half a pixel is to a whole one, squared.
#ifndef FLAT
#define FLAT 4e-5f
#define LEAST_COSINE 0.99f
#endif

// The plane of a triangle, as rays beside the one that meets it see it.
typedef struct {
    float3 normal;
    float depth;             // at which that ray meets it
    float along;             // n.w of that ray
    float by_column, by_row; // how n.w, or of parallel rays n.o, changes from a ray to the next one
    uint is_parallel;
} SeenPlane;

INLINE SeenPlane plane_of(const MeshSight *const sight, const float3 normal, const EyeRay *const ray,
                          const float depth) {
    SeenPlane plane;
    plane.normal = normal;
    plane.depth = depth;
    plane.along = dot(normal, ray->way);
    plane.by_column = sight->step_x * dot(normal, sight->right.xyz);
    plane.by_row = sight->step_y * dot(normal, sight->down.xyz);
    plane.is_parallel = sight->is_parallel;
    return plane;
}

// Returns the depth at which a ray meets it that is so many rays away from that one.
INLINE float depth_on(const SeenPlane *const plane, const float columns, const float rows) {
    const float more = columns * plane->by_column + rows * plane->by_row;
    if (more == 0.0f)
        return plane->depth; // also where the ray lies in the plane
    return plane->is_parallel ? plane->depth - more / plane->along
                              : plane->depth * (plane->along / (plane->along + more));
}

// Returns the middle of a pixel, in rays from the first one.
INLINE float middle_of(const MeshSight *const sight, const uint pixel) {
    return (float)(pixel * sight->across) + 0.5f * (float)(sight->across - 1u);
}

// Traces the ray through the middle of each pixel of blocks: depths along the axis of view, and triangles.
__kernel void trace_pixels(TREE_PARAMETERS, const MeshSight sight, const uint first_block, const uint end_block,
                           __global float *const restrict pixel_depths, __global uint *const restrict pixel_triangles) {
    const uint block = first_block + get_global_id(0);
    if (block >= end_block)
        return;
    const uint width = sight.width / sight.across, height = sight.height / sight.across;
    const uint across = (width + BLOCK_COLUMNS - 1u) / BLOCK_COLUMNS;
    const uintv columns = block % across * BLOCK_COLUMNS + LANE_NUMBERS % BLOCK_COLUMNS;
    const uintv rows = block / across * BLOCK_ROWS + LANE_NUMBERS / BLOCK_COLUMNS;
    // Those beside the picture are as the nearest in it.
    const uintv inside_x = min(columns, (uintv)(width - 1u)), inside_y = min(rows, (uintv)(height - 1u));
    const floatv scale = splat((float)sight.across), middle = splat(middle_of(&sight, 0u));
    const EyeRays rays =
        eye_rays(&sight, fma(to_floatv(inside_x), scale, middle), fma(to_floatv(inside_y), scale, middle));
    const Met met = meet_tree(TREE_ARGUMENTS, &sight, &rays, splat(INFINITY));
    float depths[LANES], triangles[LANES];
    scatter(met.depth, depths), scatter(as_floatv(met.triangle), triangles);
    for (uint lane = 0u; lane < LANES; ++lane) {
        const uint x = block % across * BLOCK_COLUMNS + lane % BLOCK_COLUMNS;
        const uint y = block / across * BLOCK_ROWS + lane / BLOCK_COLUMNS;
        if (x >= width || y >= height)
            continue;
        pixel_depths[y * width + x] = depths[lane];
        pixel_triangles[y * width + x] = as_uint(triangles[lane]);
    }
}

// Returns whether a pixel, which sees this plane, and its neighbours see one smooth surface, or nothing.
INLINE bool is_smooth(const MeshSight *const sight, __global const MeshTriangle *const triangles,
                      const SeenPlane *const plane, const uint column, const uint row,
                      __global const float *const pixel_depths, __global const uint *const pixel_triangles) {
    const uint width = sight->width / sight->across, height = sight->height / sight->across;
    const uint own = pixel_triangles[row * width + column];
    const float scale = (float)sight->across;
    for (uint y = max(row, 1u) - 1u; y < min(row + 2u, height); ++y)
        for (uint x = max(column, 1u) - 1u; x < min(column + 2u, width); ++x) {
            const uint other = pixel_triangles[y * width + x];
            if (other == own)
                continue;
            if (other == NOTHING || own == NOTHING)
                return false;
            const float there = pixel_depths[y * width + x];
            const float columns = (float)((int)x - (int)column), rows = (float)((int)y - (int)row);
            // Which is false of no number, too.
            if (!(fabs(depth_on(plane, scale * columns, scale * rows) - there) <= FLAT * there))
                return false;
            if (fabs(dot(plane->normal, normal_of(triangles[other].normal))) < LEAST_COSINE)
                return false;
        }
    return true;
}

// Returns the length at which the scene's own depths end a ray.
INLINE float given_length(const MeshSight *const sight, __global const float *const depths, const uint column,
                          const uint row, const float longer) {
    if (!sight->has_depth)
        return INFINITY;
    const uint columns = sight->width / sight->depth_step;
    const float given = depths[row / sight->depth_step * columns + column / sight->depth_step];
    return sight->is_along_axis ? given * sight->axis_length * longer : given;
}

// Traces all rays of a pixel, LANES at a time, or gives them the lengths to the plane that its middle meets.
__kernel void trace_rays(TREE_PARAMETERS, const MeshSight sight, const uint first_pixel, const uint end_pixel,
                         __global const float *const restrict pixel_depths,
                         __global const uint *const restrict pixel_triangles,
                         __global const float *const restrict depths, __global float *const restrict lengths,
                         __global uint *const restrict triangles) {
    const uint pixel = first_pixel + get_global_id(0);
    if (pixel >= end_pixel)
        return;
    const uint width = sight.width / sight.across, column = pixel % width, row = pixel / width;
    const uint own = pixel_triangles[pixel], count = sight.across * sight.across;
    const EyeRay middle = eye_ray(&sight, middle_of(&sight, column), middle_of(&sight, row));
    const float3 normal = own == NOTHING ? (float3)(0.0f) : normal_of(tree_triangles[own].normal);
    const SeenPlane plane = plane_of(&sight, normal, &middle, pixel_depths[pixel]);
    const bool is_flat =
        sight.across == 1u || is_smooth(&sight, tree_triangles, &plane, column, row, pixel_depths, pixel_triangles);
    float met[LANES], found[LANES];
    for (uint part = 0u; part < count; ++part) {
        const uint lane = part % LANES;
        if (!is_flat && lane == 0u) {
            const uintv parts = min(part + LANE_NUMBERS, (uintv)(count - 1u));
            const floatv x = to_floatv(column * sight.across + parts % sight.across);
            const floatv y = to_floatv(row * sight.across + parts / sight.across);
            const EyeRays rays = eye_rays(&sight, x, y);
            const Met all = meet_tree(TREE_ARGUMENTS, &sight, &rays, splat(INFINITY));
            scatter(all.depth, met), scatter(as_floatv(all.triangle), found);
        }
        const uint x = column * sight.across + part % sight.across, y = row * sight.across + part / sight.across;
        const EyeRay ray = eye_ray(&sight, (float)x, (float)y);
        const float longer = length(ray.way);
        const float columns = (float)x - middle_of(&sight, column), rows = (float)y - middle_of(&sight, row);
        const float there = !is_flat ? met[lane] : own == NOTHING ? INFINITY : depth_on(&plane, columns, rows);
        const float own_length = there * longer, given = given_length(&sight, depths, x, y, longer);
        const uint triangle = is_flat ? own : as_uint(found[lane]);
        const bool is_seen = triangle != NOTHING && own_length < given;
        lengths[y * sight.width + x] = is_seen ? own_length : given;
        triangles[y * sight.width + x] = is_seen ? triangle : NOTHING;
    }
}
