#!/usr/bin/python3
"""Checks JSON files against a schema of formats/schemas.

    validate_json.py SCHEMA FILE...
    validate_json.py --serve SOCKET     answers ask_to_validate.py, until it is killed

SCHEMA is a file, or the name of a schema in formats/schemas without ".json". A FILE that ends in
.jsonl is checked line by line; "-" is JSON Lines on standard input. Prints each fault. Exit status: 0 if all
are valid, 1 otherwise, 2 if python3-jsonschema is missing.
"""
import json
import os
import pathlib
import socket
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


def check(schema_name, names):
    """Prints the faults of the files; returns the exit status."""
    path = pathlib.Path(schema_name)
    schema = strict((path if path.suffix == ".json" else SCHEMAS / f"{path}.json").read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    faults = 0
    for name in names:
        for place, text in documents(name):
            try:
                found = [f"{'/'.join(map(str, e.absolute_path)) or 'document'}: {e.message}"
                         for e in validator.iter_errors(strict(text))]
            except ValueError as fault:
                found = [str(fault)]
            for fault in found:
                print(f"{place}: {fault}")
            faults += len(found)
    return 1 if faults else 0


def serve(address):
    """Runs each check in a fork, with the streams and in the folder of who asks."""
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(address)
    listener.listen()
    print("ready", flush=True)
    while True:
        client, _ = listener.accept()
        message, handles, _, _ = socket.recv_fds(client, 1 << 16, 4)
        child = os.fork()
        if child == 0:
            for stream, handle in enumerate(handles[:3]):
                os.dup2(handle, stream)
            os.fchdir(handles[3])
            schema, *names = message.decode().split("\0")
            sys.exit(check(schema, names))
        client.send(bytes([os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) & 255]))
        for handle in handles:
            os.close(handle)
        client.close()


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    if sys.argv[1] == "--serve":
        serve(sys.argv[2])
    sys.exit(check(sys.argv[1], sys.argv[2:]))


if __name__ == "__main__":
    main()
