// Integrals without a closed form: 16 Gauss-Legendre nodes on each side of the place p where a ray is nearest to a core,
// in v of x = p + width sinh(v), width the distance there, in which 1/q is flat and its powers are bells of width 1.
// The error is within 1e-2 of a pixel's brightest channel; on a core of 1/q^2 without a radius it is 0.2 and more.
const NODES = array<f32, 8>(
    0.095012510, 0.281603551, 0.458016778, 0.617876244,
    0.755404408, 0.865631202, 0.944575023, 0.989400935
);
const WEIGHTS = array<f32, 8>(
    0.189450610, 0.182603415, 0.169156519, 0.149595989,
    0.124628971, 0.095158512, 0.062253524, 0.027152459
);

// A squared distance where light that has no reach ends.
const ENDLESS = 1e30;

// Where a ray is nearest, and the distance there.
struct Peak { place: f32, width: f32 }

fn peak_at(place: f32, distance2: f32, light: Light) -> Peak {
    return Peak(place, sqrt(max(distance2 + light.core.x, wave.rays.w)));
}

// Returns the v of a place.
fn mapped(place: f32, peak: Peak) -> f32 {
    let x = (place - peak.place) / peak.width;
    return sign(x) * log(abs(x) + sqrt(x * x + 1.0));
}

// Returns field times decay, from the squared distance with softening, and the place on the ray.
fn faded_field(softened2: f32, x: f32, light: Light) -> f32 {
    let bare2 = max(softened2 - light.core.x, 0.0);
    let per_q = inverseSqrt(max(softened2, wave.rays.w));
    var field = per_q * select(1.0, per_q, light.color.w > 0.0) * select(1.0, per_q, light.color.w > 1.0);
    if (light.color.w > 2.0) {
        field = exp(-bare2 * light.core.w);
    }
    let window = max(1.0 - bare2 * light.core.y, 0.0);
    return wave.rays.z * fading(x) * field * window * window;
}
