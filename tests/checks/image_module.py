"""The image libraries stay out of the program, and it says so if their module is missing.

    image_module.py PROGRAM
"""
import os
import pathlib
import subprocess
import sys
import tempfile

SCENE = '{ "camera": { "from": [0, 0, 1], "to": [0, 0, 0] }, "render": { "size": [2, 2], "samples": 1 } }'


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    libraries = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    if "OpenImageIO" in libraries or "OpenColorIO" in libraries:
        return f"{program} is linked with OpenImageIO or OpenColorIO: up to half a second at every start"
    with tempfile.TemporaryDirectory() as folder:
        alone = pathlib.Path(folder) / "meristem"
        try:
            os.link(program, alone)
        except OSError:  # another file system
            alone.write_bytes(program.read_bytes())
            alone.chmod(0o755)
        command = [alone, "render", "-", "-o", "a.png"]
        run = subprocess.run(command, input=SCENE, cwd=folder, capture_output=True, text=True)
        if run.returncode != 4 or "meristem_image.so is missing from " + folder not in run.stderr:
            return f"without the module: exit code {run.returncode}, {run.stderr}"
    return None


if __name__ == "__main__":
    sys.exit(main())
