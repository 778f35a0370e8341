"""Running the program in tests: a tiny scene in a folder of its own, and what came of it."""
import json
import pathlib
import struct
import subprocess

SCENE = """// ball.jsonc
{
  "models": { "ball": { "base": { "type": "sphere" }, "steps": [ { "subdivide": 2 } ] } },
  "materials": { "clay": { "base_color": 0.6 } },
  "objects": [ { "model": "ball", "name": "left" }, { "model": "ball", "position": [1, 0, -1] } ],
  "lights": [ { "type": "sky" } ],
  "camera": { "from": [0, 1, 5], "to": [0.5, 0.3, 0], "fov": 35 },
  "render": { "size": [16, 9], "samples": 16 },
}
"""


class Program:
    """`meristem render` and friends in a folder with the scene ball.jsonc."""

    def __init__(self, program, folder):
        self.program = str(pathlib.Path(program).resolve())
        self.folder = pathlib.Path(folder)
        (self.folder / "ball.jsonc").write_text(SCENE, encoding="utf-8")

    def start(self, *arguments):
        return subprocess.Popen([self.program, *map(str, arguments)], cwd=self.folder, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def run(self, *arguments, code=0):
        """Standard output and error of a run that must end with `code`."""
        child = self.start(*arguments)
        out, error = child.communicate()
        assert child.returncode == code, f"{arguments} ends with {child.returncode}, not {code}:\n{error}"
        return out, error

    def digest(self, *arguments, code=0):
        """The digest of the picture that a render gives, 32-bit floats."""
        self.run(*arguments, "--stats", "stats.json", "-q", code=code)
        return json.loads((self.folder / "stats.json").read_text())["image"]["sha256"]

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())


def oiiotool(folder, *arguments):
    return subprocess.run(["oiiotool", *arguments], cwd=folder, text=True, capture_output=True, check=True).stdout


def tiff_values(data):
    """The numbers of an uncompressed little-endian TIFF of floats (TIFF 6.0, section 2)."""
    (at,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, at)
    fields = {}
    for i in range(count):
        tag, kind, number, value = struct.unpack_from("<HHII", data, at + 2 + 12 * i)
        size = {3: "H", 4: "I"}.get(kind)
        if size:
            place = value if number * struct.calcsize(size) > 4 else at + 10 + 12 * i
            fields[tag] = struct.unpack_from(f"<{number}{size}", data, place)
    offsets, lengths = fields[273], fields[279]
    return [v for o, n in zip(offsets, lengths) for v in struct.unpack_from(f"<{n // 4}f", data, o)]


def pixels(folder, image, part=0):
    """The values of a part of an image as floats, pixel after pixel, channel after channel."""
    oiiotool(folder, image, "--subimage", str(part), "-d", "float", "--compression", "none", "-o", "values.tif")
    return tiff_values((pathlib.Path(folder) / "values.tif").read_bytes())


def pixel_digests(folder, image):
    """The SHA-1 of the pixels of each part of an image, by another program."""
    text = subprocess.run(["oiiotool", "--info", "-v", "-a", "--hash", image], cwd=folder, text=True,
                          capture_output=True, check=True).stdout
    return [line.split()[-1] for line in text.splitlines() if "SHA-1" in line]
