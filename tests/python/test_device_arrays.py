"""Arrays of other programs on a device, by DLPack."""
import sys

import numpy as np
import pytest

import vpm
from wall_and_cube import poses_into_the_wall


class OnDevice:
    """Says that it lies on a CUDA device, as arrays of other programs do that lie there."""

    def __init__(self, array):
        self.array = array

    def __dlpack_device__(self):
        return 2, 0

    def __dlpack__(self, *, stream):
        assert stream == 1  # the default one, as DLPack numbers it
        return self.array.__dlpack__()


@pytest.mark.parametrize("array, reason", [
    (np.zeros((3, 7)), "query on one CUDA device"),
    (np.zeros((3, 4, 4)), "query on one CUDA device"),
    (np.zeros((3, 6)), "float64 without gaps"),
    (np.zeros((3, 7), np.float32), "float64 without gaps"),
    (np.zeros((7, 3)).T, "float64 without gaps"),
    (np.zeros((3, 4, 8))[:, :, ::2], "float64 without gaps"),
])
def test_poses_on_a_device_are_taken_or_named(tool, scene, array, reason):
    held = sys.getrefcount(array)
    with pytest.raises(vpm.ArgumentError, match=reason):
        vpm.Query(tool).run_batch(scene, OnDevice(array))
    assert sys.getrefcount(array) == held


def test_poses_and_answers_stay_on_a_gpu(tool, scene):
    torch = pytest.importorskip("torch")
    if vpm.cuda_device_count() == 0 or not torch.cuda.is_available():
        pytest.skip("no CUDA device here")
    poses = poses_into_the_wall(300)
    expected = vpm.Query(tool).run_batch(scene, poses)
    query = vpm.Query(tool, device="cuda")
    with torch.cuda.stream(torch.cuda.Stream()) as _:      # another stream than the default one
        results = query.run_batch(scene, torch.tensor(poses, device="cuda"))
        volume = torch.from_dlpack(results.volume)
        total = volume.sum().item()
        for name in ("volume", "volume_fraction", "seen_free", "unseen", "out_of_view", "force", "torque", "boundary", "inside"):
            found = torch.from_dlpack(getattr(results, name))
            assert found.is_cuda and np.array_equal(found.cpu().numpy(), getattr(expected, name))
        del results
    assert volume.sum().item() == total                    # arrays hold the memory that they lie in
    mirrored = torch.diag(torch.tensor([-1.0, 1, 1, 1], dtype=torch.float64)).repeat(2, 1, 1).cuda()
    assert torch.isnan(torch.from_dlpack(query.run_batch(scene, mirrored).volume)).all()
