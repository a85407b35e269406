// A whole picture by the scene's own camera: a triangle over the screen, and the light of each pixel, linear, before
// exposure and tone mapping. uv is (0, 0) at the top left, (1, 1) at the bottom right.
struct Screen { @builtin(position) position: vec4f, @location(0) uv: vec2f }

@vertex
fn screen(@builtin(vertex_index) index: u32) -> Screen {
    let uv = vec2f(f32(2u * (index & 1u)), f32(index & 2u));
    return Screen(vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0), uv);
}

@fragment
fn image(@location(0) uv: vec2f) -> @location(0) vec4f {
    let on_plane = wave.corner.xyz + uv.x * wave.across.xyz + uv.y * wave.down.xyz; // seen from the eye
    let direction = select(wave.forward.xyz, normalize(on_plane), wave.eye.w > 0.0);
    return vec4f(wave_light(wave.eye.xyz + on_plane, direction, wave.rays.x), 1.0);
}
