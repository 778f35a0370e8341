"""A quaking aspen by Blender's Sapling add-on beside our own, generation alone, in turns.

    sapling.py BENCH_TREES [--rounds N]

Needs Blender (apt-get install --no-install-recommends blender). Sapling's preset is run with three levels and leaves,
as the species has them. It makes curves, which Blender evaluates as tubes of four sides at once, and leaves of two
quads; bench_trees makes welded tubes of 4 to 16 sides and leaves of two quads, all with keys and u, v. Sapling's tree
has about half as many stems and a quarter of the leaves. Processor time, the least of N rounds.
"""
import argparse
import pathlib
import re
import subprocess
import tempfile

JOB = """
import ast, pathlib, time
import addon_utils, bpy
addon_utils.enable("add_curve_sapling")
import add_curve_sapling
text = (pathlib.Path(add_curve_sapling.__file__).parent / "presets" / "quaking_aspen.py").read_text()
preset = ast.literal_eval("\\n".join(line for line in text.splitlines() if not line.startswith("#")))
preset |= {"showLeaves": True, "levels": 3}
start = time.process_time()
bpy.ops.curve.tree_add(do_update=True, **preset)
seconds = time.process_time() - start
meshes = [thing.data for thing in bpy.data.objects if thing.name.startswith("leaves")]
leaves = sum(len(mesh.vertices) for mesh in meshes) // 6
faces = sum(len(mesh.polygons) for mesh in meshes)
graph = bpy.context.evaluated_depsgraph_get()
for thing in bpy.data.objects:
    if thing.name.startswith("tree"):
        faces += len(thing.evaluated_get(graph).to_mesh().polygons)
print("SAPLING", seconds, leaves, faces)
"""


def numbers(pattern, out):
    found = re.search(pattern, out, re.MULTILINE).groupdict()
    return float(found["seconds"]), int(found["leaves"]), int(found["faces"])


def sapling(folder):
    job = pathlib.Path(folder) / "job.py"
    job.write_text(JOB)
    out = subprocess.run(["blender", "-b", "--factory-startup", "-noaudio", "-P", job], check=True, text=True,
                         capture_output=True).stdout
    return numbers(r"^SAPLING (?P<seconds>\S+) (?P<leaves>\d+) (?P<faces>\d+)$", out)


def meristem(bench):
    out = subprocess.run([bench, "quaking_aspen"], check=True, text=True, capture_output=True).stdout
    return numbers(r"processor (?P<seconds>\S+) s\)\s+(?P<faces>\d+) faces\s+(?P<leaves>\d+) leaves", out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench_trees")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    ours, theirs = [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(options.rounds):
            theirs.append(sapling(folder))
            ours.append(meristem(options.bench_trees))
    theirs, ours = min(theirs), min(ours)
    for name, (seconds, leaves, faces) in (("Sapling", theirs), ("Meristem", ours)):
        print(f"{name:9} {1e3 * seconds:7.1f} ms  {leaves:6} leaves  {faces:6} faces")
    whole, leaf, face = (theirs[0] / a / (ours[0] / b) for a, b in ((1, 1), (theirs[1], ours[1]), (theirs[2], ours[2])))
    print(f"{whole:.0f} x as fast, {leaf:.0f} x for each leaf, {face:.0f} x for each face")


main()
