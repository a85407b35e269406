// A chain of straight lines of light (a polyline, lightning, what stands for a curved core): the field of its nearest
// point, so that joints are no brighter than what lies beside them. A ray goes from one nearest part to the next, each
// with the integral of its own.
struct LightPath {
    rows: vec4f, // the first of its rows of the series, its number of corners, rows of each corner
    light: Light,
}

// The nearest part: a corner, or the line that begins there.
struct Part { corner: i32, is_line: bool }

// A squared distance as a ray moves on by y, a y^2 + 2 b y + c, and from where to where it counts.
struct Parabola { a: f32, b: f32, c: f32, from_: f32, to: f32 }

// Which part is nearest next, and how far on.
struct Next { part: Part, advance: f32 }

// Another part takes over where its squared distance is less by this share, lest equally near ones take turns.
const SLACK = 1.002;

// Beyond every ray.
const NOWHERE = 1e30;

// Returns a corner; last 1 where a line begins, 0 at the last corner of those that follow each other.
fn path_corner(path: LightPath, corner: i32) -> vec4f {
    return wave.series[i32(path.rows.x) + corner * i32(path.rows.z)];
}

// Returns what light is multiplied with at a corner, and how thick the core is.
fn path_lit(path: LightPath, corner: i32) -> vec2f {
    if (path.rows.z < 2.0) {
        return vec2f(1.0, 0.0);
    }
    return wave.series[i32(path.rows.x) + 2 * corner + 1].xy;
}

// Returns the squared distance to a part from a place on.
fn path_distance2(path: LightPath, part: Part, place: vec3f, direction: vec3f) -> Parabola {
    let corner = path_corner(path, part.corner);
    let beside = place - corner.xyz;
    let point = Parabola(1.0, dot(beside, direction), dot(beside, beside), 0.0, NOWHERE);
    if (!part.is_line) {
        return point;
    }
    let line = path_corner(path, part.corner + 1).xyz - corner.xyz;
    let long = length(line);
    let height = dot(beside, line) / long;
    let rise = dot(direction, line) / long;
    let across = beside - height / long * line;
    let first = -height / select(rise, 1e-30, abs(rise) < 1e-30);
    let last = (long - height) / select(rise, 1e-30, abs(rise) < 1e-30);
    return Parabola(max(1.0 - rise * rise, 0.0), dot(across, direction), dot(across, across),
        max(min(first, last), 0.0), max(first, last));
}

fn parabola_at(p: Parabola, y: f32) -> f32 {
    return (p.a * y + 2.0 * p.b) * y + p.c;
}

// Returns where another part becomes nearer than the nearest one, within where it counts; NOWHERE: it does not.
fn path_takes_over(other: Parabola, nearest: Parabola) -> f32 {
    if (other.to <= other.from_) {
        return NOWHERE;
    }
    let a = SLACK * other.a - nearest.a;
    let begin = SLACK * other.b - nearest.b;
    let b = begin + a * other.from_;
    let c = SLACK * parabola_at(other, other.from_) - parabola_at(nearest, other.from_);
    if (c < 0.0) {
        return other.from_;
    }
    let square = b * b - a * c;
    if (square < 0.0 || (b >= 0.0 && a >= 0.0)) {
        return NOWHERE;
    }
    let root = sqrt(square);
    let way = other.from_ + select((root + b) / max(-a, 1e-30), c / max(root - b, 1e-30), b < 0.0);
    return select(NOWHERE, way, way < other.to);
}

// Returns the part that is nearest to a place.
fn path_nearest(path: LightPath, place: vec3f) -> Part {
    var nearest = Part(0, false);
    var least = NOWHERE;
    for (var k = 0; k < i32(path.rows.y); k++) {
        let corner = path_corner(path, k);
        let beside = place - corner.xyz;
        let next = path_corner(path, min(k + 1, i32(path.rows.y) - 1)).xyz - corner.xyz;
        let share = clamp(dot(beside, next) / max(dot(next, next), 1e-30), 0.0, 1.0) * corner.w;
        let from_line = beside - share * next;
        let distance2 = dot(from_line, from_line);
        if (distance2 < least) {
            least = distance2;
            nearest = Part(k, share > 0.0 && share < 1.0);
        }
    }
    return nearest;
}

