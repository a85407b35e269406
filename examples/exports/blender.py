"""Draws a volume of `energywave bake` in Blender 5, as light that fog gives off.

blender --background --python examples/exports/blender.py -- nova.vdb nova.png
(or, with Blender from PyPI: python blender.py -- nova.vdb nova.png)
"""

import math
import sys

import bpy
from mathutils import Vector

volume_file, picture = sys.argv[sys.argv.index("--") + 1 :]

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 64
scene.cycles.volume_step_rate = 0.5
scene.render.resolution_x, scene.render.resolution_y = 960, 540

bpy.ops.object.volume_import(filepath=volume_file)
volume = bpy.context.object

# Light is `density` times `color`, for each unit of length.
material = bpy.data.materials.new("energy")
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
nodes.clear()
output = nodes.new("ShaderNodeOutputMaterial")
emission = nodes.new("ShaderNodeEmission")
for name, value, socket in [("density", "Fac", "Strength"), ("color", "Vector", "Color")]:
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = name
    links.new(attribute.outputs[value], emission.inputs[socket])
links.new(emission.outputs["Emission"], output.inputs["Volume"])
volume.data.materials.clear()
volume.data.materials.append(material)

# The camera of the preset `nova`.
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.sensor_fit = "VERTICAL"
camera.data.angle_y = math.radians(40)
camera.location = (0, -6, 1.2)
camera.rotation_euler = (Vector((0, 0, 0)) - camera.location).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(camera)
scene.camera = camera

scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
