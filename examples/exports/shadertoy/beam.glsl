// Written by energywave, MIT OR Apache-2.0.
// Translated from WGSL: `--to wgsl` has the formulas, and the offset of every field of the block.


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
struct Ends {
    float advance;
    float n0_;
    float n1_;
    float l0_;
    float l1_;
    float f0_;
    float f1_;
    float g;
    float a;
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

// Returns n, whose square is the decay.
float nearness(float x) {
    float _e4 = wave.rays.y;
    float _e8 = wave.rays.y;
    float _e14 = wave.rays.y;
    return ((_e14 > 0.0) ? (_e4 / (x + _e8)) : 1.0);
}

Peak peak_at(float place, float distance2_, Light light_2) {
    float _e9 = wave.rays.w;
    return Peak(place, sqrt(max((distance2_ + light_2.core.x), _e9)));
}

// Returns the v of a place.
float mapped(float place_1, Peak peak) {
    float x_3 = ((place_1 - peak.place) / peak.width);
    return (sign(x_3) * log((abs(x_3) + sqrt(((x_3 * x_3) + 1.0)))));
}

// Returns field times decay, from the squared distance with softening, and the place on the ray.
float faded_field(float softened2_, float x_1, Light light_3) {
    float field = 0.0;
    float bare2_ = max((softened2_ - light_3.core.x), 0.0);
    float _e11 = wave.rays.w;
    float per_q = inversesqrt(max(softened2_, _e11));
    field = ((per_q * ((light_3.color.w > 0.0) ? per_q : 1.0)) * ((light_3.color.w > 1.0) ? per_q : 1.0));
    if ((light_3.color.w > 2.0)) {
        field = exp((-(bare2_) * light_3.core.w));
    }
    float window = max((1.0 - (bare2_ * light_3.core.y)), 0.0);
    float _e45 = nearness(x_1);
    float _e49 = wave.rays.z;
    float _e52 = field;
    return (((((_e49 * _e45) * _e45) * _e52) * window) * window);
}

Ends ends_of(Quadratic q, Stretch stretch) {
    Ends ends = Ends(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    float x0_ = (q.rate * (stretch.from - q.nearest));
    float x1_ = (q.rate * (stretch.to - q.nearest));
    float _e15 = nearness(stretch.from);
    ends.n0_ = _e15;
    float _e18 = nearness(stretch.to);
    ends.n1_ = _e18;
    float _e24 = ends.n0_;
    float _e27 = ends.n1_;
    ends.advance = (((stretch.to - stretch.from) * _e24) * _e27);
    float _e31 = ends.n0_;
    ends.l0_ = (_e31 * stretch.light_from);
    float _e36 = ends.n1_;
    ends.l1_ = (_e36 * stretch.light_to);
    float _e41 = ends.n0_;
    ends.f0_ = (_e41 * sqrt(((x0_ * x0_) + q.least)));
    float _e49 = ends.n1_;
    ends.f1_ = (_e49 * sqrt(((x1_ * x1_) + q.least)));
    float _e57 = ends.n0_;
    float _e59 = ends.n1_;
    ends.g = ((_e57 * _e59) * ((x0_ * x1_) + q.least));
    ends.a = (q.rate * q.rate);
    float _e72 = wave.rays.y;
    if ((_e72 > 0.0)) {
        float _e79 = wave.rays.y;
        float pole = (q.rate * (_e79 + q.nearest));
        float _e90 = wave.rays.y;
        float _e94 = wave.rays.y;
        ends.a = (((pole * pole) + q.least) / (_e90 * _e94));
    }
    Ends _e97 = ends;
    return _e97;
}

// Returns the integral of the light times n / f over v.
float inverse_over(Ends ends_1, Quadratic q_1) {
    float excess = 0.04761905;
    int odd = 19;
    vec2 parts = vec2(0.0);
    float sum_2 = (ends_1.f0_ + ends_1.f1_);
    float ratio = (ends_1.advance / max(sum_2, 1e-30));
    float m2_ = ((ends_1.a * ratio) * ratio);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            int _e26 = odd;
            odd = (_e26 - 2);
        }
        loop_init = false;
        int _e16 = odd;
        if ((_e16 > 1)) {
        } else {
            break;
        }
        {
            float _e19 = excess;
            int _e21 = odd;
            excess = ((_e19 * m2_) + (1.0 / float(_e21)));
        }
    }
    if ((m2_ >= 0.2)) {
        float whole_1 = (sum_2 + (sqrt(ends_1.a) * ends_1.advance));
        float turn = (q_1.rate * ends_1.advance);
        parts = vec2((whole_1 * whole_1), (2.0 * ((ends_1.f0_ * ends_1.f1_) + ends_1.g)));
        if ((ends_1.g < 0.0)) {
            parts = vec2(((whole_1 * whole_1) * ((ends_1.f0_ * ends_1.f1_) - ends_1.g)), (((2.0 * q_1.least) * turn) * turn));
        }
        float _e66 = parts.x;
        float _e68 = parts.y;
        float artanh = (0.5 * log((_e66 / max(_e68, 1e-36))));
        float per_m = inversesqrt(m2_);
        excess = ((((artanh * per_m) - 1.0) * per_m) * per_m);
    }
    float mean = (0.5 * (ends_1.l0_ + ends_1.l1_));
    float bent = ((m2_ * mean) - (((0.5 * (ends_1.l1_ - ends_1.l0_)) * (ends_1.f1_ - ends_1.f0_)) / max(sum_2, 1e-30)));
    float _e102 = excess;
    return ((2.0 * ratio) * ((bent * _e102) + mean));
}

