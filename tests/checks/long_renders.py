"""Renders that are limited, stopped, carried on, divided and merged, through the real program.

    long_renders.py PROGRAM
"""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile

from running import Program, oiiotool, pixel_digests

ENDLESS = 1 << 20  # samples: more than a test waits for
AOVS = ["--aov", "albedo,normal,Z,P,uv,id.object,id.material,samples,variance,crypto_object,crypto_material"]


def start_endless(program, *arguments):
    """A render that is under way: its first report of progress has come."""
    child = program.start("render", "ball.jsonc", "--progress", "json", *arguments)
    progress = json.loads(child.stdout.readline())
    assert progress["event"] == "progress" and progress["samples"] <= progress["samples_total"], progress
    return child


def stop(child, number):
    child.send_signal(number)
    _, error = child.communicate()
    return child.returncode, error


def samples_of(folder, image):
    """The most samples that a pixel of an interrupted image has."""
    text = oiiotool(folder, "--info", "-v", image)
    return int(text.split('meristem:sample_range: "0:')[1].split('"')[0])


def check_interrupts(program):
    for number, code in [(signal.SIGINT, 130), (signal.SIGTERM, 143)]:
        child = start_endless(program, "--samples", ENDLESS, "-o", "a.exr", "--float", *AOVS)
        found, error = stop(child, number)
        assert found == code, (found, error)
        assert "--resume goes on from a.film" in error, error
        wanted = samples_of(program.folder, "a.exr") + 3
        options = ["render", "ball.jsonc", "--samples", wanted, "--float", *AOVS, "-o"]
        resumed = program.digest(*options, "a.exr", "--resume", "--threads", 3)
        whole = program.digest(*options, "whole.exr")
        assert resumed == whole
        digests = pixel_digests(program.folder, "a.exr")
        assert len(digests) == 12 and digests == pixel_digests(program.folder, "whole.exr")
        assert "a.film" not in program.files(), "the film of a complete render stays"
        history = oiiotool(program.folder, "--info", "-v", "a.exr").split("meristem:history")[1]
        assert "interrupted" in history and "complete" in history, history


def check_snapshots(program):
    """HUP and USR1 write images and film; the render goes on."""
    for number in (signal.SIGHUP, signal.SIGUSR1):
        child = start_endless(program, "--samples", ENDLESS, "-o", "b.png", "-v")
        child.send_signal(number)
        while "snapshot: wrote b.film" not in (line := child.stderr.readline()):
            assert line, "the render ended"
        assert child.poll() is None
        assert {"b.png", "b.film"} <= set(program.files())
        (program.folder / "b.png").unlink()
        code, _ = stop(child, signal.SIGTERM)
        assert code == 143 and "b.png" in program.files()
        (program.folder / "b.film").unlink()


def check_limits(program):
    _, error = program.run("render", "ball.jsonc", "--samples", ENDLESS, "--time-limit", "0.5s", "-o", "c.exr", code=3)
    assert "the time is up" in error, error
    assert "c.film" in program.files()
    (program.folder / "c.film").unlink()
    program.run("render", "ball.jsonc", "--samples", 4096, "--noise", "0.2", "-o", "d.exr", "-q", "--stats", "d.json")
    taken = json.loads((program.folder / "d.json").read_text())["samples_taken"]
    assert 16 * 16 * 9 <= taken < 4096 * 16 * 9, taken


