"""Reads the examples of the documentation as the program does.

    doc_examples.py MERISTEM ROOT          the program and the tree whose README.md and docs/*.md are read
    doc_examples.py MERISTEM --self-test   checks this check

A block marked jsonc is a file: under the name in its first line if that is a comment like "// stones.jsonc". The files
of one page stand in one folder. A block with a camera is a scene, which `meristem check` must accept; one without must
be included by such a scene. If a block marked text follows, the scene is wrong and the check must say just that.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"// ([\w-]+\.jsonc)\n")
CAMERA = re.compile(r'^ *"cameras?":', re.MULTILINE)


def examples(text):
    """(line, name, scene, messages expected of it or None) of every jsonc block."""
    blocks = [(text.count("\n", 0, m.start()) + 1, m[1], m[2]) for m in BLOCK.finditer(text)]
    following = blocks[1:] + [(0, "", "")]
    for (line, language, body), (_, next_language, next_body) in zip(blocks, following):
        if language == "jsonc":
            named = NAME.match(body)
            name = named[1] if named else f"example_{line}.jsonc"
            yield line, name, body, next_body if next_language == "text" else None


def check(program, folder, name):
    run = subprocess.run([program, "check", name], cwd=folder, text=True, capture_output=True)
    return run.returncode, run.stderr


def complaint(program, folder, name, expected):
    code, messages = check(program, folder, name)
    if expected is None and (code or messages):
        return f"ends with {code}:\n{messages}"
    if expected is not None and messages.strip() != expected.strip():
        return f"expected\n{expected}\nfound\n{messages}"
    return None


def errors_in(program, path, text):
    """What is wrong with the examples of one page."""
    all_examples = list(examples(text))
    included = {name for _, _, body, _ in all_examples for name in re.findall(r"[\w-]+\.jsonc(?=\")", body)}
    with tempfile.TemporaryDirectory() as folder:
        for _, name, body, _ in all_examples:
            (pathlib.Path(folder) / name).write_text(body, encoding="utf-8")
        for line, name, body, expected in all_examples:
            if CAMERA.search(body):
                wrong = complaint(program, folder, name, expected)
            else:
                wrong = None if name in included else "is no scene (it has no camera), and no scene includes it"
            if wrong:
                yield f"{path}:{line}: {name} {wrong}"


def self_test(program):
    def block(language, text):
        return f"```{language}\n{text}\n```\n"

    part = block("jsonc", '// part.jsonc\n{ "materials": { "m": {} } }')
    planted = {
        "good": (block("jsonc", '{\n  "camera": {},\n}'), None),
        "unknown member": (block("jsonc", '{\n  "camera": {}, "camra": {}\n}'), "camra"),
        "nothing": (block("jsonc", '{ "materials": {} }'), "no camera"),
        "included": (part + block("jsonc", '{\n  "include": "part.jsonc",\n  "camera": {}\n}'), None),
        "not as told": (block("jsonc", '{\n  "camera": { "fov": 999 }\n}') + block("text", "too wide"), "expected"),
        "no error though told": (block("jsonc", '{\n  "camera": {}\n}') + block("text", "an error"), "expected"),
        "another language": (block("json", "{ broken"), None),
    }
    for what, (page, expected) in planted.items():
        found = "\n".join(errors_in(program, "page", page))
        if (expected is None and found) or (expected and expected not in found):
            yield f"{what}: expected {expected!r}, found {found!r}"


def main(program, argument):
    if argument == "--self-test":
        errors = list(self_test(program))
    else:
        root = pathlib.Path(argument)
        pages = [root / "README.md", *sorted((root / "docs").glob("*.md"))]
        errors = [e for page in pages for e in errors_in(program, page.relative_to(root), page.read_text("utf-8"))]
    print("\n".join(errors) or "the examples are as the documentation says")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