// Returns the integral of the light times n^2 / f^2 over v: by four Gauss-Legendre nodes where f hardly changes, else an
// angle, a logarithm and what is left of the stretch.
float inverse_square_over(Ends ends_2, Quadratic q_2) {
    float sum = 0.0;
    int k = 0;
    bool local = false;
    float angle = 0.0;
    float d = ends_2.advance;
    float rise = ((ends_2.f1_ - ends_2.f0_) * (ends_2.f1_ + ends_2.f0_));
    float bulge = (((0.25 * ends_2.a) * d) * d);
    float middle2_ = ((0.5 * ((ends_2.f0_ * ends_2.f0_) + (ends_2.f1_ * ends_2.f1_))) - bulge);
    float mean_l = (0.5 * (ends_2.l0_ + ends_2.l1_));
    float mean_n = (0.5 * (ends_2.n0_ + ends_2.n1_));
    if ((bulge <= (0.1 * middle2_))) {
        bool loop_init_1 = true;
        while(true) {
            if (!loop_init_1) {
                int _e95 = k;
                k = (_e95 + 1);
            }
            loop_init_1 = false;
            int _e42 = k;
            if ((_e42 < 4)) {
            } else {
                break;
            }
            {
                int _e45 = k;
                if (!((_e45 == 0))) {
                    int _e51 = k;
                    local = (_e51 == 3);
                } else {
                    local = true;
                }
                bool is_outer = local;
                int _e59 = k;
                float x_4 = ((is_outer ? 0.8611363 : 0.33998105) * ((_e59 < 2) ? -1.0 : 1.0));
                float weight = (is_outer ? 0.34785485 : 0.65214515);
                float light_9 = ((mean_l + ((0.5 * (ends_2.l1_ - ends_2.l0_)) * x_4)) * (mean_n + ((0.5 * (ends_2.n1_ - ends_2.n0_)) * x_4)));
                float _e84 = sum;
                sum = (_e84 + ((weight * light_9) / ((((bulge * x_4) + (0.5 * rise)) * x_4) + middle2_)));
            }
        }
        float _e99 = sum;
        return ((0.5 * d) * _e99);
    }
    float root = (sqrt(q_2.least) * q_2.rate);
    float per_sum = (1.0 / max(((ends_2.f0_ * ends_2.f1_) + abs(ends_2.g)), 1e-36));
    angle = (2.0 * atan(min(((root * d) * per_sum), 1.0)));
    float _e123 = angle;
    float _e124 = angle;
    angle = (((ends_2.g < 0.0) ? (3.1415927 - _e124) : _e123) / max(root, 1e-30));
    float growth = log((ends_2.f1_ / max(ends_2.f0_, 1e-18)));
    float per_a = (1.0 / max(ends_2.a, 1e-30));
    float per_d = (1.0 / max(d, 1e-30));
    float to_peak = ((((-0.5 * rise) * per_a) * per_d) * per_d);
    float slope_l = (ends_2.l1_ - ends_2.l0_);
    float slope_n = (ends_2.n1_ - ends_2.n0_);
    float peak_l = ((slope_l * to_peak) + mean_l);
    float peak_n = ((slope_n * to_peak) + mean_n);
    float curvature = ((((slope_l * slope_n) * per_d) * per_d) * per_a);
    float slope_2 = ((((peak_l * slope_n) + (peak_n * slope_l)) * per_d) * per_a);
    float at_peak = ((peak_l * peak_n) - (((curvature * per_a) * root) * root));
    float _e178 = angle;
    return (((at_peak * _e178) + (slope_2 * growth)) + (curvature * d));
}

