"""Reads every text file of ours and names lines that break the habits of the tree: tabs, white space at the end, lines
over 120 columns in sources, conflict marks, paths of one machine (in the metadata of PNG files, too), hosts of package
registries, a header without #pragma once, a file that does not end in a line feed, links between pages that lead
nowhere, mentions of pages that are not there, scenes whose descriptions are not small.

    text.py ROOT          checks the tree
    text.py --self-test   checks this check
"""
import pathlib
import re
import sys
import tempfile

FILES = ["dev", "README.md", "CMakeLists.txt", "CMakePresets.json", ".clang-format", ".gitignore"]
FOLDERS = ["geometry", "procedural", "renderer", "tests", "cmake", "docs", "scenes", ".ci"]
SOURCES = {".h", ".cpp", ".py", ".cmake", ".txt", ".sh"}
TEXTS = SOURCES | {".md", ".json", ".jsonc", ".yml", ""}
GENERATED = {"docs/components.md", "docs/scene.schema.json"}
LIMIT = 120
SMALL, SMALL_FOREST = 4096, 16384  # bytes of a scene file

# Patterns are written so that they do not match themselves.
MACHINE_PATH = r"(?<![\w.])/(?:work|home|root)/"
LINE_RULES = [
    (r"\t", "a tab"),
    (r"[ \t\r]$", "white space at the end of the line"),
    (r"^(<{7}|>{7}) ", "a conflict mark"),
    (MACHINE_PATH, "a path of one machine"),
    (r"(?:deb\.debian|pypi|pythonhosted|npmjs|proxy\.golang)\.org|crates\.io", "a host of a package registry"),
]


def texts_below(root):
    yield from filter(pathlib.Path.is_file, (root / name for name in FILES))
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            generated = path.relative_to(root).as_posix() in GENERATED or "__pycache__" in path.parts
            if path.is_file() and path.suffix in TEXTS and not generated:
                yield path


def errors_in_pictures(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*.png")):
            data, at = path.read_bytes(), 8
            while at < len(data):  # chunks: length, type, content, checksum
                length, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
                content = data[at + 8:at + 8 + length]
                if kind == b"tEXt" and re.search(MACHINE_PATH.encode(), content):
                    entry = content.replace(b"\0", b" ").decode("latin-1")[:100]
                    yield f"{path.relative_to(root).as_posix()}: a path of one machine: {entry}"
                at += 12 + length


def anchors_of(page):
    headings = re.findall(r"^#+ (.+)$", page, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def errors_in_links(root, path, text):
    if path.suffix == ".md":
        for target, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)\s]+))?\)", text):
            page = path.parent / target if target else path
            if page.relative_to(root).as_posix() in GENERATED:
                continue
            if not page.exists():
                yield f"a link to {target}, which is not there"
            elif anchor and anchor not in anchors_of(page.read_text(encoding="utf-8")):
                yield f"a link to {target}#{anchor}, a heading that is not there"
    for page in set(re.findall(r"\bdocs/[\w/-]*\w\w\.md\b", text)) - GENERATED:
        if not (root / page).exists():
            yield f"mentions {page}, which is not there"


def errors_in(root):
    yield from errors_in_pictures(root)
    for path in texts_below(root):
        name = path.relative_to(root).as_posix()
        try:
            text = path.read_bytes().decode()  # not read_text(), which hides carriage returns
        except UnicodeDecodeError as error:
            yield f"{name}: not UTF-8: {error.reason} at byte {error.start}"
            continue
        if text and not text.endswith("\n"):
            yield f"{name}: does not end in a line feed"
        if name.startswith("scenes/") and path.suffix == ".jsonc":
            size, most = path.stat().st_size, SMALL_FOREST if path.stem == "forest" else SMALL
            if size > most:
                yield f"{name}: {size} bytes; a scene has {most} at most"
        if path.suffix == ".h" and "#pragma once" not in text:
            yield f"{name}: no #pragma once"
        yield from (f"{name}: {error}" for error in errors_in_links(root, path, text))
        for number, line in enumerate(text.split("\n"), 1):
            for pattern, what in LINE_RULES:
                if re.search(pattern, line):
                    yield f"{name}:{number}: {what}"
            if path.suffix in SOURCES and len(line) > LIMIT:
                yield f"{name}:{number}: {len(line)} columns; the limit is {LIMIT}"


def self_test():
    planted = {
        "geometry/a.h": ("int a;\n", "no #pragma once"),
        "geometry/b.cpp": ("\tint b;\n", "a tab"),
        "geometry/c.cpp": ("int c; \n", "white space"),
        "docs/d.md": ("windows\r\n", "white space"),
        "docs/e.md": ("no end", "line feed"),
        "geometry/f.cpp": ("//" + "x" * LIMIT + "\n", "122 columns"),
        "docs/g.md": ("see " + "/home" + "/me/notes\n", "path of one machine"),
        "docs/h.md": ("https://py" + "pi.org/x\n", "package registry"),
        "docs/i.md": ("<" * 7 + " ours\n", "conflict"),
        "docs/z.md": ("\udcff\n", "not UTF-8"),
        "docs/j.md": ("x" * 200 + "\n", None),
        "docs/l.md": ("[a](m.md)\n", "a link to m.md"),
        "docs/n.md": ("# No way\n[a](n.md#no-way), [a](#no-way), [a](../geometry/k.h)\n", None),
        "docs/o.md": ("# No way\n[a](#no-way-out)\n", "a heading"),
        "geometry/r.h": ("// docs/" + "no.md\n#pragma once\n", "mentions docs/" + "no.md"),
        "scenes/s.jsonc": ("x" * SMALL + "\n", "4097 bytes"),
        "scenes/forest.jsonc": ("x" * SMALL + "\n", None),
        "geometry/k.h": ("// ../root/x is no such path\n#pragma once\n", None),
    }
    for path, text, expected in [("docs/p.png", "/home" + "/me/meristem", "path of one machine"),
                                 ("docs/q.png", "build/meristem", None)]:
        chunk = "meristem:command\0" + text
        head = (len(chunk)).to_bytes(4, "big") + b"tEXt"
        planted[path] = ("\x89PNG\r\n\x1a\n" + (head + chunk.encode() + bytes(4)).decode("latin-1"), expected)
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for path, (text, _) in planted.items():
            (root / path).parent.mkdir(exist_ok=True)
            is_picture = path.endswith(".png")
            (root / path).write_bytes(text.encode("latin-1" if is_picture else "utf-8", errors="surrogateescape"))
        found = list(errors_in(root))
    wrong = []
    for path, (_, expected) in planted.items():
        messages = [m for m in found if m.startswith(path)]
        if len(messages) != (expected is not None) or (expected and expected not in messages[0]):
            wrong.append(f"{path}: expected {expected!r}, found {messages}")
    return wrong


def main(argument):
    errors = self_test() if argument == "--self-test" else list(errors_in(pathlib.Path(argument)))
    print("\n".join(errors) or "every text file keeps the habits of the tree")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
