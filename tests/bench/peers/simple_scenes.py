"""Five simple scenes by Meristem and by Cycles: the means of the images should differ by less than 1 %.

    simple_scenes.py MERISTEM [--samples N] [--keep FOLDER] [NAME ...]

Needs Blender and oiiotool (apt-get install --no-install-recommends blender openimageio-tools). Cycles gets the meshes
as `meristem export` wrote them.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SIZE = [192, 108]
BOUNCES = 24
WHITE = {"type": "diffuse", "color": [0.8, 0.8, 0.8]}
BALL = {"base": {"type": "sphere", "radius": 1, "divisions": 8}, "steps": [{"subdivide": 2}]}
FLOOR = {"base": {"type": "plane", "width": 12, "depth": 12}}
CAMERA = {"from": [0, 3, 9], "to": [0, 0.7, 0], "up": [0, 1, 0], "fov": 35}
SUN = {"direction": [1, -2, -1.5], "irradiance": 3, "angle": 0.53}


def flat_box():
    """Each side with vertices of its own: normals are those of the sides, on which renderers agree."""
    vertices, polygons = [], []
    for axis in range(3):
        for side in (-0.5, 0.5):
            corners = [[0.0, 0.0, 0.0] for _ in range(4)]
            for corner, (a, b) in zip(corners, ((-1, -1), (1, -1), (1, 1), (-1, 1))):
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, a / 2, b / 2
            first = len(vertices)
            vertices += corners
            polygons.append([first + k for k in (range(4) if side > 0 else (3, 2, 1, 0))])
    return {"base": {"type": "mesh", "vertices": vertices, "polygons": polygons}}


BOX = flat_box()


def diffuse(*color):
    return {"type": "diffuse", "color": list(color)}


SCENES = {
    "spheres": {
        "sky": [0.7, 0.8, 0.9],
        "materials": {"white": WHITE, "green": diffuse(0.3, 0.6, 0.2),
                      "metal": {"type": "metal", "color": [1, 1, 1], "roughness": 0.5}},
        "objects": [("white", BALL, {"position": [-2.2, 1, 0]}), ("green", BALL, {"position": [0, 1, 0]}),
                    ("metal", BALL, {"position": [2.2, 1, 0]}), ("white", FLOOR, {})]},
    "box": {
        "materials": {"white": WHITE, "red": diffuse(0.6, 0.05, 0.05), "blue": diffuse(0.1, 0.15, 0.6),
                      "lamp": {"type": "emission", "color": [1, 0.9, 0.7], "strength": 12}},
        "objects": [("white", FLOOR, {"scale": 0.5}), ("white", FLOOR, {"scale": 0.5, "position": [0, 4, 0]}),
                    ("white", FLOOR, {"scale": 0.5, "position": [0, 2, -3], "rotate": [90, 0, 0]}),
                    ("red", FLOOR, {"scale": 0.5, "position": [-3, 2, 0], "rotate": [0, 0, 90]}),
                    ("blue", FLOOR, {"scale": 0.5, "position": [3, 2, 0], "rotate": [0, 0, 90]}),
                    ("lamp", FLOOR, {"scale": 0.1, "position": [0, 3.95, 0]}),
                    ("white", BOX, {"scale": 1.4, "position": [1, 0.7, 0], "rotate": [0, 30, 0]})]},
    "texture": {
        "sky": [0.8, 0.8, 0.8],
        "materials": {"checker": {"type": "diffuse", "color": [1, 1, 1], "image": "checker.hdr"}},
        "objects": [("checker", {"base": {"type": "plane", "width": 6, "depth": 6}}, {})]},
    "glass": {
        "sky": [0.6, 0.7, 0.9],
        "materials": {"white": WHITE, "red": diffuse(0.6, 0.1, 0.1),
                      "glass": {"type": "glass", "color": [1, 1, 1], "roughness": 0, "ior": 1.5}},
        "objects": [("white", FLOOR, {}), ("glass", BALL, {"position": [0, 1.05, 0]}),
                    ("red", BOX, {"position": [-1.5, 0.5, -2]})]},
    "sun and sky": {
        "sky": [0.2, 0.3, 0.5], "suns": [SUN],
        "materials": {"white": WHITE, "brown": diffuse(0.4, 0.3, 0.2)},
        "objects": [("brown", FLOOR, {}), ("white", BALL, {"position": [1.2, 1, 0]}),
                    ("white", BOX, {"position": [-1.2, 0.75, 0], "scale": 1.5, "rotate": [0, 20, 0]})]},
}


def own_material(m):
    color = m["color"]
    if m["type"] == "metal":
        return {"base_color": color, "base_metalness": 1, "specular_roughness": m["roughness"]}
    if m["type"] == "glass":
        return {"transmission_weight": 1, "specular_roughness": m["roughness"], "specular_ior": m["ior"]}
    if m["type"] == "emission":
        return {"base_color": 0, "specular_weight": 0, "emission_luminance": m["strength"], "emission_color": color}
    material = {"base_color": color, "specular_weight": 0}
    if "image" in m:
        material |= {"base_color": "image", "textures": {"image": {"file": m["image"]}}}
    return material


def own_scene(scene):
    models = {}
    objects = []
    for i, (material, model, place) in enumerate(scene["objects"]):
        models[f"model{i}"] = {**model, "material": material}
        objects.append({"model": f"model{i}", **place})
    lights = [{"type": "constant", "color": scene["sky"]}] if "sky" in scene else []
    lights += [{"type": "distant", **sun} for sun in scene.get("suns", [])]
    return {"materials": {name: own_material(m) for name, m in scene["materials"].items()}, "models": models,
            "objects": objects, "lights": lights, "camera": CAMERA,
            "render": {"size": SIZE, "max_depth": BOUNCES, "detail": 0, "filter": {"type": "box"}}}


def write_checker(path):
    """A linear Radiance picture: dark and bright squares."""
    rows = b"".join(bytes([200, 160, 60, 128] if (x // 8 + y // 8) % 2 else [20, 40, 90, 128])
                    for y in range(64) for x in range(64))
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n" + rows)


def run(*command):
    result = subprocess.run([str(c) for c in command], text=True, capture_output=True)
    if result.returncode != 0:
        sys.exit(f"{command}\nends with {result.returncode}:\n{result.stderr[-2000:]}{result.stdout[-2000:]}")
    return result.stdout


def means(image):
    found = re.search(r"Stats Avg: ([\d.e+-]+) ([\d.e+-]+) ([\d.e+-]+)", run("oiiotool", "--stats", image))
    return [float(x) for x in found.groups()]


def compare(meristem, name, samples, folder):
    scene = SCENES[name]
    write_checker(folder / "checker.hdr")
    source, mesh, job = folder / "scene.jsonc", folder / "scene.obj", folder / "job.json"
    source.write_text(json.dumps(own_scene(scene)))
    run(meristem, "export", source, "-o", mesh, "-q")
    run(meristem, "render", source, "--samples", samples, "--float", "-q", "-o", folder / "meristem.exr")
    materials = {name: dict(m) for name, m in scene["materials"].items()}
    for m in materials.values():
        if "image" in m:
            m["image"] = str(folder / m["image"])
    job.write_text(json.dumps({**scene, "materials": materials, "mesh": str(mesh), "camera": CAMERA, "size": SIZE,
                               "samples": [samples], "max_bounces": BOUNCES - 1, "threads": 2,
                               "image": str(folder / "cycles.exr")}))
    run("blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P", HERE / "cycles_render.py",
        "--", job)
    own, other = means(folder / "meristem.exr"), means(folder / "cycles.exr")
    worst = max(abs(a - b) / b for a, b in zip(own, other))
    columns = "   ".join(" ".join(f"{x:.4f}" for x in mean) for mean in (own, other))
    print(f"{name:12} {columns}   {100 * worst:.2f} %", flush=True)
    return worst < 0.01


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meristem")
    parser.add_argument("names", nargs="*", default=list(SCENES))
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--keep", help="a folder for scenes and images")
    options = parser.parse_args()
    print(f"{'':12} {'Meristem':22} {'Cycles':22} largest difference of a mean")
    good = True
    for name in options.names:
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(options.keep) / name.replace(" ", "-") if options.keep else pathlib.Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            good = compare(options.meristem, name, options.samples, folder.resolve()) and good
    return 0 if good else 1


sys.exit(main())