// Light that ends at a reach h, of a field times (1 - (d/h)^2)^2, and the profiles beside 1/q and 1/q^2.
//
// Light that does not fade has a closed form for 1/q^2: with q^2 = x^2 + m, and E the q^2 at which it ends, the window is
// (E - q^2)^2 / h^4, and what is to be known are the integrals of q^-2, 1 and q^2. They cancel where q^2 hardly changes.
// There, and for all the rest, 16 nodes serve in x, or in v of x = sqrt(m) sinh(v) on each side of where q is least.
float shaped_panel(Quadratic q_3, Light light_4, Stretch stretch_1, float begin, float end_1, bool is_flat) {
    float nodes[8] = NODES;
    float weights[8] = WEIGHTS;
    float sum_1 = 0.0;
    int k_1 = 0;
    float x_2 = 0.0;
    float ahead = 0.0;
    float slope_1 = 0.0;
    float growth_1 = ((stretch_1.light_to - stretch_1.light_from) / (stretch_1.to - stretch_1.from));
    float root_1 = sqrt(q_3.least);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            int _e106 = k_1;
            k_1 = (_e106 + 1);
        }
        loop_init_2 = false;
        int _e23 = k_1;
        if ((_e23 < 16)) {
        } else {
            break;
        }
        {
            int _e26 = k_1;
            float _e30 = nodes[(_e26 % 8)];
            int _e31 = k_1;
            float _e35 = nodes[(_e31 % 8)];
            int _e37 = k_1;
            float node = ((_e37 < 8) ? -(_e35) : _e30);
            float at_1 = ((0.5 * (begin + end_1)) + ((0.5 * (end_1 - begin)) * node));
            x_2 = at_1;
            ahead = (q_3.rate * (at_1 - q_3.nearest));
            slope_1 = 1.0;
            if (!(is_flat)) {
                float grown = exp(at_1);
                ahead = ((0.5 * root_1) * (grown - (1.0 / grown)));
                float _e66 = ahead;
                x_2 = clamp((q_3.nearest + (_e66 / q_3.rate)), stretch_1.from, stretch_1.to);
                slope_1 = (((0.5 * root_1) * (grown + (1.0 / grown))) / q_3.rate);
            }
            float _e82 = x_2;
            float lit = (stretch_1.light_from + (growth_1 * (_e82 - stretch_1.from)));
            float _e87 = sum_1;
            int _e88 = k_1;
            float _e92 = weights[(_e88 % 8)];
            float _e94 = slope_1;
            float _e96 = ahead;
            float _e97 = ahead;
            float _e101 = x_2;
            float _e102 = faded_field(((_e96 * _e97) + q_3.least), _e101, light_4);
            sum_1 = (_e87 + (((_e92 * lit) * _e94) * _e102));
        }
    }
    float _e111 = sum_1;
    return ((0.5 * (end_1 - begin)) * _e111);
}

