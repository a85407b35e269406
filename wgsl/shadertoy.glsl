// The picture by the scene's own camera, upright in any window, with the scene's exposure.
void mainImage(out vec4 color, in vec2 pixel) {
    float wider = iResolution.x * length(wave.down.xyz) / (iResolution.y * length(wave.across.xyz));
    vec2 uv = vec2(0.5 + (pixel.x / iResolution.x - 0.5) * wider, 1.0 - pixel.y / iResolution.y);
    vec3 on_plane = wave.corner.xyz + uv.x * wave.across.xyz + uv.y * wave.down.xyz; // seen from the eye
    vec3 direction = wave.eye.w > 0.0 ? normalize(on_plane) : wave.forward.xyz;
    vec3 light = wave_light(wave.eye.xyz + on_plane, direction, wave.rays.x);
    color = vec4(pow(1.0 - exp(-EXPOSURE * light), vec3(1.0 / 2.2)), 1.0);
}
