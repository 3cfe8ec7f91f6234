"""Runs the Python of libvpm/python/README.md as it stands there, one block after another in one namespace."""
import os
import pathlib
import re

PAGE = pathlib.Path(os.environ["VPM_SOURCE"]) / "libvpm/python/README.md"


def test_the_page_runs():
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    assert len(blocks) == 8
    namespace = {}
    for number, block in enumerate(blocks):
        exec(compile(block, f"{PAGE}, block {number + 1}", "exec"), namespace)