// Returns the integral over a stretch, as far as there is light.
float shaped_over(Quadratic q_4, Light light_5, Stretch whole) {
    bool local_1 = false;
    bool local_2 = false;
    bool local_3 = false;
    float end2_ = (light_5.core.x + light_5.core.z);
    float half_ = (sqrt(max((end2_ - q_4.least), 0.0)) / max(q_4.rate, 1e-18));
    float from_1 = max(whole.from, (q_4.nearest - half_));
    float to_1 = min(whole.to, (q_4.nearest + half_));
    if (!((to_1 <= from_1))) {
        local_1 = (end2_ <= q_4.least);
    } else {
        local_1 = true;
    }
    bool _e32 = local_1;
    if (_e32) {
        return 0.0;
    }
    float growth_2 = ((whole.light_to - whole.light_from) / (whole.to - whole.from));
    float light_from = (whole.light_from + (growth_2 * (from_1 - whole.from)));
    Stretch stretch_3 = Stretch(from_1, to_1, light_from, (whole.light_from + (growth_2 * (to_1 - whole.from))));
    float x0_1 = (q_4.rate * (from_1 - q_4.nearest));
    float x1_1 = (q_4.rate * (to_1 - q_4.nearest));
    float middle = (0.5 * (x0_1 + x1_1));
    bool is_flat_1 = (((x1_1 - x0_1) * (x1_1 - x0_1)) < (1.3 * ((middle * middle) + q_4.least)));
    if (is_flat_1) {
        float _e73 = shaped_panel(q_4, light_5, stretch_3, from_1, to_1, true);
        return _e73;
    }
    if ((light_5.color.w == 1.0)) {
        float _e83 = wave.rays.y;
        local_2 = (_e83 == 0.0);
    } else {
        local_2 = false;
    }
    bool _e87 = local_2;
    if (_e87) {
        local_3 = (growth_2 == 0.0);
    } else {
        local_3 = false;
    }
    bool _e93 = local_3;
    if (_e93) {
        float rest_2 = ((((((x0_1 * x0_1) + (x0_1 * x1_1)) + (x1_1 * x1_1)) / 3.0) + q_4.least) - (2.0 * end2_));
        Ends _e107 = ends_of(q_4, stretch_3);
        float _e108 = inverse_square_over(_e107, q_4);
        float whole_field = (((end2_ * end2_) * _e108) + ((light_from * rest_2) * (to_1 - from_1)));
        float _e117 = wave.rays.z;
        return (((_e117 * light_5.core.y) * light_5.core.y) * whole_field);
    }
    Peak peak_1 = Peak(q_4.nearest, (sqrt(q_4.least) / q_4.rate));
    float _e133 = mapped(clamp(q_4.nearest, from_1, to_1), peak_1);
    float _e134 = mapped(from_1, peak_1);
    float _e136 = shaped_panel(q_4, light_5, stretch_3, _e134, _e133, false);
    float _e137 = mapped(to_1, peak_1);
    float _e139 = shaped_panel(q_4, light_5, stretch_3, _e133, _e137, false);
    return (_e136 + _e139);
}

