"""What bash offers behind `meristem ...`, by the completion that the program prints.

    completion.py PROGRAM
"""
import pathlib
import subprocess
import sys
import tempfile

# The function as readline calls it: an "=" stands in a word of its own
ASK = """source meristem.bash
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_meristem
printf '%s\\n' "${COMPREPLY[@]}"
"""


class Shell:
    def __init__(self, program, folder):
        self.folder = pathlib.Path(folder)
        text = subprocess.run([str(pathlib.Path(program).resolve()), "completion"], text=True, capture_output=True,
                              check=True).stdout
        (self.folder / "meristem.bash").write_text(text, encoding="utf-8")
        for name in ("hut.jsonc", "hut.png", "two words.jsonc", "first.film", "tree.glb"):
            (self.folder / name).write_text("")
        (self.folder / "scenes").mkdir()

    def offers(self, *words):
        child = subprocess.run(["bash", "-c", ASK, "bash", "meristem", *words], cwd=self.folder, text=True,
                               capture_output=True, check=True)
        assert child.stderr == "", child.stderr
        return child.stdout.split("\n")[:-1] if child.stdout.strip() else []


def main():
    with tempfile.TemporaryDirectory() as folder:
        shell = Shell(sys.argv[1], folder)
        assert {"render", "convert", "completion"} <= set(shell.offers(""))
        assert shell.offers("ren") == ["render"]
        assert shell.offers("render", "--exp") == ["--exposure", "--expand"], shell.offers("render", "--exp")
        for option, word, expected in [("--expand", "", {"lazy", "eager", "flat"}), ("--bits", "", {"8", "16"}),
                                       ("--ray-order", "q", {"queued"}), ("--progress", "j", {"json"}),
                                       ("--aov", "id", {"id.object", "id.material"}),
                                       ("--view", "", {"ACES SDR", "sRGB", "Raw"}), ("--view", "AC", {"ACES SDR"}),
                                       ("--display", "P3", {"P3-D65"}),
                                       ("--aov", "Z,alb", {"Z,albedo"}), ("--samples", "", set())]:
            found = shell.offers("render", "hut.jsonc", option, word)
            assert set(found) == expected, (option, found)
        assert shell.offers("render", "--ray-order", "=", "de") == ["depth-first"]
        assert set(shell.offers("render", "--expand", "=")) == {"lazy", "eager", "flat"}
        assert shell.offers("describe", "weber") == ["weber_penn"]
        # Files by what reads them, folders everywhere, names with blanks whole
        assert shell.offers("render", "") == ["hut.jsonc", "scenes", "two words.jsonc"], shell.offers("render", "")
        assert shell.offers("render", "--denoise", "hut") == ["hut.jsonc"]
        assert shell.offers("merge", "") == ["first.film", "scenes"]
        assert shell.offers("convert", "") == ["scenes", "tree.glb"]
        assert shell.offers("render", "hut.jsonc", "-o", "hut") == ["hut.jsonc", "hut.png"]
        assert shell.offers("render", "--scratch", "") == ["scenes"]
    print("bash completes commands, options, their values and files")


if __name__ == "__main__":
    main()
