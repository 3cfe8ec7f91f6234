"""Installs the module as the page says, without a network, and asks it from an empty folder."""
import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["VPM_SOURCE"])


def test_pip_installs_it_without_a_network(tmp_path):
    venv = subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", tmp_path / "env"], capture_output=True,
                          text=True)
    if venv.returncode != 0:
        pytest.skip("python3-venv is not installed")
    python = tmp_path / "env/bin/python"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run([python, "-m", "pip", "install", "-q", "--no-index", SOURCE / "libvpm/python"], check=True,
                   env=environment)
    said = subprocess.run([python, "-c", "import vpm; print(vpm.__version__, vpm.__file__)"], check=True, text=True,
                          capture_output=True, env=environment, cwd=tmp_path).stdout
    version, place = said.split()
    assert f'VPM_VERSION "{version}"' in (SOURCE / "libvpm/include/vpm/version.h").read_text()
    assert pathlib.Path(place).is_relative_to(tmp_path)
