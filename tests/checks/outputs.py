"""What `meristem render` writes, as another program (oiiotool) reads it.

    outputs.py PROGRAM
"""
import json
import re
import struct
import sys
import tempfile

from running import Program, oiiotool, pixels

ALL = ["beauty", "albedo", "normal", "Z", "P", "uv", "motion", "id.object", "id.material", "level", "samples",
       "variance", "second_half", "cost.time", "cost.expand", "cost.reexpand", "crypto_object", "crypto_material",
       "crypto_production"]


def parts_of(folder, image):
    """Name, format and channels of every part, and the whole text."""
    text = oiiotool(folder, "--info", "-v", "-a", image)
    names = re.findall(r'oiio:subimagename: "(.*)"', text)
    kinds = re.findall(r"subimage +\d+: .*channel, (\w+)", text)
    channels = re.findall(r"channel list: (.*)", text)
    return list(zip(names, kinds, channels)), text


def check_parts(program):
    program.run("render", "ball.jsonc", "-o", "all.exr", "-o", "all.png", "-o", "all.jpg", "-o", "all.tif", "--bits",
                "16", "--aov", "all", "-q", "--seed", "5")
    parts, text = parts_of(program.folder, "all.exr")
    assert [name for name, _, _ in parts] == ALL, parts
    assert [kind for _, kind, _ in parts] == ["half"] + ["float"] * (len(ALL) - 1), parts
    by_name = {name: channels for name, _, channels in parts}
    assert by_name["beauty"] == "R, G, B, A"
    assert by_name["normal"] == "normal.X, normal.Y, normal.Z"
    assert by_name["crypto_object"].startswith("crypto_object00.R, crypto_object00.G"), by_name["crypto_object"]
    assert by_name["crypto_object"].endswith("crypto_object02.A"), by_name["crypto_object"]
    for wanted in ['meristem:seed: "5"', 'meristem:scene: "ball.jsonc"', "meristem:scene_sha256", "meristem:history",
                   "meristem:peak_rss_bytes", "meristem:cells_expanded", 'meristem:sample_range: "0:16"', "DateTime"]:
        assert wanted in text, f"no {wanted} in\n{text}"
    assert "16 x    9, 3 channel, uint16 tiff" in oiiotool(program.folder, "--info", "all.tif")
    assert set(pixels(program.folder, "all.exr", ALL.index("samples"))) == {16}


def check_cryptomatte(program):
    _, text = parts_of(program.folder, "all.exr")
    manifest = json.loads(re.search(r'cryptomatte/f834d0a/manifest: "(.*)"', text)[1].replace('\\"', '"'))
    assert set(manifest) == {"left", "ball"}, manifest
    assert re.search(r'cryptomatte/f834d0a/conversion: "uint32_to_float32"', text)
    # Every hash in the image is in the manifest, and both objects are seen
    values = pixels(program.folder, "all.exr", ALL.index("crypto_object"))
    ranks = list(zip(values[0::2], values[1::2]))
    assert len(ranks) == 16 * 9 * 6
    seen = {struct.pack("<f", number).hex() for number, coverage in ranks if coverage > 0}
    assert seen == {struct.pack("<I", int(digits, 16)).hex() for digits in manifest.values()}, (seen, manifest)
    assert 0 < sum(coverage for _, coverage in ranks) < 16 * 9
    assert all(0 <= coverage <= 1 for _, coverage in ranks)
    # Both balls are one model that nothing grew on
    made = re.search(r'cryptomatte/b79aff6/manifest: "(.*)"', text)[1].replace('\\"', '"')
    assert set(json.loads(made)) == {"ball/sphere"}, made
    covered = sum(pixels(program.folder, "all.exr", ALL.index("crypto_production"))[1::2])
    assert abs(covered - sum(coverage for _, coverage in ranks)) < 1e-4, covered


