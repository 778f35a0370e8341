"""Renders a mesh with Cycles, inside of Blender: the other side of throughput.py and simple_scenes.py.

    blender -b --factory-startup -noaudio -P cycles_render.py -- JOB.json

The job: mesh (OBJ or PLY, or a .blend that holds it), save (a .blend to write instead of rendering; may be missing),
materials by name ({"type": "diffuse" | "metal" | "glass" | "emission", "color", "roughness", "ior", "strength",
"image"}), camera (from, to, up, fov), size, samples (a list: one render each), max_bounces, sky (a colour), suns
(direction, irradiance, angle in degrees), threads, image (EXR of the last render; may be missing).
Prints "CYCLES {samples: [wall, processor]}", seconds of the renders alone, each with all that it builds. (With
persistent data Blender 3.4 takes as many samples in every render as in the first.)
"""
import json
import math
import sys
import time

import bpy
from mathutils import Matrix, Vector


def node_material(name, m):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    kinds = {"diffuse": "ShaderNodeBsdfDiffuse", "metal": "ShaderNodeBsdfGlossy", "glass": "ShaderNodeBsdfGlass",
             "emission": "ShaderNodeEmission"}
    shader = tree.nodes.new(kinds[m["type"]])
    shader.inputs["Color"].default_value = (*m["color"], 1)
    if m["type"] in ("metal", "glass"):
        shader.inputs["Roughness"].default_value = m["roughness"]
        shader.distribution = "MULTI_GGX" if m["type"] == "metal" else "GGX"
    if m["type"] == "glass":
        shader.inputs["IOR"].default_value = m["ior"]
    if m["type"] == "emission":
        shader.inputs["Strength"].default_value = m["strength"]
    if "image" in m:
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = bpy.data.images.load(m["image"])
        tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def load(job):
    if job["mesh"].endswith(".blend"):
        with bpy.data.libraries.load(job["mesh"]) as (found, wanted):
            wanted.objects = found.objects
        for thing in wanted.objects:
            bpy.context.scene.collection.objects.link(thing)
            thing.select_set(True)
    elif job["mesh"].endswith(".ply"):
        bpy.ops.import_mesh.ply(filepath=job["mesh"])
    else:
        bpy.ops.wm.obj_import(filepath=job["mesh"], forward_axis="Y", up_axis="Z")
    made = {name: node_material("own " + name, m) for name, m in job["materials"].items()}
    for thing in bpy.context.selected_objects:
        slots = thing.data.materials
        for i, slot in enumerate(slots):
            slots[i] = made[slot.name.removeprefix("own ").split(".")[0]]
        if not slots:
            slots.append(next(iter(made.values())))


def set_camera(job, scene):
    camera = bpy.data.cameras.new("camera")
    thing = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(thing)
    start, end, up = (Vector(job["camera"][k]) for k in ("from", "to", "up"))
    back = (start - end).normalized()
    right = up.cross(back).normalized()
    over = back.cross(right)
    thing.matrix_world = Matrix([[right[i], over[i], back[i], start[i]] for i in range(3)] + [[0, 0, 0, 1]])
    camera.sensor_fit, camera.angle = "VERTICAL", math.radians(job["camera"]["fov"])
    camera.clip_end = 1e4
    scene.camera = thing


def set_light(job, scene):
    for sun in job.get("suns", []):
        light = bpy.data.lights.new("sun", "SUN")
        thing = bpy.data.objects.new("sun", light)
        scene.collection.objects.link(thing)
        thing.rotation_euler = Vector(sun["direction"]).to_track_quat("-Z", "Y").to_euler()
        light.energy, light.angle = sun["irradiance"], math.radians(sun["angle"])
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (*job.get("sky", [0, 0, 0]), 1)


def main(path):
    with open(path, encoding="utf-8") as file:
        job = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.max_bounces = job["max_bounces"]
    scene.cycles.min_light_bounces = job["max_bounces"]  # no roulette: as many rays a path as the others trace
    for kind in ("diffuse", "glossy", "transmission"):
        setattr(scene.cycles, kind + "_bounces", job["max_bounces"])
    scene.cycles.sample_clamp_indirect = 0
    scene.cycles.blur_glossy = 0
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    scene.render.resolution_x, scene.render.resolution_y = job["size"]
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    load(job)
    if "save" in job:
        bpy.ops.wm.save_as_mainfile(filepath=job["save"])
        return
    set_camera(job, scene)
    set_light(job, scene)
    seconds = {}
    for samples in job["samples"]:
        scene.cycles.samples = samples
        if job.get("image"):
            scene.render.filepath = job["image"]
        start, used = time.time(), time.process_time()
        bpy.ops.render.render(write_still=bool(job.get("image")))
        seconds[samples] = time.time() - start, time.process_time() - used
    print("CYCLES " + json.dumps(seconds))


main(sys.argv[sys.argv.index("--") + 1])
