"""OpenImageIO stays out of the program. PNG and EXR are written without its module; TIFF without is an error.

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
        os.symlink(program.parent / "meristem_color.so", pathlib.Path(folder) / "meristem_color.so")

        def render(*images):
            command = [alone, "render", "-", "-q", *(word for image in images for word in ("-o", image))]
            return subprocess.run(command, input=SCENE, cwd=folder, capture_output=True, text=True)

        written = render("a.png", "a.exr", "a.film")
        if written.returncode != 0:
            return f"PNG and EXR without the module: exit code {written.returncode}, {written.stderr}"
        refused = render("a.png", "a.tif")
        if refused.returncode != 4 or "meristem_image.so is missing from " + folder not in refused.stderr:
            return f"TIFF without the module: exit code {refused.returncode}, {refused.stderr}"
    return None


if __name__ == "__main__":
    sys.exit(main())
