"""A tool counts for nothing before it touches, and whole in a scan of itself."""
import numpy as np
import pytest

import vpm
from wall_and_cube import CUBE, FACES

# Corners and outward triangles, m.
SOLIDS = {"plate": (CUBE * [1, 1, 0.02], FACES),
          "tetrahedron": (0.07 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]),
                          [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]),
          "wedge": (np.array([[x, y, z] for z in (-.05, .05) for x, y in ((0, 0), (.2, 0), (.2, .05))]),
                    [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]])}
DISTANCE = 1.0  # of the wall, m
STEP = 0.006  # between points, m


def walls():
    """Returns a wall, seen by a camera and as points."""
    grid = np.arange(-0.3, 0.3, STEP)
    points = np.array([[x, y, DISTANCE] for x in grid for y in grid])
    return [vpm.Scene(vpm.import_depth(np.full((240, 320), DISTANCE, np.float32), intrinsics=(250, 250, 159.5, 119.5))),
            vpm.Scene(vpm.PointCloud.from_points(points, np.tile([0, 0, -1], (len(points), 1))))]


def normals(corners, faces):
    a, b, c = (corners[[face[k] for face in faces]] for k in range(3))
    across = np.cross(b - a, c - a)
    return across / np.linalg.norm(across, axis=1, keepdims=True)


def rotation_to_wall(direction, turn):
    """Returns a rotation that takes a direction to +z, and turns by an angle about it."""
    side = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    side /= np.linalg.norm(side)
    rows = np.array([side, np.cross(direction, side), direction])
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ rows


def scan(corners, faces):
    """Returns points on all triangles, away from their edges by a little."""
    points, directions = [], []
    for face, normal in zip(faces, normals(corners, faces)):
        a, b, c = corners[face]
        count = int(max(np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(a - c)) / STEP) + 1
        for i in range(count + 1):
            for j in range(count + 1 - i):
                u, v = 1e-3 / 3 + 0.999 * np.array([i, j]) / count
                points.append(a + u * (b - a) + v * (c - a))
                directions.append(normal)
    return vpm.Scene(vpm.PointCloud.from_points(np.array(points), np.array(directions)))


@pytest.mark.parametrize("solid", SOLIDS)
def test_nothing_counts_before_contact_and_all_in_a_scan_of_itself(solid):
    corners, faces = SOLIDS[solid]
    tool = vpm.make_tool((corners, faces), spheres=100, levels=[10])
    random = np.random.default_rng(1)
    of_faces = normals(corners, faces)
    toward = np.concatenate([of_faces, random.normal(size=(12, 3))])
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    poses = np.tile(np.eye(4), (len(toward), 1, 1))
    for pose, direction in zip(poses, toward):
        pose[:3, :3] = rotation_to_wall(direction, random.uniform(0, 6))
        pose[:3, 3] = [0, 0, DISTANCE - (corners @ direction).max() - 1e-3 * tool.radius]
    itself = scan(corners, faces)
    for level in (10, 100):
        query = vpm.Query(tool, level=level)
        for wall in walls():
            assert query.run_batch(wall, poses).volume.max() <= 1e-6 * tool.volume
            deeper = poses + 0.02 * tool.radius * np.eye(4)[2][:, None] * np.eye(4)[3]
            assert (query.run_batch(wall, deeper).volume[:len(of_faces)] > 1e-4 * tool.volume).all()
        assert abs(query.run(itself, np.eye(4)).volume_fraction - 1) < 1.5e-3
