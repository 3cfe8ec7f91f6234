"""Type stubs and help agree with the module."""
import ast
import importlib.util
import inspect
import os
import pathlib
import subprocess
import sys

import pytest

import vpm


def names_of_stub():
    """Returns the public names of the type stubs: functions, classes, and {class: members}."""
    tree = ast.parse((pathlib.Path(vpm.__file__).parent / "__init__.pyi").read_text())
    names = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = None
    return {name: members for name, members in names.items() if not name.startswith("_")}


def test_stubs_name_what_the_module_has():
    stub = names_of_stub()
    assert set(stub) == set(vpm.__all__)
    for name, members in stub.items():
        if not members:
            continue
        has = {member for member in vars(getattr(vpm, name)) if not member.startswith("_")}
        assert has == {member for member in members if not member.startswith("_")}, name


def test_stubs_have_the_parameters_of_the_functions():
    tree = ast.parse((pathlib.Path(vpm.__file__).parent / "__init__.pyi").read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and inspect.isfunction(getattr(vpm, node.name)):
            told = [argument.arg for argument in node.args.args + node.args.kwonlyargs]
            has = [name for name, parameter in inspect.signature(getattr(vpm, node.name)).parameters.items()
                   if parameter.kind != inspect.Parameter.VAR_KEYWORD]
            assert told == has, node.name


# What stubtest finds of every class of pybind11, and is no fault of stubs: their metaclass, the constructors of classes that have
# none, and a name that only the errors' own module has.
OF_PYBIND11 = r"""vpm\.[A-Z]\w+
vpm\.[A-Z]\w+\.__init__
vpm\._errors\._class
"""


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_mypy_finds_no_fault_in_the_stubs(tmp_path):
    (tmp_path / "allowed").write_text(OF_PYBIND11)
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "vpm", "--ignore-missing-stub", "--allowlist", tmp_path / "allowed"],
                          capture_output=True, text=True, cwd=tmp_path, env=dict(os.environ))
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_has_its_help():
    for name in vpm.__all__:
        documented = getattr(vpm, name)
        assert inspect.getdoc(documented), name
        if inspect.isclass(documented) and not issubclass(documented, Exception):
            assert documented.__module__ == "vpm"
            for member, value in vars(documented).items():
                if not member.startswith("_"):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_pydoc_fits_a_terminal():
    """pydoc breaks no lines, and indents those of members by 12 characters, those of functions by 8."""
    told = [(vpm.__doc__, 100)]
    for name in vpm.__all__:
        documented = getattr(vpm, name)
        told.append((inspect.getdoc(documented), 92))
        if inspect.isclass(documented) and not issubclass(documented, int):
            told += [(inspect.getdoc(value), 88) for value in vars(documented).values() if inspect.getdoc(value)]
    assert len(told) > 200
    assert [line for doc, longest in told for line in doc.splitlines() if len(line) > longest] == []
