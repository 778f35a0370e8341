"""What a picture costs while its scene grows from 10^6 to 10^12 faces: mountains.jsonc with more and more levels.

    scale.py MERISTEM [--runs N] [--svg FILE]

Prints a table: medians of N runs, the sizes in turns; --svg draws it.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import tempfile

SCENE = pathlib.Path(__file__).resolve().parent / "mountains.jsonc"
LEVELS = (4, 6, 8, 10, 12, 14)  # displaced; three more lie before them
SERIES = (("wall time, s", "wall_s", 1, "#c0392b"), ("processor time, s", "processor_s", 1, "#2471a3"),
          ("peak memory, 100 MiB", "peak_rss_bytes", 1 / (100 << 20), "#7d8c3a"))


def faces_in_full(levels):
    return 100 * 4 ** (3 + levels)


def render(program, levels, folder):
    stats = folder / "stats.json"
    command = [program, "render", SCENE, "--size", "480x270", "--samples", 4, "-q", "-o", folder / "a.exr", "--stats",
               stats, "--set", f"/models/land/steps/2/subdivide={levels}"]
    timed = subprocess.run(["bash", "-c", 'TIMEFORMAT="%U %S"; time "$@"', "-", *map(str, command)], check=True,
                           text=True, capture_output=True)
    figures = json.loads(stats.read_text())
    figures["processor_s"] = sum(map(float, timed.stderr.split()[-2:]))
    return figures


def plot(rows, path):
    width, height, left, bottom = 640, 320, 46, 40
    top = max(row[key] * scale for row in rows.values() for _, key, scale, _ in SERIES) * 1.1
    exponents = [math.log10(faces_in_full(n)) for n in LEVELS]

    def at(exponent, value):
        x = left + (exponent - 6) / (exponents[-1] - 5.8) * (width - left - 10)
        return f"{x:.1f},{height - bottom - value / top * (height - bottom - 10):.1f}"

    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
             'font-size="12">', f'<rect width="{width}" height="{height}" fill="white"/>']
    for value in range(0, int(top) + 1):
        (x, y), (x2, _) = (map(float, at(e, value).split(",")) for e in (6, exponents[-1]))
        lines.append(f'<path d="M{x} {y}H{x2}" stroke="#ddd"/><text x="{x - 8}" y="{y + 4}" text-anchor="end">{value}'
                     "</text>")
    for exponent in range(6, int(exponents[-1]) + 1, 2):
        x = at(exponent, 0).split(",")[0]
        lines.append(f'<text x="{x}" y="{height - bottom + 18}" text-anchor="middle">10<tspan dy="-5" font-size="9">'
                     f"{exponent}</tspan></text>")
    lines.append(f'<text x="{width / 2}" y="{height - 6}" text-anchor="middle">faces of the scene in full</text>')
    for i, (name, key, scale, color) in enumerate(SERIES):
        points = [at(e, rows[n][key] * scale) for e, n in zip(exponents, LEVELS)]
        lines.append(f'<polyline points="{" ".join(points)}" fill="none" stroke="{color}" stroke-width="2"/>')
        lines.append(f'<text x="{left + 14}" y="{24 + 16 * i}" fill="{color}">{name}</text>')
    path.write_text("\n".join([*lines, "</svg>", ""]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meristem")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--svg", type=pathlib.Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = [{n: render(options.meristem, n, pathlib.Path(folder)) for n in LEVELS} for _ in range(options.runs)]
    keys = ("first_pixel_s", "wall_s", "processor_s", "peak_rss_bytes")
    rows = {n: {key: statistics.median(run[n][key] for run in runs) for key in keys} for n in LEVELS}
    print("| faces in full | faces expanded | first pixel | wall | processor | peak memory |")
    print("|---|---|---|---|---|---|")
    for n, row in rows.items():
        made = runs[0][n]["expansion"]["faces"]
        print(f"| {faces_in_full(n):.1e} | {made / 1e6:.1f} million | {row['first_pixel_s']:.2f} s | "
              f"{row['wall_s']:.1f} s | {row['processor_s']:.1f} s | {row['peak_rss_bytes'] / (1 << 20):.0f} MiB |")
    if options.svg:
        plot(rows, options.svg)


main()
