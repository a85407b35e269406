// The light that meshes throw back, by Lambert's law: that from everywhere, of a lamp, and what waves cast. Pixels of a
// block are shaded side by side; where meshes cast shadows (-D SHADOWS) a block is a pixel.
#include "rays.h"

#ifdef SHADOWS
#define VISIBILITY_PARAMETERS , TREE_PARAMETERS
#define VISIBILITY_ARGUMENTS , TREE_ARGUMENTS
#define SINGLE(place) ((float3)((place).x, (place).y, (place).z))
#define IS_HIDDEN(from, to) is_hidden(TREE_ARGUMENTS, SINGLE(from), SINGLE(to))
#endif
#include "../light/irradiance.h"

// A ray still sees what its length, as it was rounded, ends before by this share.
#define ROUNDING 1e-6f

// Two triangles whose normals' cosine is at least so much have one light in a pixel, where nothing casts shadows.
#define ALIKE 0.9f

// Rays of a pixel that meet one triangle, or alike ones: their sums, one triangle of them, and how many there are.
typedef struct {
    float columns, rows, lengths, count;
    uint triangle;
} Run;

// The same of each pixel of a block: the means, and corners and albedo of the triangle.
typedef struct {
    float column[LANES], row[LANES], length[LANES], count[LANES];
    float corners[9][LANES], albedo[3][LANES];
} Runs;

// What rays met.
typedef struct {
    __global const float *lengths;
    __global const uint *triangles;
    __global const float *finals;
    uint has_finals;
} MetRays;

// Returns whether two triangles have one light in a pixel.
INLINE bool is_alike(__global const MeshTriangle *const one, __global const MeshTriangle *const other) {
#ifdef SHADOWS
    return one == other;
#else
    return one == other || (one->mesh == other->mesh && dot(normal_of(one->normal), normal_of(other->normal)) >= ALIKE);
#endif
}

// Returns the next rays of a pixel, from one of its columns and rows on, that go together; none at the end.
INLINE Run next_run(TREE_PARAMETERS, const MeshSight *const sight, const MetRays *const met, const uint column,
                    const uint row, uint2 *const next) {
    Run run = {0.0f, 0.0f, 0.0f, 0.0f, NOTHING};
    for (; next->y < sight->across; ++next->y, next->x = 0u)
        for (; next->x < sight->across; ++next->x) {
            const uint x = column * sight->across + next->x, y = row * sight->across + next->y;
            const uint place = y * sight->width + x;
            const uint triangle = met->triangles[place];
            const float length = met->lengths[place];
            if (triangle == NOTHING || (met->has_finals && length > met->finals[place] * (1.0f + ROUNDING)))
                continue;
            if (run.triangle == NOTHING)
                run.triangle = triangle;
            else if (!is_alike(tree_triangles + triangle, tree_triangles + run.triangle))
                return run;
            run.columns += (float)x, run.rows += (float)y, run.lengths += length, run.count += 1.0f;
        }
    return run;
}

// Makes a run one of a block's.
INLINE void put_run(Runs *const runs, const uint lane, const Run *const run,
                    __global const MeshTriangle *const triangle, const float4 albedo) {
    const float share = 1.0f / fmax(run->count, 1.0f);
    runs->column[lane] = share * run->columns, runs->row[lane] = share * run->rows;
    runs->length[lane] = share * run->lengths, runs->count[lane] = run->count;
    const float corners[9] = {triangle->a_x, triangle->a_y, triangle->a_z, triangle->b_x, triangle->b_y,
                              triangle->b_z, triangle->c_x, triangle->c_y, triangle->c_z};
    for (uint index = 0u; index < 9u; ++index)
        runs->corners[index][lane] = corners[index];
    runs->albedo[0][lane] = albedo.x, runs->albedo[1][lane] = albedo.y, runs->albedo[2][lane] = albedo.z;
}

INLINE float3v three_lanes(float (*const from)[LANES]) {
    const float3v r = {LOAD_LANES(from[0]), LOAD_LANES(from[1]), LOAD_LANES(from[2])};
    return r;
}

INLINE float3v normalize3(const float3v a) {
    return scale3(a, 1.0f / sqrt(dot3(a, a)));
}

#ifdef SHADOWS
// Returns a place beyond all meshes in a direction of length 1.
INLINE float3v beyond_meshes(TREE_PARAMETERS, const float3v place, const float3v direction) {
    const float3 low = (float3)(tree_nodes->low_x, tree_nodes->low_y, tree_nodes->low_z);
    const float3 high = (float3)(tree_nodes->high_x, tree_nodes->high_y, tree_nodes->high_z);
    return fma3(direction, 2.0f * distance(low, high), place);
}
#endif

