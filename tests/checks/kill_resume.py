"""Kills renders that write checkpoints, at random times, until each is complete.

    kill_resume.py PROGRAM [KILLS]     5 in the test, 200 by hand

After every kill the image and the film are the old ones or complete, never in between; the image that is reached at
last has the bits of an unbroken render; nothing else is left in the folder but, at most, a file that the kill caught
between its naming and its renaming.
"""
import pathlib
import random
import struct
import sys
import tempfile
import time
import zlib

from running import Program

SAMPLES = 1500


def assert_whole_png(path):
    """Signature, checksums of all chunks, and the end."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    at, kind = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        (crc,) = struct.unpack(">I", data[at + 8 + length:at + 12 + length])
        assert crc == zlib.crc32(data[at + 4:at + 8 + length]), path
        at += 12 + length
    assert kind == b"IEND" and at == len(data), path


def assert_whole_film(path):
    """Magic, and three sections with the right checksums."""
    data = path.read_bytes()
    assert data[:16] == b"MERISTEM FILM 3\n", path
    at = 16
    for _ in range(3):
        size, crc = struct.unpack("<QI", data[at:at + 12])
        assert crc == zlib.crc32(data[at + 12:at + 12 + size]), path
        at += 12 + size
    assert at == len(data), path


def check_files(folder):
    for name, check in [("a.png", assert_whole_png), ("a.film", assert_whole_film)]:
        if (folder / name).exists():
            check(folder / name)


def kill_until_complete(program, random_numbers, kills, longest_s):
    """Renders with --resume, killed after random times while kills are left. Returns the number of kills."""
    done = 0
    command = ["render", "ball.jsonc", "--samples", SAMPLES, "-o", "a.png", "-o", "a.exr", "--float", "--checkpoint",
               "0.05s", "--resume", "-q", "--stats", "stats.json"]
    while True:
        child = program.start(*command)
        if done < kills:
            time.sleep(random_numbers.uniform(0, longest_s))
            if child.poll() is None:
                child.kill()
                done += 1
        _, error = child.communicate()
        assert child.returncode in (0, -9), (child.returncode, error)
        check_files(program.folder)
        if child.returncode == 0:
            return done


def main(path, kills=5):
    random_numbers = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        program = Program(path, folder)
        started = time.monotonic()
        whole = program.digest("render", "ball.jsonc", "--samples", SAMPLES, "-o", "whole.exr", "--float")
        longest_s = 1.2 * (time.monotonic() - started)
        done = rounds = 0
        while done < kills:
            done += kill_until_complete(program, random_numbers, kills - done, longest_s)
            rounds += 1
            assert '"sha256": "' + whole in (program.folder / "stats.json").read_text(), "other bits than unbroken"
            assert "a.film" not in program.files()
            for name in ("a.png", "a.exr", "stats.json"):
                (program.folder / name).unlink()
        left = [p for p in pathlib.Path(folder).iterdir() if p.name not in ("ball.jsonc", "whole.exr", "stats.json")]
        assert all(p.suffix == ".tmp" for p in left), left
        print(f"{done} kills in {rounds} renders, {len(left)} temporary files left; all bits as in an unbroken render")


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
