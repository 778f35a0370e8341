#!/usr/bin/env python3
"""The report page in a browser: report_page.py MERISTEM SCHEMA

Profiles and compares a small scene, then checks that the statistics fit SCHEMA, that the Chrome trace is one, and that
each page loads in headless Chromium without network, draws its plots, and shows the figures of its JSON.
"""
import html
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import jsonschema

# A plate with tufts, split into some hundred cells.
SCENE = """{
  "models": {
    "plate": {
      "base": { "type": "plane", "width": 4, "depth": 4, "columns": 6, "rows": 6, "face": "tuft(1)" },
      "steps": [
        { "grow": 2, "rules": { "tuft(n)": [ { "template": "extrude", "inset": 0.2, "height": "0.1 + 0.5*rand()",
                                               "faces": { "cap": "tuft(0)" } } ] } },
        { "subdivide": 5, "place": "0.1*scale*N*snoise(3*P)" } ] } },
  "objects": [ { "model": "plate" } ],
  "lights": [ { "type": "sky" } ],
  "camera": { "from": [3, 3, 5], "to": [0, 0, 0], "fov": 50 }
}"""

# Added to a copy of the page: tells what is on it once it is drawn. A plot counts if its canvas has colours in it.
PROBE = """
<script>
addEventListener("load", () => setTimeout(() => {
  const drawn = [...document.querySelectorAll(".uplot canvas")].map((canvas) => {
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const colors = new Set();
    for (let i = 0; i < pixels.length; i += 4)
      if (pixels[i + 3] === 255) colors.add(pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]);
    return colors.size;
  });
  const text = (id) => document.getElementById(id)?.firstChild.textContent;
  const found = {
    ready: document.documentElement.dataset.ready, errors: window.probe_errors, drawn,
    sections: [...document.querySelectorAll("section")].map((s) => s.id),
    figures: Object.fromEntries(["resident", "expanded", "again"].map((id) => [id, text("figure-" + id)])),
    hints: [...document.querySelectorAll(".hints li")].map((e) => e.textContent),
    rows: [...document.querySelectorAll("#variants tbody tr")].map((r) => [...r.cells].map((c) => c.textContent)),
    images: [...document.images].map((i) => i.naturalWidth),
    totals: [...document.querySelectorAll("section#cells tr.total")].map((r) => r.cells[1].textContent),
  };
  const e = document.createElement("pre");
  e.id = "found";
  e.textContent = JSON.stringify(found);
  document.body.append(e);
}, 300));
</script>
"""
ERRORS = "<script>window.probe_errors = []; addEventListener('error', (e) => probe_errors.push(e.message));</script>"


def run(*command):
    return subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True)


def look_at(page, folder):
    """What the probe found on the page."""
    text = page.read_text()
    assert not re.search(r"""(src|href)=["']?(https?:)?//""", text), "the page reaches for the network"
    probed = folder / "probed.html"
    probed.write_text(text.replace("<head>", "<head>" + ERRORS, 1).replace("</body>", PROBE + "</body>"))
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    assert browser, "no chromium here; ./dev test installs it"
    dom = run(browser, "--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1200,2000",
              f"--user-data-dir={folder}/browser", "--host-resolver-rules=MAP * ~NOTFOUND",
              "--virtual-time-budget=6000", "--dump-dom", probed.as_uri()).stdout
    found = re.search(r'<pre id="found">(.*?)</pre>', dom, re.S)
    assert found, "the page did not come to its end"
    return json.loads(html.unescape(found.group(1)))


def count(text):
    return int(text.replace(",", ""))


def check_drawn(found, plots, sections):
    assert found["errors"] == [] and found["ready"] == "true", found["errors"]
    assert len(found["drawn"]) >= plots and all(colors >= 2 for colors in found["drawn"]), found["drawn"]
    assert set(sections) <= set(found["sections"]), found["sections"]
    assert found["images"] and all(width > 0 for width in found["images"]), found["images"]


