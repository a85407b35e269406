// The paper's method as it stands in the paper: one pixel a work-item, no lanes, every distance from scratch, square
// roots and divisions, Cardano with cbrt, acos and cos (Watanabe, Abe, Konno 2015, eq. 7, 8-12, 20, 21, 23; appendix
// A). Kept to compare with: benches/tables.rs.
#include "film.h"
#include "view.h"
#include "wave/types.h"

float torus(const float3 p, __global const float *source) {
    const float3 from_center = p - (float3)(source[0], source[1], source[2]);
    const float from_ring = sqrt(from_center.x * from_center.x + from_center.y * from_center.y) - source[3];
    return 1.0f / sqrt(from_ring * from_ring + from_center.z * from_center.z);
}

float distance2_at(const float3 from_c0, const float3 c1, const float3 c2, const float t) {
    const float3 to_point = from_c0 - (c2 * t + c1) * t;
    return dot(to_point, to_point);
}

float offer(const float best, const float3 from_c0, const float3 c1, const float3 c2, const float t) {
    return t > 0.0f && t < 1.0f ? fmin(best, distance2_at(from_c0, c1, c2, t)) : best;
}

float bezier(const float3 point, __global const float *source) {
    const float3 b0 = (float3)(source[0], source[1], source[2]), b1 = (float3)(source[3], source[4], source[5]),
                 b2 = (float3)(source[6], source[7], source[8]);
    const float3 c2 = b0 - 2.0f * b1 + b2, c1 = 2.0f * (b1 - b0), from_c0 = point - b0;
    const float scale = 0.5f / dot(c2, c2);
    const float a = 3.0f * dot(c1, c2) * scale;
    const float b = (dot(c1, c1) - 2.0f * dot(c2, from_c0)) * scale;
    const float c = -dot(c1, from_c0) * scale;
    const float p = b - a * a / 3.0f, q = 2.0f * a * a * a / 27.0f - a * b / 3.0f + c;
    const float r = q * q / 4.0f + p * p * p / 27.0f;
    float best = fmin(distance2_at(from_c0, c1, c2, 0.0f), distance2_at(from_c0, c1, c2, 1.0f));
    if (r > 0.0f) {
        const float u = cbrt(-q / 2.0f + sqrt(r)), v = cbrt(-q / 2.0f - sqrt(r));
        best = offer(best, from_c0, c1, c2, u + v - a / 3.0f);
    } else {
        const float m = 2.0f * sqrt(-p / 3.0f);
        const float angle = acos(clamp(3.0f * q / (p * m), -1.0f, 1.0f)) / 3.0f;
        for (int k = 0; k < 3; ++k)
            best = offer(best, from_c0, c1, c2, m * cos(angle - 2.0943951f * (float)k) - a / 3.0f);
    }
    return 1.0f / sqrt(best);
}

// source: centre and radius of a torus about z, or three control points, seen from the eye; then coefficient, alpha,
// beta.
__kernel void plain(const View view, const FilmPart part, const Integrand integrand, __global const float *source,
                    __global float4 *image) {
    const uint pixel = get_global_id(0);
    if (pixel >= part.count)
        return;
    const float column = (float)(pixel % view.width), row = (float)(pixel / view.width);
    const float3 origin = (view.first_pixel + column * view.column_step + row * view.row_step).xyz;
    const float3 span = normalize(origin) * view.ray_length;
    __global const float *const numbers = source + (IS_TORUS ? 4 : 9);
    const uint divisions = integrand.node_count - 1;
    float sum = 0.0f;
    for (uint k = 0; k <= divisions; ++k) {
        const float s = (float)k / (float)divisions;
        const float zeta = numbers[1] / ((s + numbers[2]) * (s + numbers[2]));
        const float weight = k == 0 || k == divisions ? 1.0f : k % 2 ? 4.0f : 2.0f;
        sum += weight * zeta * (IS_TORUS ? torus(origin + s * span, source) : bezier(origin + s * span, source));
    }
    image[pixel] = (float4)((float3)(numbers[0] * sum / (3.0f * (float)divisions)), 1.0f);
}
