"""A quaking aspen by Blender's Sapling add-on beside our own, generation alone, in turns.

    sapling.py BENCH_TREES [--rounds N]

Needs Blender (apt-get install --no-install-recommends blender). Sapling's preset is run with three levels and leaves,
as the species has them; it makes curves and leaves, bench_trees the meshes of all stems and leaves. Processor time,
the least of N rounds.
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
leaves = sum(len(thing.data.polygons) for thing in bpy.data.objects if thing.name.startswith("leaves"))
stems = sum(len(thing.data.splines) for thing in bpy.data.objects if thing.name.startswith("tree"))
print("SAPLING", seconds, leaves, stems)
"""


def sapling(folder):
    job = pathlib.Path(folder) / "job.py"
    job.write_text(JOB)
    out = subprocess.run(["blender", "-b", "--factory-startup", "-noaudio", "-P", job], check=True, text=True,
                         capture_output=True).stdout
    seconds, leaves, stems = re.search(r"^SAPLING (\S+) (\d+) (\d+)$", out, re.MULTILINE).groups()
    return float(seconds), int(leaves), f"{stems} stems as curves"


def meristem(bench):
    out = subprocess.run([bench, "quaking_aspen"], check=True, text=True, capture_output=True).stdout
    seconds, faces, leaves = re.search(r"processor (\S+) s\)\s+(\d+) faces\s+(\d+) leaves", out).groups()
    return float(seconds), int(leaves), f"{faces} faces"


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
    for name, (seconds, leaves, rest) in (("Sapling", min(theirs)), ("Meristem", min(ours))):
        print(f"{name:9} {1e3 * seconds:7.1f} ms  {leaves:6} leaves  {1e6 * seconds / leaves:6.2f} us a leaf  {rest}")
    a, b = min(theirs), min(ours)
    print(f"{a[0] / b[0]:.0f} x as fast, {a[0] / a[1] / (b[0] / b[1]):.0f} x for each leaf")


main()