// Returns the radiance of the triangles that rays meet, on the sides that they see.
CALL float3v radiance_of(TREE_PARAMETERS, LIGHTS_PARAMETERS, const MeshLight *const light, const MeshSight *const sight,
                         Runs *const runs) {
    const float3v corner = three_lanes(runs->corners);
    const float3v ab = subtract3(three_lanes(runs->corners + 3), corner);
    const float3v ac = subtract3(three_lanes(runs->corners + 6), corner);
    const EyeRays rays = eye_rays(sight, LOAD_LANES(runs->column), LOAD_LANES(runs->row));
    const float3v outside = normalize3(cross3(ab, ac));
    const float3v normal = select3(outside, scale3(outside, splat(-1.0f)), dot3(outside, rays.way) > 0.0f);
    // A little above the triangle's plane, which is not to hide itself, and which depths miss by more than that.
    const float3v met = fma3(rays.way, LOAD_LANES(runs->length) / rays.longer, rays.origin);
    const float3v place = fma3(normal, tree_margin - dot3(subtract3(met, corner), normal), met);
    const float3v lamp = uniform3(light->lamp);
    floatv facing = fmax(dot3(normal, lamp), 0.0f);
#ifdef SHADOWS
    if (facing > 0.0f && any(light->sun.xyz > 0.0f) && IS_HIDDEN(place, beyond_meshes(TREE_ARGUMENTS, place, lamp)))
        facing = 0.0f;
#endif
    const float3v cast_light = irradiance_at(LIGHTS_ARGUMENTS, place, normal VISIBILITY_ARGUMENTS);
    const float3v others = fma3(uniform3(light->sun), facing, uniform3(light->ambient));
    const float3v all = fma3(cast_light, splat(1.0f / PI_F), others), albedo = three_lanes(runs->albedo);
    const float3v radiance = {albedo.x * all.x, albedo.y * all.y, albedo.z * all.z};
    return radiance;
}

// Adds up the light of the rays of each pixel of blocks that nothing hides, which ends their final lengths.
__kernel void shade_meshes(TREE_PARAMETERS, LIGHTS_PARAMETERS, const MeshSight sight, const MeshLight lit,
                           const uint first_block, const uint end_block, __global const float4 *const restrict albedos,
                           __global const float *const restrict lengths, __global const uint *const restrict triangles,
                           const uint has_finals, __global const float *const restrict finals,
                           __global float4 *const restrict light) {
    const uint block = first_block + get_global_id(0);
    if (block >= end_block)
        return;
    const uint width = sight.width / sight.across, height = sight.height / sight.across;
    const uint across = (width + BLOCK_COLUMNS - 1u) / BLOCK_COLUMNS;
    const uint first_column = block % across * BLOCK_COLUMNS, first_row = block / across * BLOCK_ROWS;
    const MetRays met = {lengths, triangles, finals, has_finals};
    float3v sum = uniform3((float4)(0.0f));
    uint2 next[LANES];
    for (uint lane = 0u; lane < LANES; ++lane)
        next[lane] = (uint2)(0u);
    for (;;) {
        Runs runs;
        float count = 0.0f;
        for (uint lane = 0u; lane < LANES; ++lane) {
            const uint column = first_column + lane % BLOCK_COLUMNS, row = first_row + lane / BLOCK_COLUMNS;
            Run run = {0.0f, 0.0f, 0.0f, 0.0f, NOTHING};
            if (column < width && row < height)
                run = next_run(TREE_ARGUMENTS, &sight, &met, column, row, next + lane);
            const uint triangle = run.triangle == NOTHING ? 0u : run.triangle;
            put_run(&runs, lane, &run, tree_triangles + triangle, albedos[tree_triangles[triangle].mesh]);
            count += run.count;
        }
        if (count == 0.0f)
            break;
        const float3v radiance = radiance_of(TREE_ARGUMENTS, LIGHTS_ARGUMENTS, &lit, &sight, &runs);
        const floatv rays = LOAD_LANES(runs.count);
        sum = select3(sum, fma3(radiance, rays, sum), rays > 0.0f);
    }
    sum = scale3(sum, splat(1.0f / (float)(sight.across * sight.across)));
    float red[LANES], green[LANES], blue[LANES];
    scatter(sum.x, red), scatter(sum.y, green), scatter(sum.z, blue);
    for (uint lane = 0u; lane < LANES; ++lane) {
        const uint column = first_column + lane % BLOCK_COLUMNS, row = first_row + lane / BLOCK_COLUMNS;
        if (column < width && row < height)
            light[row * width + column] = (float4)(red[lane], green[lane], blue[lane], 1.0f);
    }
}

// Returns places of a list from one on, a lane each; behind its end the last one.
INLINE float3v listed(__global const float4 *const list, const uint first, const uint end) {
    float x[LANES], y[LANES], z[LANES];
    for (uint lane = 0u; lane < LANES; ++lane) {
        const float4 place = list[min(first + lane, end - 1u)];
        x[lane] = place.x, y[lane] = place.y, z[lane] = place.z;
    }
    const float3v r = {LOAD_LANES(x), LOAD_LANES(y), LOAD_LANES(z)};
    return r;
}

// Finds the irradiance of listed points, for hosts; a block are LANES of them.
__kernel void light_points(TREE_PARAMETERS, LIGHTS_PARAMETERS, const uint first_block, const uint end_block,
                           const uint end_point, __global const float4 *const restrict points,
                           __global const float4 *const restrict normals, __global float4 *const restrict irradiances) {
    const uint block = first_block + get_global_id(0), first = block * LANES;
    if (block >= end_block)
        return;
    const float3v normal = listed(normals, first, end_point);
    float3v place = listed(points, first, end_point);
#ifdef SHADOWS
    place = fma3(normal, tree_margin, place);
#endif
    const float3v found = irradiance_at(LIGHTS_ARGUMENTS, place, normal VISIBILITY_ARGUMENTS);
    float red[LANES], green[LANES], blue[LANES];
    scatter(found.x, red), scatter(found.y, green), scatter(found.z, blue);
    for (uint lane = 0u; lane < LANES && first + lane < end_point; ++lane)
        irradiances[first + lane] = (float4)(red[lane], green[lane], blue[lane], 0.0f);
}
