"""Reads every #include and names those that go upwards, leave their one place, or name no file.

    includes.py ROOT          checks the tree
    includes.py --self-test   checks this check: plants one violation of each kind and expects it to be named
"""
import pathlib
import re
import sys
import tempfile

# Layers from the bottom to the top; in each, its folders from the bottom to the top. A folder may include itself, what
# stands on lines above its own in its layer, and everything in the layers below. Folders on one line are strangers.
# A name with a dot is a file: that of a layer's root, or a generated one.
LAYERS = {
    "geometry": ["base", "fields", "mesh", "cells", "cache tree", "accel", "volumes io"],
    "procedural": ["subdivision", "growth", "components.h", "plants scatter motion clutter signing"],
    "renderer": [
        "scene",
        "color image",
        "textures film",
        "cameras samplers filters lights materials media denoise",
        "integrators",
        "components.h",
        "language",
        "loading",
        "session",
        "report interchange",
        "cli python viewer",
        "main.cpp",
    ],
}

# Headers of a dependency and the one folder (and its tests) that may include them; benches may measure against any.
ONE_PLACE = {
    r"(tbb|oneapi/tbb)/": "geometry/base",
    r"opensubdiv/": "geometry/mesh",
    r"embree[34]/": "geometry/accel",
    r"(openvdb|nanovdb)/": "geometry/volumes",
    r"(OpenImageIO|OpenEXR|Imath)/|png\.h": "renderer/image",
    r"OpenColorIO/": "renderer/color/ocio",
    r"CLI/": "renderer/cli",
}

GENERATED = {"renderer/components.h", "procedural/components.h"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)


def rank(path):
    """(layer, line in it, name on the line) of a path such as renderer/scene/scene.h; None if the table lacks it."""
    layer, name = path.split("/")[:2]
    layers = list(LAYERS)
    for line, names in enumerate(LAYERS[layer]):
        if name in names.split():
            return layers.index(layer), line, name
    return None


def may_include(source, target):
    if source is None or target is None:
        return False
    return target[0] < source[0] or target[:2] < source[:2] or target == source


def quoted_error(root, source, target):
    """What is wrong with `source` including "target", or None. A test may include what the folder it tests may."""
    if source.startswith("tests/") and ((root / source).parent / target).is_file():
        return None  # a helper beside the test
    if target not in GENERATED and not (root / target).is_file():
        return "there is no such file; paths start at the root of the tree"
    if source.startswith("tests/"):
        source, in_test = source.removeprefix("tests/"), True
        if source.split("/")[0] not in LAYERS:
            return None  # tests/bench, tests/scenes, tests/support: all of the tree
        if target.startswith("tests/"):
            return None
    else:
        in_test = False
        if target.startswith("tests/"):
            return "only tests include tests"
    from_rank, to_rank = rank(source), rank(target)
    for path, found in ((source, from_rank), (target, to_rank)):
        if found is None:
            return f"the folder of {path} is not in the table of tests/checks/includes.py"
    if in_test:  # of one layer, whatever the folder
        return None if to_rank[0] <= from_rank[0] else f"tests of {source.split('/')[0]} know nothing above it"
    return None if may_include(from_rank, to_rank) else "this goes upwards"


def bracket_error(source, target):
    if source.startswith("tests/bench/"):
        return None
    for pattern, place in ONE_PLACE.items():
        if re.match(pattern, target) and not source.removeprefix("tests/").startswith(place + "/"):
            return f"only {place} includes it"
    return None


def sources_below(root):
    for top in [*LAYERS, "tests"]:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path


def errors_in(root):
    for path in sources_below(root):
        source = path.relative_to(root).as_posix()
        text = path.read_text()
        own_header = source.removesuffix(".cpp") + ".h"
        for i, match in enumerate(INCLUDE.finditer(text)):
            quoted, bracket = match.groups()
            error = quoted_error(root, source, quoted) if quoted else bracket_error(source, bracket)
            has_own_header = source.endswith(".cpp") and (root / own_header).is_file()
            if not error and i == 0 and has_own_header and quoted != own_header:
                error = f"{own_header} comes first, so that it is known to stand alone"
            if error:
                line = text.count("\n", 0, match.start(1 if quoted else 2)) + 1
                yield f'{source}:{line}: includes {quoted or bracket}: {error}'


def self_test():
    """Each planted include with the word its message must contain; None: it is allowed."""
    planted = {
        "geometry/base/a.h": ('"geometry/mesh/b.h"', "upwards"),
        "geometry/mesh/b.h": ('"geometry/base/a.h"', None),
        "geometry/cells/c.h": ('"renderer/scene/d.h"', "upwards"),
        "renderer/scene/d.h": ('"geometry/cells/c.h"', None),
        "renderer/lights/e.cpp": ('"renderer/cameras/f.h"', "upwards"),
        "renderer/cameras/f.h": ("<tbb/parallel_for.h>", "only geometry/base"),
        "renderer/cameras/f.cpp": ("<vector>", "comes first"),
        "geometry/accel/g.cpp": ("<embree3/rtcore.h>", None),
        "geometry/accel/h.cpp": ('"surface.h"', "no such file"),
        "geometry/fresh/i.cpp": ('"geometry/base/a.h"', "not in the table"),
        "renderer/session/j.cpp": ('"renderer/components.h"', None),
        "renderer/lights/k.cpp": ('"renderer/components.h"', "upwards"),
        "tests/geometry/accel/l.cpp": ("<embree3/rtcore.h>", None),
        "tests/geometry/base/m.cpp": ('"procedural/growth/n.h"', "know nothing above"),
        "procedural/growth/n.h": ('"tests/support/o.h"', "only tests"),
        "tests/renderer/scene/p.cpp": ('"q.h"', None),
        "tests/renderer/scene/q.h": ('"geometry/base/a.h"', None),
        "tests/support/o.h": ('"renderer/scene/d.h"', None),
    }
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for path, (target, _) in planted.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(f"#pragma once\n\n#include {target}\n")
        found = {message.split(":")[0]: message for message in errors_in(root)}
    wrong = []
    for path, (target, expected) in planted.items():
        message = found.get(path, "")
        if (expected is None and message) or (expected and expected not in message):
            wrong.append(f"{path} including {target}: expected {expected!r}, found {message!r}")
        if message and f"{path}:3:" not in message:
            wrong.append(f"expected line 3: {message}")
    return wrong


def main(argument):
    errors = self_test() if argument == "--self-test" else list(errors_in(pathlib.Path(argument)))
    print("\n".join(errors) or "no include goes upwards or leaves its one place")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