def check_profile(meristem, scene, schema, folder):
    page, stats, trace = folder / "p.html", folder / "s.json", folder / "t.json"
    options = ["--size", "48x32", "--samples", "2", "--budget", "3M", "--threads", "2", "--detail", "0"]
    run(meristem, "profile", scene, "-o", page, "--stats", stats, "--trace", trace, *options)
    figures = json.loads(stats.read_text())
    jsonschema.validate(figures, json.loads(schema.read_text()))
    found = look_at(page, folder)
    check_drawn(found, 5, ["glance", "images", "memory", "work", "time", "cells", "latency", "budget", "bounds",
                           "method"])
    expansion, profile = figures["expansion"], figures["profile"]
    assert count(found["figures"]["expanded"]) == expansion["cells_expanded"] > 0
    assert [count(t) for t in found["totals"]] == [expansion["cells_expanded"]] * 2
    again = profile["reuse"]["reexpanded"] / expansion["cells_expanded"]
    assert found["figures"]["again"] == f"{again:.0%}".replace("%", " %")
    mib = expansion["resident_bytes_peak"] / 2**20
    assert found["figures"]["resident"] == (f"{mib:.1f} MiB" if mib < 99.95 else f"{mib:.0f} MiB")
    assert found["hints"] == [h["text"] for h in figures["hints"]]
    assert sum(c["expanded"] for c in profile["classes"]) == expansion["cells_expanded"]
    assert sum(profile["timeline"]["expanded"]) == sum(profile["latency"]["counts"]) == expansion["cells_expanded"]
    check_trace(json.loads(trace.read_text()), figures)


def check_trace(trace, figures):
    """As the format's description has it: complete events have times, and those of a thread nest."""
    events = trace["traceEvents"]
    spans = [e for e in events if e["ph"] == "X"]
    assert {"load", "render", "build"} <= {e["name"] for e in spans}
    expansions = [e for e in spans if e["name"].startswith("expand")]
    assert len(expansions) == figures["expansion"]["cells_expanded"]
    assert sum(e["name"] == "expand again" for e in expansions) == figures["profile"]["reuse"]["reexpanded"]
    assert all(e["ts"] >= 0 and e["dur"] >= 0 for e in spans)
    assert max(e["ts"] + e["dur"] for e in spans) <= figures["wall_s"] * 1e6
    for thread in {e["tid"] for e in spans} - {0}:
        ends = []
        for e in sorted((e for e in spans if e["tid"] == thread), key=lambda e: (e["ts"], -e["dur"])):
            while ends and ends[-1] <= e["ts"] + 1:
                ends.pop()
            assert not ends or e["ts"] + e["dur"] <= ends[-1] + 1, e  # within a microsecond
            ends.append(e["ts"] + e["dur"])
    assert any(e["ph"] == "C" for e in events)


def check_comparison(meristem, scene, folder):
    page = folder / "c.html"
    options = ["--size", "128x80", "--samples", "1", "--threads", "2"]
    run(meristem, "compare", scene, "-o", page, "--budgets", "60%", *options)
    found = look_at(page, folder)
    check_drawn(found, 2, ["words", "variants", "budgets", "memory", "images", "method"])
    data = json.loads(re.search(r'id="data">(.*?)</script>', page.read_text(), re.S).group(1))
    variants = data["variants"]
    assert [v["mode"] for v in variants] == ["lazy", "lazy", "eager", "flat"]
    assert [row[0] for row in found["rows"]] == [v["name"] for v in variants]
    assert [count(row[5]) for row in found["rows"]] == [v["runs"][0]["cells"] for v in variants]
    assert found["hints"] == [h["text"] for h in data["hints"]]
    assert [v["difference"] for v in variants][0] is None
    assert variants[2]["difference"]["differing_pixels"] == 0


def main():
    meristem, schema = (Path(a).resolve() for a in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as name:
        scene = Path(name) / "plate.jsonc"
        scene.write_text(SCENE)
        check_profile(meristem, scene, schema, Path(name))
        check_comparison(meristem, scene, Path(name))
    print("the report pages load, are drawn, and show the figures of their JSON")


if __name__ == "__main__":
    main()
