"""Draws exported GLSL shaders by OpenGL (Mesa's llvmpipe) into files of float32 RGB, rows from the top.

Arguments, for each of them: the text, the bytes of its block, the output, width, which is the height.
"""

import sys
from pathlib import Path

try:
    import moderngl

    context = moderngl.create_standalone_context(require=330, backend="egl")
except Exception as fault:
    print(f"skipped: {fault}")
    sys.exit()

vertex = """#version 330 core
smooth out vec2 _vs2fs_location0;
void main() {
    vec2 uv = vec2(2 * (gl_VertexID & 1), gl_VertexID & 2);
    _vs2fs_location0 = uv;
    gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0); // row 0 of what is read is the bottom, here the top
}
"""


def draw(text, block, output, side):
    program = context.program(vertex_shader=vertex, fragment_shader=text.read_text())
    if "WaveBlock" in program:
        program["WaveBlock"].binding = 0
        context.buffer(block.read_bytes()).bind_to_uniform_block(0)
    target = context.simple_framebuffer((side, side), components=4, dtype="f4")
    target.use()
    context.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    output.write_bytes(target.read(components=3, dtype="f4"))


for first in range(1, len(sys.argv), 4):
    draw(*map(Path, sys.argv[first : first + 3]), int(sys.argv[first + 3]))
print(f"drawn: {context.info['GL_RENDERER']}")
