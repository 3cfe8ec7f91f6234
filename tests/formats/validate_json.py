#!/usr/bin/python3
"""Checks JSON files against a schema of formats/schemas.

    validate_json.py SCHEMA FILE...

SCHEMA is a file, or the name of a schema in formats/schemas without ".json". A FILE that ends in
.jsonl is checked line by line; "-" is JSON Lines on standard input. Prints each fault. Exit status: 0 if all
are valid, 1 otherwise, 2 if python3-jsonschema is missing.
"""
import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is not installed", file=sys.stderr)
    sys.exit(2)

SCHEMAS = pathlib.Path(__file__).resolve().parents[2] / "formats" / "schemas"


def strict(text):
    """Refuses NaN and infinity, which Python's reader accepts and JSON does not have."""
    def refuse(constant):
        raise ValueError(f"{constant} is not JSON")
    return json.loads(text, parse_constant=refuse)


def documents(name):
    """Yields pairs of a place and the text of a document."""
    if name == "-":
        text, by_line = sys.stdin.read(), True
    else:
        text, by_line = pathlib.Path(name).read_text(), name.endswith(".jsonl")
    if not by_line:
        return [(name, text)]
    return [(f"{name}:{number}", line) for number, line in enumerate(text.splitlines(), 1)]


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    path = pathlib.Path(sys.argv[1])
    schema = strict((path if path.suffix == ".json" else SCHEMAS / f"{path}.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    faults = 0
    for name in sys.argv[2:]:
        for place, text in documents(name):
            try:
                found = [f"{'/'.join(map(str, e.absolute_path)) or 'document'}: {e.message}"
                         for e in validator.iter_errors(strict(text))]
            except ValueError as fault:
                found = [str(fault)]
            for fault in found:
                print(f"{place}: {fault}")
            faults += len(found)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