def check_refusals(program):
    """A film is refused, in words, when anything that matters has changed."""
    scene = program.folder / "ball.jsonc"
    original = scene.read_text()
    (program.folder / "more.jsonc").write_text('{ "materials": { "chalk": {} } }')
    scene.write_text(original.replace('"models"', '"include": "more.jsonc",\n  "models"', 1))
    base = ["render", "ball.jsonc", "-o", "e.film", "--resume"]
    program.run(*base, "--samples", 4)
    for options, words in [(["--seed", "1"], "seed was 0 and is 1"), (["--size", "8x8"], "size was 16x9 and is 8x8"),
                           (["--set", "/camera/fov=20"], "--set was not given and is /camera/fov=20"),
                           (["--aov", "Z"], "AOVs was not given and is Z"), (["--max-depth", "2"], "max depth was 8"),
                           (["--shutter", "0.5"], "shutter was 0 in 8 moments and is 0.5 in 8 moments"),
                           (["--expand", "flat"], "expansion was by cells and is flat"),
                           (["--crop", "0,0,4,4"], "crop was 0,0,16,9 and is 0,0,4,4")]:
        _, error = program.run(*base, *options, code=2)
        assert "cannot resume from e.film" in error and words in error, error
    (program.folder / "more.jsonc").write_text('{ "materials": { "chalk": { "base_color": 0.1 } } }')
    _, error = program.run(*base, code=2)
    assert "more.jsonc has changed" in error, error
    (program.folder / "more.jsonc").write_text('{ "materials": { "chalk": {} } }')
    program.run(*base, "--samples", 8, "--threads", 1, "--budget", "1M", "--expand", "eager")  # none of these matters
    _, error = program.run(*base, "--samples", 4, code=2)  # the image would have more, and the film would go
    assert "up to 8 samples already, more than the 4 wanted" in error and "e.film" in program.files(), error
    bytes_ = bytearray((program.folder / "e.film").read_bytes())
    bytes_[len(bytes_) // 2] ^= 1
    (program.folder / "e.film").write_bytes(bytes_)
    _, error = program.run(*base, code=4)
    assert "it is damaged" in error, error
    (program.folder / "e.film").unlink()
    scene.write_text(original)


def check_merge(program):
    whole = program.digest("render", "ball.jsonc", "--samples", 50, "-o", "whole.exr", "--float", *AOVS)
    for name, part in [("one", "0:13"), ("two", "13:32"), ("three", "32:50")]:
        program.run("render", "ball.jsonc", "--sample-range", part, "-o", f"{name}.film", "-q", *AOVS)
    program.run("merge", "three.film", "one.film", "-o", "some.film", "-q")
    _, error = program.run("merge", "three.film", "one.film", "-o", "some.png")
    assert "samples 13:32 are in none of the films" in error, error
    program.run("merge", "some.film", "two.film", "-o", "merged.exr", "-o", "merged.png", "--float", "-q")
    assert pixel_digests(program.folder, "merged.exr") == pixel_digests(program.folder, "whole.exr")
    assert 'sample_range: "0:50"' in oiiotool(program.folder, "--info", "-v", "merged.exr")
    _, error = program.run("merge", "one.film", "some.film", "-o", "x.exr", code=2)
    assert "has samples 0:13, which another film of the list has, too" in error, error
    program.run("render", "ball.jsonc", "--sample-range", "13:32", "-o", "other.film", "-q", "--seed", 3, *AOVS)
    _, error = program.run("merge", "one.film", "other.film", "-o", "x.exr", code=2)
    assert "not of the same image: seed was 0 and is 3" in error, error
    program.run("render", "ball.jsonc", "--sample-range", "0:13", "--samples", 4, code=2)
    _, error = program.run("render", "ball.jsonc", "--sample-range", "0:13", "--set", "/render/noise=0.1", code=2)
    assert "does not go together with noise" in error, error
    assert whole


def check_frames(program):
    (program.folder / "take#2").mkdir()
    program.run("render", "ball.jsonc", "--frames", "3-3", "-o", "take#2/turn.png", "--samples", "1", "-q")
    assert (program.folder / "take#2" / "turn.0003.png").exists(), "a # in the name of a folder is no number"
    options = ["render", "ball.jsonc", "--frames", "3-7x2", "-o", "turn.##.png", "-o", "turn.exr", "--samples", "1"]
    program.run(*options, "--set=/camera/from==[5*sin(frame/4), 1, 5]", "-q")
    expected = ["turn.0003.exr", "turn.0005.exr", "turn.0007.exr", "turn.03.png", "turn.05.png", "turn.07.png"]
    assert [f for f in program.files() if f.startswith("turn")] == expected, program.files()
    contents = {pixel_digests(program.folder, f"turn.000{n}.exr")[0] for n in (3, 5, 7)}
    assert len(contents) == 3, "the frames are alike"
    program.run("render", "ball.jsonc", "--frames", "1-2", "-o", "u.png", "--samples", "1", "-q", "--trace", "t.json")
    assert {"t.0001.json", "t.0002.json"} <= set(program.files()), program.files()
    (program.folder / "turn.05.png").unlink()
    before = (program.folder / "turn.0003.exr").stat().st_mtime_ns
    _, error = program.run(*options, "--set=/camera/from==[5*sin(frame/4), 1, 5]", "--resume")
    assert "frame 3 is there" in error and "frame 5\n" in error and "frame 7 is there" in error, error
    assert (program.folder / "turn.0003.exr").stat().st_mtime_ns == before


def check_progress_and_logs(program):
    out, error = program.run("render", "ball.jsonc", "-o", "p.png", "--progress", "json")
    events = [json.loads(line) for line in out.splitlines()]
    assert events[-1]["fraction"] == 1 and events[-1]["samples"] == 16 * 16 * 9, events
    assert "wrote p.png" in error
    out, error = program.run("render", "ball.jsonc", "-o", "p.png", "--progress", "bar")
    assert out == "" and "100 %" in error and "\033[K" in error
    out, error = program.run("render", "ball.jsonc", "-o", "p.png", "-q")
    assert (out, error) == ("", "")
    _, error = program.run("render", "ball.jsonc", "-o", "p.png", "-v")
    assert "threads" in error and "cells: expanded" in error, error


def check_bad_disk(program):
    """A full disk, a folder that is not there: exit code 4, and the old file stays."""
    program.run("render", "ball.jsonc", "-o", "f.exr", "-o", "f.film", "-q")
    before = {name: (program.folder / name).read_bytes() for name in ("f.exr", "f.film")}
    command = f"ulimit -f 1; trap '' XFSZ; exec {program.program} render ball.jsonc --size 64x64 -o $0 -q"
    for name in before:
        run = subprocess.run(["bash", "-c", command, name], cwd=program.folder, text=True, capture_output=True)
        assert run.returncode == 4 and f"cannot write {name}: " in run.stderr, (name, run.returncode, run.stderr)
        assert (program.folder / name).read_bytes() == before[name], name
    program.run("render", "ball.jsonc", "-o", "nowhere/a.film", code=4)
    program.run("render", "ball.jsonc", "-o", "/dev/full", code=2)


def check_help(program):
    """--help fits a screen; the manual and the completion know every option."""
    help_text, _ = program.run("render", "--help")
    lines = help_text.splitlines()
    assert len(lines) <= 51 and max(map(len, lines)) <= 80, (len(lines), max(lines, key=len))
    options = {word.strip(",") for line in lines for word in line.split()[:1] if word.startswith("--")}
    assert len(options) > 20, options
    manual, _ = program.run("manual")
    (program.folder / "meristem.1").write_text(manual)
    completion, _ = program.run("completion")
    for option in options:
        assert option.replace("-", "\\-") in manual, option
        assert option in completion, option
    (program.folder / "meristem.bash").write_text(completion)
    script = "source ./meristem.bash; COMP_WORDS=(meristem {}); COMP_CWORD={}; _meristem; echo ${{COMPREPLY[@]}}"
    for words, index, expected in [("re", 1, "render"), ("render --sample", 2, "--samples --sample-range"),
                                   ("render --expand l", 3, "lazy"), ("merge --fl", 2, "--float")]:
        run = subprocess.run(["bash", "-c", script.format(words, index)], cwd=program.folder, text=True,
                             capture_output=True, check=True)
        assert run.stdout.strip() == expected, (words, run.stdout)


CHECKS = [check_interrupts, check_snapshots, check_limits, check_refusals, check_merge, check_frames,
          check_progress_and_logs, check_bad_disk, check_help]


def main():
    wanted = sys.argv[2:]
    for check in CHECKS:
        if wanted and check.__name__ not in wanted:
            continue
        with tempfile.TemporaryDirectory() as folder:
            check(Program(sys.argv[1], folder))
            left = [path.name for path in pathlib.Path(folder).glob("*.tmp")]
            assert not left, left
    print("long renders can be stopped, carried on, divided and merged")


if __name__ == "__main__":
    main()
