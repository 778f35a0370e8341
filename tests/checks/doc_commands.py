"""Runs the commands of a page of the documentation as a reader would.

    doc_commands.py MERISTEM PAGE        the program and the page
    doc_commands.py MERISTEM --self-test

All blocks marked sh are run in their order in one empty folder, where the page's blocks marked jsonc or pbrt stand
under the names of their first lines. Each line must end with exit code 0, and the files it names by -o must be there
then.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"(?://|#) ([\w-]+\.(?:jsonc|pbrt))\n")
OUTPUT = re.compile(r" -o ([\w.]+)(?= |$)")


def errors_in(program, text):
    with tempfile.TemporaryDirectory() as folder:
        bin_folder = pathlib.Path(folder) / "bin"
        bin_folder.mkdir()
        (bin_folder / "meristem").symlink_to(pathlib.Path(program).resolve())
        environment = dict(os.environ, PATH=f"{bin_folder}:{os.environ['PATH']}")
        for _, body in (m.groups() for m in BLOCK.finditer(text) if m[1] in ("jsonc", "pbrt")):
            if name := NAME.match(body):
                (pathlib.Path(folder) / name[1]).write_text(body, encoding="utf-8")
        for _, body in (m.groups() for m in BLOCK.finditer(text) if m[1] == "sh"):
            for command in body.splitlines():
                run = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, text=True,
                                     capture_output=True)
                if run.returncode != 0:
                    yield f"{command}\nends with {run.returncode}: {run.stderr}"
                for path in OUTPUT.findall(command):
                    if not (pathlib.Path(folder) / path).exists():
                        yield f"{command}\nhas not written {path}"


def self_test(program):
    scene = '```jsonc\n// a.jsonc\n{ "camera": {}, "render": { "size": [2, 2], "samples": 1 } }\n```\n'
    planted = {
        "good": ("meristem render a.jsonc -o a.png -q", None),
        "fails": ("meristem render a.jsonc --samples none", "ends with 2"),
        "writes nothing": ("true -o b.png", "not written b.png"),
    }
    for what, (command, expected) in planted.items():
        found = "\n".join(errors_in(program, f"{scene}```sh\n{command}\n```\n"))
        if (expected is None and found) or (expected and expected not in found):
            yield f"{what}: expected {expected!r}, found {found!r}"


def main(program, argument):
    errors = list(self_test(program) if argument == "--self-test" else
                  errors_in(program, pathlib.Path(argument).read_text("utf-8")))
    print("\n".join(errors) or "the commands do what the page says")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
