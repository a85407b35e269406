// The light that meshes throw back, by Lambert's law: that from everywhere, of a lamp, and what waves cast. What is
// between counts where there are shadows.
#include "rays.h"

#define VISIBILITY_PARAMETERS , TREE_PARAMETERS
#define VISIBILITY_ARGUMENTS , TREE_ARGUMENTS
#define IS_HIDDEN(from, to) is_hidden(TREE_ARGUMENTS, from, to)
#include "../light/irradiance.h"

// A ray still sees what its length, as it was rounded, ends before by this share.
#define ROUNDING 1e-6f

// Returns a place beyond all meshes in a direction of length 1.
INLINE float3 beyond_meshes(TREE_PARAMETERS, const float3 place, const float3 direction) {
    const float3 low = (float3)(tree_nodes->low_x, tree_nodes->low_y, tree_nodes->low_z);
    const float3 high = (float3)(tree_nodes->high_x, tree_nodes->high_y, tree_nodes->high_z);
    return place + 2.0f * distance(low, high) * direction;
}

// Returns the radiance of a triangle that a ray meets so far along it, in the ray's ways, on the side that it sees.
CALL float3 radiance_of(TREE_PARAMETERS, LIGHTS_PARAMETERS, const MeshLight *const light,
                        __global const float4 *const albedos, __global const MeshTriangle *const triangle,
                        const EyeRay *const ray, const float depth) {
    const float3 corner = (float3)(triangle->a_x, triangle->a_y, triangle->a_z);
    const float3 ab = (float3)(triangle->b_x, triangle->b_y, triangle->b_z) - corner;
    const float3 ac = (float3)(triangle->c_x, triangle->c_y, triangle->c_z) - corner;
    const float3 outside = normalize(cross(ab, ac));
    const float3 normal = dot(outside, ray->way) > 0.0f ? -outside : outside;
    // A little above the triangle's plane, which is not to hide itself, and which depths miss by more than that.
    const float3 met = ray->origin + depth * ray->way;
    const float3 place = met + (tree_margin - dot(met - corner, normal)) * normal;
    float facing = fmax(dot(normal, light->lamp.xyz), 0.0f);
    if (shadow_samples && facing > 0.0f && any(light->sun.xyz > 0.0f) &&
        is_hidden(TREE_ARGUMENTS, place, beyond_meshes(TREE_ARGUMENTS, place, light->lamp.xyz)))
        facing = 0.0f;
    const float3 cast_light = irradiance_at(LIGHTS_ARGUMENTS, place, normal, TREE_ARGUMENTS);
    return albedos[triangle->mesh].xyz * (light->ambient.xyz + facing * light->sun.xyz + (1.0f / PI_F) * cast_light);
}

// Two triangles whose normals' cosine is at least so much have one light in a pixel, where nothing casts shadows.
#define ALIKE 0.9f

// Returns whether two triangles of a pixel have one light.
INLINE bool is_alike(__global const MeshTriangle *const one, __global const MeshTriangle *const other,
                     const uint shadow_samples) {
    return one == other || (!shadow_samples && one->mesh == other->mesh &&
                            dot(normal_of(one->normal), normal_of(other->normal)) >= ALIKE);
}

// Adds up the light of the rays of each pixel that nothing hides, which ends their final lengths.
__kernel void shade_meshes(TREE_PARAMETERS, LIGHTS_PARAMETERS, const MeshSight sight, const MeshLight lit,
                           const uint first_pixel, const uint end_pixel, __global const float4 *const restrict albedos,
                           __global const float *const restrict lengths, __global const uint *const restrict triangles,
                           const uint has_finals, __global const float *const restrict finals,
                           __global float4 *const restrict light) {
    const uint pixel = first_pixel + get_global_id(0);
    if (pixel >= end_pixel)
        return;
    const uint width = sight.width / sight.across, column = pixel % width, row = pixel / width;
    const uint count = sight.across * sight.across;
    float3 sum = (float3)(0.0f), rays = (float3)(0.0f);
    float met = 0.0f;
    uint last = NOTHING;
    for (uint part = 0u; part <= count; ++part) {
        const uint x = column * sight.across + part % sight.across, y = row * sight.across + part / sight.across;
        const uint place = y * sight.width + x;
        const bool is_seen = part < count && triangles[place] != NOTHING &&
                             !(has_finals && lengths[place] > finals[place] * (1.0f + ROUNDING));
        const uint triangle = is_seen ? triangles[place] : NOTHING;
        const bool is_same =
            last != NOTHING && is_seen && is_alike(tree_triangles + triangle, tree_triangles + last, shadow_samples);
        if (!is_same && last != NOTHING) {
            // Rays that meet one triangle, or alike ones, one after another, have the light of their middle.
            const float3 middle = rays / met;
            const EyeRay ray = eye_ray(&sight, middle.x, middle.y);
            sum += met *
                   radiance_of(TREE_ARGUMENTS, LIGHTS_ARGUMENTS, &lit, albedos, tree_triangles + last, &ray, middle.z);
            rays = (float3)(0.0f);
            met = 0.0f;
        }
        last = is_same ? last : triangle;
        if (!is_seen)
            continue;
        const EyeRay ray = eye_ray(&sight, (float)x, (float)y);
        rays += (float3)((float)x, (float)y, lengths[place] / length(ray.way));
        met += 1.0f;
    }
    light[pixel] = (float4)(sum / (float)count, 1.0f);
}

// Finds the irradiance of listed points, for hosts.
__kernel void light_points(TREE_PARAMETERS, LIGHTS_PARAMETERS, const uint first_point, const uint end_point,
                           __global const float4 *const restrict points, __global const float4 *const restrict normals,
                           __global float4 *const restrict irradiances) {
    const uint index = first_point + get_global_id(0);
    if (index >= end_point)
        return;
    const float3 normal = normals[index].xyz;
    const float3 place = points[index].xyz + (shadow_samples ? tree_margin : 0.0f) * normal;
    irradiances[index] = (float4)(irradiance_at(LIGHTS_ARGUMENTS, place, normal, TREE_ARGUMENTS), 0.0f);
}