// Returns what comes after a part as a ray moves on from a place.
fn path_next(path: LightPath, part: Part, place: vec3f, direction: vec3f, most: f32) -> Next {
    let nearest = path_distance2(path, part, place, direction);
    var next = Next(part, most);
    if (part.is_line && nearest.to < most) {
        let line = path_corner(path, part.corner + 1).xyz - path_corner(path, part.corner).xyz;
        next = Next(Part(part.corner + select(0, 1, dot(line, direction) > 0.0), false), max(nearest.to, 0.0));
    }
    for (var k = 0; k < i32(path.rows.y); k++) {
        for (var of_line = 0; of_line < 1 + i32(path_corner(path, k).w); of_line++) {
            let other = Part(k, of_line > 0);
            let advance = path_takes_over(path_distance2(path, other, place, direction), nearest);
            if (advance < next.advance) {
                next = Next(other, advance);
            }
        }
    }
    return next;
}

// Returns where a ray may meet light: balls around all lines, as thick as it reaches.
fn path_reached(ray: Ray, path: LightPath) -> vec2f {
    if (path.light.core.z >= ENDLESS) {
        return vec2f(0.0, ray.end);
    }
    var reached = vec2f(ray.end, 0.0);
    for (var k = 0; k < i32(path.rows.y); k++) {
        let corner = path_corner(path, k);
        let next = path_corner(path, min(k + 1, i32(path.rows.y) - 1)).xyz - corner.xyz;
        let to_middle = corner.xyz + 0.5 * corner.w * next - ray.origin;
        let along = dot(to_middle, ray.direction);
        let beside = to_middle - along * ray.direction;
        let thick = sqrt(path.light.core.z) + 0.5 * corner.w * length(next);
        let left = thick * thick - dot(beside, beside);
        if (left > 0.0) {
            reached = vec2f(min(reached.x, along - sqrt(left)), max(reached.y, along + sqrt(left)));
        }
    }
    return clamp(reached, vec2f(0.0), vec2f(ray.end));
}

// Returns the integral over a stretch where one part is nearest.
fn path_over(ray: Ray, path: LightPath, part: Part, from_: f32, to: f32) -> f32 {
    let corner = path_corner(path, part.corner);
    var light = path.light;
    var lit = path_lit(path, part.corner);
    if (!part.is_line) {
        light.core.x += lit.y * lit.y;
        return integral_over(to_point(ray, corner.xyz, light), light, Stretch(from_, to, lit.x, lit.x));
    }
    let line = path_corner(path, part.corner + 1).xyz - corner.xyz;
    let per_length2 = 1.0 / dot(line, line);
    let begin = clamp(dot(ray.origin + from_ * ray.direction - corner.xyz, line) * per_length2, 0.0, 1.0);
    let end = clamp(dot(ray.origin + to * ray.direction - corner.xyz, line) * per_length2, 0.0, 1.0);
    let growth = path_lit(path, part.corner + 1) - lit;
    let thick = lit.y + 0.5 * (begin + end) * growth.y;
    light.core.x += thick * thick;
    let q = to_line(ray, corner.xyz, line * sqrt(per_length2), light);
    return integral_over(q, light, Stretch(from_, to, lit.x + begin * growth.x, lit.x + end * growth.x));
}

fn path_light(ray: Ray, path: LightPath) -> f32 {
    let reached = path_reached(ray, path);
    var x = reached.x;
    var part = path_nearest(path, ray.origin + x * ray.direction);
    var sum = 0.0;
    for (var step = 0; step < 4 * i32(path.rows.y) + 16; step++) {
        if (x >= reached.y) {
            break;
        }
        let next = path_next(path, part, ray.origin + x * ray.direction, ray.direction, reached.y - x);
        let end = min(x + max(next.advance, 2e-7 * max(x, 0.01)), reached.y);
        sum += path_over(ray, path, part, x, end);
        x = end;
        part = next.part;
    }
    return sum;
}
