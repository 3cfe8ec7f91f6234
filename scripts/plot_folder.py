"""Calls a script that draws the results in a folder, and says in a sentence what is wrong with them."""
import pathlib
import sys


def draw_folder(draw, files, made_by):
    """Calls draw(folder) for the folder on the command line, which must hold `files`, as `made_by` writes them. Ends the
    program with exit code 2 for a wrong command line, and with 1 for results that cannot be drawn."""
    script = pathlib.Path(sys.argv[0]).name
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(f"usage: {script} FOLDER, the folder where {made_by} has written", file=sys.stderr)
        raise SystemExit(2)
    folder = pathlib.Path(sys.argv[1])
    missing = [name for name in files if not (folder / name).is_file()]
    if missing:
        raise SystemExit(f"{script}: {folder} has no {' and no '.join(missing)}; make them by {made_by}")
    try:
        draw(folder)
    except (KeyError, IndexError, TypeError, ValueError, StopIteration) as fault:
        raise SystemExit(f"{script}: the results in {folder} cannot be drawn, since they lack or garble something "
                         f"({type(fault).__name__}: {fault}); make them again by {made_by}") from None
    except OSError as fault:
        raise SystemExit(f"{script}: {fault}") from None
