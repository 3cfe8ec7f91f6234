"""Runs the Python of libvpm/python/README.md as it stands there, one block after another in one namespace."""
import os
import pathlib
import re

import pytest

PAGE = pathlib.Path(os.environ["VPM_SOURCE"]) / "libvpm/python/README.md"


def test_the_page_runs(tmp_path, monkeypatch):
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 12
    monkeypatch.chdir(tmp_path)  # where it saves its files
    namespace = {}
    for number, block in enumerate(blocks):
        try:
            exec(compile(block, f"{PAGE}, block {number + 1}", "exec"), namespace)
        except namespace["vpm"].UnavailableError as error:
            assert "draws no pages" in str(error) and number + 1 == len(blocks)
            pytest.skip(str(error))