def check_camera_matrices(program):
    """A position in the world is seen in the pixel that shows it, by the matrices that compositors read."""
    size = (160, 90)
    program.run("render", "ball.jsonc", "-o", "camera.exr", "--aov", "P,Z", "--size", "160x90", "--samples", "4",
                "--set", '/render/filter={"type": "box"}', "--set", "/camera/shift_x=0.2", "-q", "--crop",
                "20,10,140,80")
    text = oiiotool(program.folder, "--info", "-v", "camera.exr")
    numbers = {name: [float(n) for n in values.replace(",", " ").split()]
               for name, values in re.findall(r"(worldTo\w+): ([-+.e\d, ]+)", text)}
    to_camera, to_ndc = numbers["worldToCamera"], numbers["worldToNDC"]

    def moved(position, matrix):
        row = [*position, 1]
        x, y, z, w = (sum(row[k] * matrix[4 * k + column] for k in range(4)) for column in range(4))
        return x / w, y / w, z / w

    depths = pixels(program.folder, "camera.exr", 1)
    positions = pixels(program.folder, "camera.exr", 2)
    shown = 0
    for i, depth in enumerate(depths):
        if not 0 < depth < 100:  # nothing is seen, or it is not in the crop
            continue
        position = positions[3 * i:3 * i + 3]
        x, y, _ = moved(position, to_ndc)
        pixel = (i % size[0], i // size[0])
        assert abs(x * size[0] - pixel[0] - 0.5) < 0.501 and abs(y * size[1] - pixel[1] - 0.5) < 0.501, (pixel, x, y)
        assert abs(moved(position, to_camera)[2] - depth) < 1e-4, (pixel, depth)
        shown += 1
    assert shown > 500, shown


def check_crop(program):
    whole = program.digest("render", "ball.jsonc", "-o", "whole.exr", "--float")
    crop = program.digest("render", "ball.jsonc", "-o", "crop.exr", "--float", "--crop", "4,2,12,8")
    assert whole != crop
    text = oiiotool(program.folder, "--info", "-v", "crop.exr")
    assert "8 x    6" in text and "pixel data origin: x=4, y=2" in text and "full/display size: 16 x 9" in text, text
    oiiotool(program.folder, "whole.exr", "--crop", "8x6+4+2", "-o", "cut.exr")
    oiiotool(program.folder, "cut.exr", "crop.exr", "--diff")


def check_display(program):
    """The display's own encoding of a known value, and the raw value."""
    flat = ["render", "ball.jsonc", "--set", "/objects=[]", "--set", '/lights=[{"type": "constant", "intensity": 0.5}]',
            "-q", "-o"]
    program.run(*flat, "raw.png", "--view", "Raw")
    program.run(*flat, "srgb.png", "--view", "sRGB")
    program.run(*flat, "video.png", "--view", "sRGB", "--display", "Rec.1886")
    for name, expected in [("raw.png", 0.5), ("srgb.png", 1.055 * 0.5 ** (1 / 2.4) - 0.055),
                           ("video.png", 0.5 ** (1 / 2.4))]:
        value = pixels(program.folder, name)[0]
        assert abs(value - expected) < 0.004, (name, value, expected)
    _, error = program.run("render", "ball.jsonc", "-o", "a.png", "--display", "Laser", code=2)
    assert "known: sRGB, Rec.1886, P3-D65" in error, error


def check_denoised(program):
    """The picture of an EXR is as without; display images show its second part. A film can be denoised later."""
    program.run("render", "ball.jsonc", "-o", "noisy.exr", "-o", "noisy.png", "-o", "noisy.film", "-q")
    program.run("render", "ball.jsonc", "-o", "quiet.exr", "-o", "quiet.png", "-o", "quiet.film", "--denoise", "-q")
    parts, text = parts_of(program.folder, "quiet.exr")
    names = [name for name, _, _ in parts]
    assert names == ["beauty", "denoised", "albedo", "normal", "variance", "second_half"], parts
    assert "meristem:denoised" in text and "meristem:denoised" not in parts_of(program.folder, "noisy.exr")[1], text
    assert pixels(program.folder, "quiet.exr") == pixels(program.folder, "noisy.exr")
    assert pixels(program.folder, "quiet.png") != pixels(program.folder, "noisy.png")
    program.run("merge", "quiet.film", "-o", "later.png", "--denoise", "-q")
    assert pixels(program.folder, "later.png") == pixels(program.folder, "quiet.png")
    _, error = program.run("merge", "noisy.film", "-o", "later.png", "--denoise", code=2)
    assert "rendered without --denoise" in error, error


def check_scene_aovs(program):
    program.run("render", "ball.jsonc", "-o", "some.exr", "--set", '/render/aovs=["Z", "albedo"]', "--aov", "P", "-q")
    parts, _ = parts_of(program.folder, "some.exr")
    assert [name for name, _, _ in parts] == ["beauty", "albedo", "Z", "P"], parts
    _, error = program.run("check", "ball.jsonc")
    _, error = program.run("render", "ball.jsonc", "--set", '/render/aovs=["Z", "depth"]', code=2)
    assert "--set:1:20: error: no AOV named \"depth\"" in error, error
    _, error = program.run("render", "ball.jsonc", "--aov", "depth", code=2)
    assert "no AOV named \"depth\"; known: all, albedo" in error, error


def check_textures(program):
    """A texture gives the same picture in rows and in tiles, with 8 and 16 bits, with and without an alpha channel."""
    oiiotool(program.folder, "--pattern", "noise:type=uniform:min=0:max=1", "300x200", "3", "-d", "uint8", "-o",
             "rows.png")
    oiiotool(program.folder, "rows.png", "--tile", "64", "48", "-o", "tiles.tif")
    oiiotool(program.folder, "rows.png", "-d", "uint16", "-o", "rows16.png")
    oiiotool(program.folder, "rows.png", "-d", "uint16", "--tile", "16", "16", "-o", "tiles16.tif")
    oiiotool(program.folder, "rows.png", "--ch", "R,G,B,A=1", "-o", "alpha.png")

    def picture(name, *more):
        texture = '/materials/clay={"textures": {"t": {"file": "%s"}}, "base_color": "t"}' % name
        return program.digest("render", "ball.jsonc", "-o", "a.exr", "--set", texture,
                              "--set", '/models/ball/material="clay"', *more)

    bytes_, shorts = picture("rows.png"), picture("rows16.png")
    assert picture("tiles.tif") == picture("alpha.png") == bytes_ and picture("tiles16.tif") == shorts
    assert bytes_ != picture("rows.png", "--set", "/materials/clay/textures/t/filter=0")


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], folder)
        check_parts(program)
        check_cryptomatte(program)
        check_camera_matrices(program)
        check_crop(program)
        check_display(program)
        check_denoised(program)
        check_scene_aovs(program)
        check_textures(program)
    print("images are what other programs expect")


if __name__ == "__main__":
    main()
