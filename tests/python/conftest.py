"""A tool, a wall that a camera sees, and the scene of it, for all tests of the module."""
import numpy as np
import pytest

import vpm
from wall_and_cube import CUBE, FACES, K


@pytest.fixture(scope="session")
def tool():
    return vpm.make_tool((CUBE, FACES), spheres=120, levels=[40], calibrate=True)


@pytest.fixture(scope="session")
def cloud():
    return vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K)


@pytest.fixture(scope="session")
def scene(cloud):
    return vpm.Scene(cloud)
