export const FRAGMENT = `precision highp float;
uniform vec3 iResolution;
out vec4 pixel;
// Written by energywave, MIT OR Apache-2.0.
// Translated from WGSL: '--to wgsl' has the formulas, and the offset of every field of the block.


struct Light {
    vec4 color;
    vec4 core;
};
struct Sphere {
    vec4 center;
    Light light;
};
struct Beam {
    vec4 tip;
    vec4 direction;
    vec4 parts;
    Light light;
};
struct Wave {
    vec4 rays;
    vec4 eye;
    vec4 corner;
    vec4 across;
    vec4 down;
    vec4 forward;
    Sphere spheres[2];
    Beam beams[2];
};
struct Ray {
    vec3 origin;
    vec3 direction;
    float end;
};
struct Quadratic {
    float rate;
    float nearest;
    float least;
};
struct Peak {
    float place;
    float width;
};
struct Stretch {
    float from;
    float to;
    float light_from;
    float light_to;
};
const float NODES[8] = float[8](0.09501251, 0.28160354, 0.45801678, 0.61787623, 0.7554044, 0.8656312, 0.944575, 0.9894009);
const float WEIGHTS[8] = float[8](0.1894506, 0.18260342, 0.16915652, 0.14959599, 0.12462897, 0.09515851, 0.062253524, 0.027152458);



const Wave wave = Wave(
    vec4(16.868927, 0.0, 0.05928059, 2.8456074e-10),
    vec4(0.3, -4.0, 1.2, 1.0),
    vec4(-0.577635, 1.0511913, 0.02386874, 0.0),
    vec4(1.15527, -0.0, 0.0, 0.0),
    vec4(-0.0, -0.18672998, -0.62243325, 0.0),
    vec4(0.0, 0.95782626, -0.28734788, 0.0),
    Sphere[2](
        Sphere(vec4(-1.0, 0.0, 0.0, 0.0), Light(vec4(252.36482, 336.48642, 420.60803, 3.0), vec4(0.0256, 0.0, 2.0736, 19.53125))),
        Sphere(vec4(-1.0, 0.0, 0.0, 0.0), Light(vec4(0.06764856, 0.3382428, 1.3529712, 1.0), vec4(0.04, 0.5102041, 1.96, 0.0)))
    ),
    Beam[2](
        Beam(vec4(-1.0, 0.0, 0.0, 0.0), vec4(0.9515614, 0.2854684, 0.11418737, 0.0), vec4(0.2097651, 0.2097651, 0.0, 0.0), Light(vec4(6.747571, 11.808249, 16.868927, 1.0), vec4(0.0036, 11.111111, 0.09, 0.0))),
        Beam(vec4(-1.0, 0.0, 0.0, 0.0), vec4(0.9515614, 0.2854684, 0.11418737, 0.0), vec4(0.029220091, 0.029220091, 0.0, 0.0), Light(vec4(0.8434464, 4.2172318, 16.868927, 1.0), vec4(0.01, 0.6944444, 1.44, 0.0)))
    )
);
const float EXPOSURE = 1.0;

// Returns the squared distance to a point.
Quadratic to_point(Ray ray, vec3 point, Light light) {
    vec3 start = (ray.origin - point);
    float rough = -(dot(start, ray.direction));
    vec3 beside = (start + (rough * ray.direction));
    float rest = -(dot(beside, ray.direction));
    vec3 closest = (beside + (rest * ray.direction));
    float _e25 = wave.rays.w;
    return Quadratic(1.0, (rough + rest), max((dot(closest, closest) + light.core.x), _e25));
}

// Returns the squared distance to a line: |(P - M) x D|^2, a cross product, where the difference of squares of 2015,
// eq. 3 would cancel.
Quadratic to_line(Ray ray_1, vec3 point_1, vec3 direction, Light light_1) {
    vec3 start_1 = cross((ray_1.origin - point_1), direction);
    vec3 span = cross(ray_1.direction, direction);
    float rate2_ = dot(span, span);
    float per_rate2_ = (1.0 / max(rate2_, 1e-12));
    float rough_1 = (-(dot(start_1, span)) * per_rate2_);
    vec3 beside_1 = cross(((ray_1.origin - point_1) + (rough_1 * ray_1.direction)), direction);
    float rest_1 = (-(dot(beside_1, span)) * per_rate2_);
    vec3 closest_1 = (beside_1 + (rest_1 * span));
    float _e37 = wave.rays.w;
    return Quadratic(sqrt(rate2_), (rough_1 + rest_1), max((dot(closest_1, closest_1) + light_1.core.x), _e37));
}

// Returns where a value that is linear along a ray is 0; a ray where it never is stays on its side.
float zero_along(float at, float slope, float end) {
    return clamp((-(at) / ((abs(slope) < 1e-30) ? 1e-30 : slope)), 0.0, end);
}

// Returns n, whose powers are decays.
float nearness(float x) {
    float _e4 = wave.rays.y;
    float _e8 = wave.rays.y;
    float _e14 = wave.rays.y;
    return ((_e14 > 0.0) ? (_e4 / (x + _e8)) : 1.0);
}

// Returns what is left of light at a place.
float fading(float x_1) {
    float _e1 = nearness(x_1);
    return (_e1 * _e1);
}

// Returns the v of a place.
float mapped(float place, Peak peak) {
    float x_4 = ((place - peak.place) / peak.width);
    return (sign(x_4) * log((abs(x_4) + sqrt(((x_4 * x_4) + 1.0)))));
}

// Returns field times decay, from the squared distance with softening, and the place on the ray.
float faded_field(float softened2_, float x_2, Light light_2) {
    float field = 0.0;
    float bare2_ = max((softened2_ - light_2.core.x), 0.0);
    float _e11 = wave.rays.w;
    float per_q = inversesqrt(max(softened2_, _e11));
    field = ((per_q * ((light_2.color.w > 0.0) ? per_q : 1.0)) * ((light_2.color.w > 1.0) ? per_q : 1.0));
    if ((light_2.color.w > 2.0)) {
        field = exp((-(bare2_) * light_2.core.w));
    }
    float window = max((1.0 - (bare2_ * light_2.core.y)), 0.0);
    float _e48 = wave.rays.z;
    float _e49 = fading(x_2);
    float _e51 = field;
    return ((((_e48 * _e49) * _e51) * window) * window);
}

// Light that ends at a reach h, of a field times (1 - (d/h)^2)^2, the profiles beside 1/q and 1/q^2, and light that fades
// otherwise than by n^2: 16 nodes in x where q^2 hardly changes, else in v of x = sqrt(m) sinh(v), q^2 = x^2 + m, on each
// side of where q is least.
float shaped_panel(Quadratic q, Light light_3, Stretch stretch, float begin, float end_1, bool is_flat) {
    float nodes[8] = NODES;
    float weights[8] = WEIGHTS;
    float sum = 0.0;
    int k = 0;
    float x_3 = 0.0;
    float ahead = 0.0;
    float slope_1 = 0.0;
    float growth = ((stretch.light_to - stretch.light_from) / (stretch.to - stretch.from));
    float root = sqrt(q.least);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            int _e106 = k;
            k = (_e106 + 1);
        }
        loop_init = false;
        int _e23 = k;
        if ((_e23 < 16)) {
        } else {
            break;
        }
        {
            int _e26 = k;
            float _e30 = nodes[(_e26 % 8)];
            int _e31 = k;
            float _e35 = nodes[(_e31 % 8)];
            int _e37 = k;
            float node = ((_e37 < 8) ? -(_e35) : _e30);
            float at_1 = ((0.5 * (begin + end_1)) + ((0.5 * (end_1 - begin)) * node));
            x_3 = at_1;
            ahead = (q.rate * (at_1 - q.nearest));
            slope_1 = 1.0;
            if (!(is_flat)) {
                float grown = exp(at_1);
                ahead = ((0.5 * root) * (grown - (1.0 / grown)));
                float _e66 = ahead;
                x_3 = clamp((q.nearest + (_e66 / q.rate)), stretch.from, stretch.to);
                slope_1 = (((0.5 * root) * (grown + (1.0 / grown))) / q.rate);
            }
            float _e82 = x_3;
            float lit = (stretch.light_from + (growth * (_e82 - stretch.from)));
            float _e87 = sum;
            int _e88 = k;
            float _e92 = weights[(_e88 % 8)];
            float _e94 = slope_1;
            float _e96 = ahead;
            float _e97 = ahead;
            float _e101 = x_3;
            float _e102 = faded_field(((_e96 * _e97) + q.least), _e101, light_3);
            sum = (_e87 + (((_e92 * lit) * _e94) * _e102));
        }
    }
    float _e111 = sum;
    return ((0.5 * (end_1 - begin)) * _e111);
}

// Returns the integral over a stretch, as far as there is light.
float shaped_over(Quadratic q_1, Light light_4, Stretch whole) {
    bool local = false;
    float end2_ = (light_4.core.x + light_4.core.z);
    float half_ = (sqrt(max((end2_ - q_1.least), 0.0)) / max(q_1.rate, 1e-18));
    float from_1 = max(whole.from, (q_1.nearest - half_));
    float to_1 = min(whole.to, (q_1.nearest + half_));
    if (!((to_1 <= from_1))) {
        local = (end2_ <= q_1.least);
    } else {
        local = true;
    }
    bool _e32 = local;
    if (_e32) {
        return 0.0;
    }
    float growth_1 = ((whole.light_to - whole.light_from) / (whole.to - whole.from));
    float light_from = (whole.light_from + (growth_1 * (from_1 - whole.from)));
    Stretch stretch_2 = Stretch(from_1, to_1, light_from, (whole.light_from + (growth_1 * (to_1 - whole.from))));
    float x0_ = (q_1.rate * (from_1 - q_1.nearest));
    float x1_ = (q_1.rate * (to_1 - q_1.nearest));
    float middle = (0.5 * (x0_ + x1_));
    bool is_flat_1 = (((x1_ - x0_) * (x1_ - x0_)) < (1.3 * ((middle * middle) + q_1.least)));
    if (is_flat_1) {
        float _e73 = shaped_panel(q_1, light_4, stretch_2, from_1, to_1, true);
        return _e73;
    }
    Peak peak_1 = Peak(q_1.nearest, (sqrt(q_1.least) / q_1.rate));
    float _e82 = mapped(clamp(q_1.nearest, from_1, to_1), peak_1);
    float _e83 = mapped(from_1, peak_1);
    float _e85 = shaped_panel(q_1, light_4, stretch_2, _e83, _e82, false);
    float _e86 = mapped(to_1, peak_1);
    float _e88 = shaped_panel(q_1, light_4, stretch_2, _e82, _e86, false);
    return (_e85 + _e88);
}

// Returns the integral over a stretch, for a coefficient of 1.
float integral_over(Quadratic q_2, Light light_5, Stretch stretch_1) {
    if ((stretch_1.to <= stretch_1.from)) {
        return 0.0;
    }
    float _e7 = shaped_over(q_2, light_5, stretch_1);
    return _e7;
}

Stretch evenly_lit(float from, float to) {
    return Stretch(from, to, 1.0, 1.0);
}

float sphere_light(Ray ray_2, Sphere sphere) {
    Quadratic _e5 = to_point(ray_2, sphere.center.xyz, sphere.light);
    Stretch _e9 = evenly_lit(0.0, ray_2.end);
    float _e10 = integral_over(_e5, sphere.light, _e9);
    return _e10;
}

float beam_light(Ray ray_3, Beam beam) {
    float light_6 = 0.0;
    Quadratic _e7 = to_line(ray_3, beam.tip.xyz, beam.direction.xyz, beam.light);
    Quadratic _e11 = to_point(ray_3, beam.tip.xyz, beam.light);
    float height = dot((ray_3.origin - beam.tip.xyz), beam.direction.xyz);
    float slope_2 = dot(ray_3.direction, beam.direction.xyz);
    bool is_rising = (slope_2 > -1e-30);
    float _e26 = zero_along(height, slope_2, ray_3.end);
    Stretch _e31 = evenly_lit((is_rising ? _e26 : 0.0), (is_rising ? ray_3.end : _e26));
    float _e35 = integral_over(_e7, beam.light, _e31);
    light_6 = (beam.parts.x * _e35);
    if ((beam.parts.w > 0.0)) {
        float fade = ((height * beam.parts.w) + 1.0);
        float growth_2 = (slope_2 * beam.parts.w);
        float _e51 = zero_along(fade, growth_2, ray_3.end);
        float from_2 = min(_e26, _e51);
        float to_2 = max(_e26, _e51);
        vec2 lit_1 = clamp(vec2(((growth_2 * from_2) + fade), ((growth_2 * to_2) + fade)), vec2(0.0), vec2(1.0));
        float _e64 = light_6;
        float _e71 = integral_over(_e7, beam.light, Stretch(from_2, to_2, lit_1.x, lit_1.y));
        light_6 = (_e64 + (beam.parts.x * _e71));
    } else {
        Stretch _e78 = evenly_lit((is_rising ? 0.0 : _e26), (is_rising ? _e26 : ray_3.end));
        float _e79 = light_6;
        float _e83 = integral_over(_e11, beam.light, _e78);
        light_6 = (_e79 + (beam.parts.y * _e83));
    }
    float _e86 = light_6;
    Stretch _e92 = evenly_lit(0.0, ray_3.end);
    float _e93 = integral_over(_e11, beam.light, _e92);
    return (_e86 + (beam.parts.z * _e93));
}

// Returns the light along a ray: linear RGB. The direction is of length 1, depth the length at which
// the ray is hidden, world units from its origin.
vec3 wave_light(vec3 origin, vec3 direction_1, float depth) {
    vec3 light_7 = vec3(0.0);
    int i = 0;
    int i_1 = 0;
    float _e6 = wave.rays.x;
    Ray ray_4 = Ray(origin, direction_1, clamp(depth, 0.0, _e6));
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            int _e36 = i;
            i = (_e36 + 1);
        }
        loop_init_1 = false;
        int _e15 = i;
        if ((_e15 < 2)) {
        } else {
            break;
        }
        {
            vec3 _e18 = light_7;
            int _e21 = i;
            Sphere _e23 = wave.spheres[_e21];
            float _e24 = sphere_light(ray_4, _e23);
            int _e27 = i;
            vec4 _e31 = wave.spheres[_e27].light.color;
            light_7 = (_e18 + (_e24 * _e31.xyz));
        }
    }
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            int _e61 = i_1;
            i_1 = (_e61 + 1);
        }
        loop_init_2 = false;
        int _e40 = i_1;
        if ((_e40 < 2)) {
        } else {
            break;
        }
        {
            vec3 _e43 = light_7;
            int _e46 = i_1;
            Beam _e48 = wave.beams[_e46];
            float _e49 = beam_light(ray_4, _e48);
            int _e52 = i_1;
            vec4 _e56 = wave.beams[_e52].light.color;
            light_7 = (_e43 + (_e49 * _e56.xyz));
        }
    }
    vec3 _e63 = light_7;
    return _e63;
}
// The picture by the scene's own camera, upright in any window, with the scene's exposure.
void mainImage(out vec4 color, in vec2 pixel) {
    float wider = iResolution.x * length(wave.down.xyz) / (iResolution.y * length(wave.across.xyz));
    vec2 uv = vec2(0.5 + (pixel.x / iResolution.x - 0.5) * wider, 1.0 - pixel.y / iResolution.y);
    vec3 on_plane = wave.corner.xyz + uv.x * wave.across.xyz + uv.y * wave.down.xyz; // seen from the eye
    vec3 direction = wave.eye.w > 0.0 ? normalize(on_plane) : wave.forward.xyz;
    vec3 light = wave_light(wave.eye.xyz + on_plane, direction, wave.rays.x);
    color = vec4(pow(1.0 - exp(-EXPOSURE * light), vec3(1.0 / 2.2)), 1.0);
}

void main() {
    mainImage(pixel, gl_FragCoord.xy);
}
`;