// Returns the integral over a stretch, for a coefficient of 1.
float integral_over(Quadratic q_5, Light light_6, Stretch stretch_2) {
    bool local_4 = false;
    if ((stretch_2.to <= stretch_2.from)) {
        return 0.0;
    }
    if (!((light_6.color.w > 1.0))) {
        local_4 = (light_6.core.y > 0.0);
    } else {
        local_4 = true;
    }
    bool _e19 = local_4;
    if (_e19) {
        float _e20 = shaped_over(q_5, light_6, stretch_2);
        return _e20;
    }
    Ends _e21 = ends_of(q_5, stretch_2);
    if ((light_6.color.w > 0.0)) {
        float _e29 = wave.rays.z;
        float _e30 = inverse_square_over(_e21, q_5);
        return (_e29 * _e30);
    }
    float _e35 = wave.rays.z;
    float _e36 = inverse_over(_e21, q_5);
    return (_e35 * _e36);
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
    float light_7 = 0.0;
    Quadratic _e7 = to_line(ray_3, beam.tip.xyz, beam.direction.xyz, beam.light);
    Quadratic _e11 = to_point(ray_3, beam.tip.xyz, beam.light);
    float height = dot((ray_3.origin - beam.tip.xyz), beam.direction.xyz);
    float slope_3 = dot(ray_3.direction, beam.direction.xyz);
    bool is_rising = (slope_3 > -1e-30);
    float _e26 = zero_along(height, slope_3, ray_3.end);
    Stretch _e31 = evenly_lit((is_rising ? _e26 : 0.0), (is_rising ? ray_3.end : _e26));
    float _e35 = integral_over(_e7, beam.light, _e31);
    light_7 = (beam.parts.x * _e35);
    if ((beam.parts.w > 0.0)) {
        float fade = ((height * beam.parts.w) + 1.0);
        float growth_3 = (slope_3 * beam.parts.w);
        float _e51 = zero_along(fade, growth_3, ray_3.end);
        float from_2 = min(_e26, _e51);
        float to_2 = max(_e26, _e51);
        vec2 lit_1 = clamp(vec2(((growth_3 * from_2) + fade), ((growth_3 * to_2) + fade)), vec2(0.0), vec2(1.0));
        float _e64 = light_7;
        float _e71 = integral_over(_e7, beam.light, Stretch(from_2, to_2, lit_1.x, lit_1.y));
        light_7 = (_e64 + (beam.parts.x * _e71));
    } else {
        Stretch _e78 = evenly_lit((is_rising ? 0.0 : _e26), (is_rising ? _e26 : ray_3.end));
        float _e79 = light_7;
        float _e83 = integral_over(_e11, beam.light, _e78);
        light_7 = (_e79 + (beam.parts.y * _e83));
    }
    float _e86 = light_7;
    Stretch _e92 = evenly_lit(0.0, ray_3.end);
    float _e93 = integral_over(_e11, beam.light, _e92);
    return (_e86 + (beam.parts.z * _e93));
}

// Returns the light along a ray: linear RGB. The direction is of length 1, depth the length at which
// the ray is hidden, world units from its origin.
vec3 wave_light(vec3 origin, vec3 direction_1, float depth) {
    vec3 light_8 = vec3(0.0);
    int i = 0;
    int i_1 = 0;
    float _e6 = wave.rays.x;
    Ray ray_4 = Ray(origin, direction_1, clamp(depth, 0.0, _e6));
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            int _e36 = i;
            i = (_e36 + 1);
        }
        loop_init_3 = false;
        int _e15 = i;
        if ((_e15 < 2)) {
        } else {
            break;
        }
        {
            vec3 _e18 = light_8;
            int _e21 = i;
            Sphere _e23 = wave.spheres[_e21];
            float _e24 = sphere_light(ray_4, _e23);
            int _e27 = i;
            vec4 _e31 = wave.spheres[_e27].light.color;
            light_8 = (_e18 + (_e24 * _e31.xyz));
        }
    }
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            int _e61 = i_1;
            i_1 = (_e61 + 1);
        }
        loop_init_4 = false;
        int _e40 = i_1;
        if ((_e40 < 2)) {
        } else {
            break;
        }
        {
            vec3 _e43 = light_8;
            int _e46 = i_1;
            Beam _e48 = wave.beams[_e46];
            float _e49 = beam_light(ray_4, _e48);
            int _e52 = i_1;
            vec4 _e56 = wave.beams[_e52].light.color;
            light_8 = (_e43 + (_e49 * _e56.xyz));
        }
    }
    vec3 _e63 = light_8;
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
