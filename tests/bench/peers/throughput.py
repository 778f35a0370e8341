"""Paths per second on one mesh of 5.2 million triangles: Meristem, Cycles and Embree's own path tracer, alternating.

    throughput.py MERISTEM [--rounds N] [--size WxH] [--threads N] [--only lazy,eager,flat,cycles,embree]
                  [--folder FOLDER] [--prepare]

Needs Blender and Embree's programs (apt-get install --no-install-recommends blender embree-tools). The scene is
terrain.jsonc; the others get its mesh as `meristem export` wrote it, the same camera, lights, diffuse reflection and
bounces. What a program does before and after sampling is left out: a sample's cost is the difference of two renders,
with few and with more samples, in processor time and in wall time; of N rounds the cheapest counts. Cycles builds for
half a minute in each, so it takes more samples.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
FEW, MORE, MOST = 4, 36, 260  # samples
BOUNCES = 4  # as render.max_depth counts them: 1 is direct light. Cycles counts one less
CAMERA = {"from": [0, 5, 12], "to": [0, 0.5, 0], "up": [0, 1, 0], "fov": 40}
SKY = [0.5, 0.6, 0.8]
SUN = {"direction": [0.56, -0.8, -0.2], "irradiance": 3, "angle": 0}
GREY = {"type": "diffuse", "color": [0.5] * 3}


def run(command):
    """What it prints, and its (wall, processor) seconds."""
    before, start = os.times(), time.time()
    result = subprocess.run([str(c) for c in command], text=True, capture_output=True)
    after = os.times()
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nends with {result.returncode}:\n{result.stderr[-2000:]}")
    return result.stdout, (time.time() - start, sum(after[2:4]) - sum(before[2:4]))


def a_sample(few, more, count=MORE):
    return [(m - f) / (count - FEW) for f, m in zip(few, more)]


def blender(job, folder):
    path = folder / "job.json"
    path.write_text(json.dumps({"size": [2, 2], "max_bounces": BOUNCES - 1, "threads": 2, "samples": []} | job))
    return run(["blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
                HERE / "cycles_render.py", "--", path])[0]


def meristem(program, folder, size, threads, mode):
    def cost(samples):
        return run([program, "render", HERE / "terrain.jsonc", "--size", "{}x{}".format(*size), "--threads", threads,
                    "--expand", mode, "--samples", samples, "--budget", "4G", "-q", "-o", folder / "meristem.exr"])[1]

    return lambda: a_sample(cost(FEW), cost(MORE))


def cycles(folder, size, threads):
    job = {"mesh": str((folder / "terrain.blend").resolve()), "materials": {"grey": GREY}, "camera": CAMERA,
           "size": size, "samples": [FEW, MOST], "sky": SKY, "suns": [SUN], "threads": threads}

    def cost():
        seconds = json.loads(re.search(r"^CYCLES (.*)$", blender(job, folder), re.MULTILINE)[1])
        return a_sample(seconds[str(FEW)], seconds[str(MOST)], MOST)

    return cost


def embree(folder, size, threads):
    view = [x for name, key in (("--vp", "from"), ("--vi", "to"), ("--vu", "up")) for x in [name, *CAMERA[key]]]
    command = ["pathtracer", "-i", folder / "terrain.xml", "--size", *size, *view, "--fov", CAMERA["fov"],
               "--righthanded", "--spp", 1, "--max-path-length", BOUNCES, "--ambientlight", *SKY,
               "--directionallight", *SUN["direction"], *[SUN["irradiance"]] * 3, "--threads", threads, "--benchmark"]
    return lambda: a_sample(run([*command, 0, FEW])[1], run([*command, 0, MORE])[1])


def prepare(program, folder):
    mesh, blend, ecs = (folder / f"terrain.{e}" for e in ("obj", "blend", "xml"))
    if not mesh.exists():
        run([program, "export", HERE / "terrain.jsonc", "-o", mesh])
    if not ecs.exists():
        run(["embree-convert", "-i", mesh, "-o", ecs])
    if not blend.exists():
        blender({"mesh": str(mesh.resolve()), "save": str(blend.resolve()), "materials": {"grey": GREY}}, folder)


def report(size, costs):
    pixels = size[0] * size[1]
    print(f"{'':8} {'paths a second of wall':>23} {'of a processor':>15} {'spread':>7}   of the others, by processor")
    best = {name: [min(c[i] for c in rounds) for i in range(2)] for name, rounds in costs.items()}
    for name, (wall, processor) in best.items():
        spread = max(c[1] for c in costs[name]) / processor - 1
        ratios = ", ".join(f"{other[1] / processor:.2f} x {label}" for label, other in best.items() if label != name)
        print(f"{name:8} {pixels / wall:23.0f} {pixels / processor:15.0f} {100 * spread:6.0f}%   {ratios}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meristem")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", default="lazy,eager,cycles,embree")
    parser.add_argument("--folder", default="peers", help="where the mesh is kept from run to run")
    parser.add_argument("--prepare", action="store_true", help="only make the mesh, in the forms that load fast")
    options = parser.parse_args()
    size = [int(n) for n in options.size.split("x")]
    folder = pathlib.Path(options.folder)
    folder.mkdir(parents=True, exist_ok=True)
    prepare(options.meristem, folder)
    if options.prepare:
        return
    all_of_them = {mode: meristem(options.meristem, folder, size, options.threads, mode)
                   for mode in ("lazy", "eager", "flat")}
    all_of_them |= {"cycles": cycles(folder, size, options.threads), "embree": embree(folder, size, options.threads)}
    programs = {name: all_of_them[name] for name in options.only.split(",")}
    costs = {name: [] for name in programs}
    for _ in range(options.rounds):
        for name, cost in programs.items():
            costs[name].append(cost())
    report(size, costs)


main()
