"""Runs inside Blender for blender_bake.py: a scene, its sensors as texels, and some timed bakes."""
import json
import math
import sys
import time
from pathlib import Path

import bpy
import numpy

numpy.bool = bool  # Blender 3.4's glTF reader names what NumPy 1.24 no longer has

MOST_BOUNCES = 64
SIZE_OF_SENSOR = 1e-5  # of the scene's diagonal; and how high above its surface it lies
OPAQUE = 0.999


def input_of(node, *names):
    return next(node.inputs[n] for n in names if n in node.inputs)


def make_diffuse(material):
    """Diffuse reflection by the base colour, and emission; from the front alone unless two-sided.
    The reader makes a Principled shader, whose gloss we do not compute."""
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    principled = next((n for n in nodes if n.type == "BSDF_PRINCIPLED"), None)
    output = next(n for n in nodes if n.type == "OUTPUT_MATERIAL")
    diffuse, emission, add = (nodes.new(f"ShaderNode{kind}")
                              for kind in ("BsdfDiffuse", "Emission", "AddShader"))

    def take(source, target):
        if source.is_linked:
            links.new(source.links[0].from_socket, target)
        else:
            target.default_value = source.default_value

    emission.inputs["Strength"].default_value = 0
    if principled:
        alpha = principled.inputs["Alpha"]
        if alpha.is_linked or alpha.default_value < OPAQUE:
            sys.exit(f"material '{material.name}' lets light through")
        take(principled.inputs["Base Color"], diffuse.inputs["Color"])
        take(principled.inputs["Emission"], emission.inputs["Color"])
        strength = principled.inputs["Emission Strength"]
        if material.use_backface_culling:
            front, times = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath")
            times.operation = "MULTIPLY_ADD"  # strength - strength * backfacing
            links.new(front.outputs["Backfacing"], times.inputs[0])
            times.inputs[1].default_value = -strength.default_value
            times.inputs[2].default_value = strength.default_value
            links.new(times.outputs[0], emission.inputs["Strength"])
        else:
            take(strength, emission.inputs["Strength"])
    links.new(diffuse.outputs[0], add.inputs[0])
    links.new(emission.outputs[0], add.inputs[1])
    links.new(add.outputs[0], output.inputs["Surface"])


def make_sensors(rows, size, picture):
    """A triangle for each sensor, which fills its own texel's middle; no ray meets them."""
    side = picture.size[0]
    corners, uvs = [], []
    for i, (x, y, z, nx, ny, nz) in enumerate(row[:6] for row in rows):
        n = numpy.array((nx, -nz, ny))  # glTF has y up, Blender z
        u = numpy.cross(n, (0, 0, 1) if abs(n[2]) < 0.9 else (1, 0, 0))
        u /= numpy.linalg.norm(u)
        v = numpy.cross(n, u)
        at = numpy.array((x, -z, y)) + size * n
        corners += [tuple(at + size * (a * u + b * v)) for a, b in ((-1, -1), (1, -1), (0, 2))]
        column, line = i % side, i // side
        uvs += [((column + a) / side, (line + b) / side)
                for a, b in ((0.1, 0.2), (0.9, 0.2), (0.5, 0.9))]
    mesh = bpy.data.meshes.new("sensors")
    mesh.from_pydata(corners, [], [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(rows))])
    layer = mesh.uv_layers.new(name="texels")
    layer.data.foreach_set("uv", numpy.array(uvs, dtype=numpy.float32).ravel())
    material = bpy.data.materials.new("sensors")
    material.use_nodes = True
    make_diffuse(material)
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    material.node_tree.nodes.active = node
    mesh.materials.append(material)
    sensors = bpy.data.objects.new("sensors", mesh)
    bpy.context.collection.objects.link(sensors)
    for kind in ("diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(sensors, f"visible_{kind}", False)
    return sensors


def diagonal():
    corners = numpy.array([o.matrix_world @ v.co for o in bpy.data.objects if o.type == "MESH"
                           for v in o.data.vertices])
    return float(numpy.linalg.norm(corners.max(0) - corners.min(0)))


def set_up():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "AUTO"
    scene.world = scene.world or bpy.data.worlds.new("dark")
    scene.world.use_nodes = True
    for node in scene.world.node_tree.nodes:
        if node.type == "BACKGROUND":
            node.inputs["Strength"].default_value = 0
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = MOST_BOUNCES
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    return scene


def main():
    task = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=task["scene"])
    for material in bpy.data.materials:
        make_diffuse(material)
    rows = [[float(w) for w in line.split()] for line in Path(task["sensors"]).read_text().splitlines()]
    side = math.ceil(math.sqrt(len(rows)))
    picture = bpy.data.images.new("irradiance", side, side, float_buffer=True)
    picture.colorspace_settings.name = "Non-Color"
    sensors = make_sensors(rows, SIZE_OF_SENSOR * diagonal(), picture)
    scene = set_up()
    bpy.ops.object.select_all(action="DESELECT")
    sensors.select_set(True)
    bpy.context.view_layer.objects.active = sensors

    bakes = []
    for samples, seed in task["bakes"]:
        scene.cycles.samples, scene.cycles.seed = samples, seed
        start, cpu_start = time.monotonic(), time.process_time()
        bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, margin=0)
        seconds, cpu_seconds = time.monotonic() - start, time.process_time() - cpu_start
        pixels = numpy.empty(4 * side * side, dtype=numpy.float32)
        picture.pixels.foreach_get(pixels)
        # Cycles tells radiosity over pi of a white surface.
        irradiance = math.pi * pixels.reshape(-1, 4)[:len(rows), :3].mean(1)
        file = f"bake-{len(bakes)}.txt"
        numpy.savetxt(Path(task["to"]) / file, irradiance, fmt="%.7g")
        bakes.append({"seconds": [seconds, cpu_seconds], "file": file})
    (Path(task["to"]) / "bakes.json").write_text(
        json.dumps({"blender": bpy.app.version_string, "bakes": bakes}))


main()
