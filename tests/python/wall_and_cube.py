"""A cube of 0.2 m, the camera of a wall at 1 m, and poses that lead into it."""
import numpy as np

CUBE = np.array([[x, y, z] for z in (-0.1, 0.1) for y in (-0.1, 0.1) for x in (-0.1, 0.1)])
FACES = np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
                  [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]])
K = (60, 60, 29.5, 29.5)


def poses_into_the_wall(count):
    poses = np.tile([0.01, -0.02, 0.0, 0.1, 0.2, 0.3, 0.927361849549570], (count, 1))
    poses[:, 2] = np.linspace(0.8, 1.2, count)
    return poses


def matrices_of(poses):
    made = np.zeros((len(poses), 4, 4))
    x, y, z, w = poses[:, 3:].T
    made[:, :3, :3] = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)
    made[:, :3, 3] = poses[:, :3]
    made[:, 3, 3] = 1
    return made
