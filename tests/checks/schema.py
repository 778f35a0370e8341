"""Validates every scene file against the JSON Schema that `meristem schema` prints, as an editor would.

    schema.py MERISTEM SCENES    the program and the folder of scenes

Also expects the schema to refuse a scene with a member that does not exist: one that accepts everything helps nobody.
"""
import json
import pathlib
import re
import subprocess
import sys

import jsonschema

# A string, which is kept, or what JSON lacks: a comment, or a comma before a closing bracket.
STRING = r'"(?:\\.|[^"\\])*"'
COMMENT = r"//[^\n]*|/\*.*?\*/"
TRAILING_COMMA = rf",(?=(?:\s|{COMMENT})*[\]}}])"
EXTRAS = re.compile(rf"({STRING})|{COMMENT}|{TRAILING_COMMA}", re.DOTALL)


def parse_jsonc(text):
    return json.loads(EXTRAS.sub(lambda match: match.group(1) or " ", text))


def place(error):
    return "/".join(str(step) for step in error.absolute_path) or "the scene"


def errors_in(validator, path):
    scene = parse_jsonc(path.read_text(encoding="utf-8"))
    for error in sorted(validator.iter_errors(scene), key=lambda e: list(map(str, e.absolute_path))):
        deepest = jsonschema.exceptions.best_match([error])
        yield f"{path}: {place(deepest)}: {deepest.message[:300]}"
    scene["no_such_member"] = 1
    if validator.is_valid(scene):
        yield f"{path}: the schema accepts a member that does not exist"


def main(program, folder):
    schema = json.loads(subprocess.run([program, "schema"], check=True, stdout=subprocess.PIPE).stdout)
    kind = jsonschema.validators.validator_for(schema)
    kind.check_schema(schema)
    scenes = sorted(pathlib.Path(folder).glob("*/*.jsonc"))
    errors = [error for path in scenes for error in errors_in(kind(schema), path)]
    if not scenes:
        errors.append(f"no scenes in {folder}")
    print("\n".join(errors) or f"{len(scenes)} scenes are valid")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
