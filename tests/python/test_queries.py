"""Queries: answers at poses and in batches, collisions, several threads, and what is doubtful of a setup."""
import functools
import threading

import numpy as np
import pytest

import vpm
from wall_and_cube import CUBE, FACES, matrices_of, poses_into_the_wall


def test_half_of_a_cube_is_behind_a_wall(tool, scene):
    result = vpm.Query(tool, stiffness=100).run(scene, [0, 0, 1, 0, 0, 0, 1])
    assert tool.volume == pytest.approx(0.008, rel=1e-12)
    assert result.volume_fraction == pytest.approx(0.5, abs=2e-3)
    assert result.volume == pytest.approx(result.volume_fraction * tool.volume, rel=1e-12)
    # The energy of a cube half behind a plane: the area times the mean depth, 0.04 * 0.1^2 / 2, has this derivative.
    assert result.force == pytest.approx([0, 0, -100 * 0.04 * 0.1], rel=0.01, abs=1e-6)
    assert result.points is None
    assert result.volume_fraction + result.seen_free + result.unseen + result.out_of_view == pytest.approx(1, abs=1e-9)
    assert result.seen_free == pytest.approx(0.5, abs=2e-3)


def test_below_points_of_one_side_nobody_knows(tool):
    across = 0.02 * np.arange(-30, 30) + 0.01
    places = np.array([[x, y, 0] for x in across for y in across])
    table = vpm.Scene(vpm.PointCloud.from_points(places, np.tile([0, 0, 1.0], (len(places), 1))))
    query = vpm.Query(tool)
    above, below = (query.run(table, [0, 0, z, 0, 0, 0, 1]) for z in (0.15, -0.15))
    assert (above.volume, above.seen_free, above.unseen, above.out_of_view) == (0, 1, 0, 0)
    assert below.volume == 0 and below.unseen == pytest.approx(1, abs=1e-9)
    assert above.collides() is vpm.Collides.no and below.collides() is vpm.Collides.unknown


def test_a_batch_has_the_bits_of_single_poses_in_every_form(tool, scene):
    poses = poses_into_the_wall(50)
    query = vpm.Query(tool)
    singles = [query.run(scene, pose) for pose in poses]
    batch = query.run_batch(scene, poses)
    assert len(batch) == 50 and batch.force.shape == (50, 3) and batch.volume.dtype == np.float64
    for name in ("volume", "volume_fraction", "seen_free", "unseen", "out_of_view", "force", "torque", "boundary", "inside"):
        expected = np.array([getattr(single, name) for single in singles])
        assert np.array_equal(getattr(batch, name), expected)
    assert batch[-1].volume == batch.volume[49]
    matrices = matrices_of(poses)
    assert query.run_batch(scene, matrices).volume == pytest.approx(batch.volume, abs=1e-12)
    assert np.array_equal(query.run_batch(scene, matrices[:, :3]).volume, query.run_batch(scene, matrices).volume)
    assert np.array_equal(query.run_batch(scene, np.asfortranarray(poses)).volume, batch.volume)
    assert query.run(scene, list(poses[25])).volume == batch.volume[25]


def test_arrays_of_results_share_their_memory_and_outlive_the_object(tool, scene):
    batch = vpm.Query(tool).run_batch(scene, poses_into_the_wall(20))
    force = batch.force
    assert np.shares_memory(force, batch.force) and not force.flags.writeable
    expected = force.copy()
    del batch
    assert np.array_equal(force, expected)
    empty = vpm.Query(tool).run_batch(scene, np.zeros((0, 7)))
    assert len(empty) == 0 and empty.force.shape == (0, 3)


def test_jobs_name_their_tools(tool, scene):
    other = vpm.make_tool((2 * CUBE, FACES), spheres=60)
    poses = poses_into_the_wall(6)
    which = [0, 1, 1, 0, 1, 0]
    batch = vpm.Query([tool, other]).run_batch(scene, poses, which)
    for k, t in enumerate(which):
        assert batch[k].volume == vpm.Query([tool, other][t]).run(scene, poses[k]).volume
    with pytest.raises(vpm.ArgumentError):
        vpm.Query([tool, other]).run_batch(scene, poses, [0, 1, 2, 0, 0, 0])
    with pytest.raises(vpm.ArgumentError):
        vpm.Query([tool, other]).run_batch(scene, poses, [0, 1])


@pytest.mark.parametrize("pose", [[0, 0, 1], np.zeros(7), np.zeros((4, 4)), np.eye(4).T * 2, np.full(7, np.nan),
                                  [[0, 0, 1, 0, 0, 0, 1]], np.eye(5), "pose"])
def test_what_is_no_pose_is_refused(tool, scene, pose):
    with pytest.raises((vpm.Error, ValueError, TypeError)):
        vpm.Query(tool).run(scene, pose)


def test_only_what_was_seen_to_be_free_is_no_collision(tool, scene):
    query = vpm.Query(tool)
    poses = np.array([[0, 0, z, 0, 0, 0, 1] for z in (0.7, 1.0, -1.0)])  # free, in the wall, behind the camera
    expected = [vpm.Collides.no, vpm.Collides.yes, vpm.Collides.unknown]
    assert [query.collides(scene, pose) for pose in poses] == expected
    assert [query.run(scene, pose).collides() for pose in poses] == expected
    assert list(query.run_batch(scene, poses).collides()) == expected
    assert not query.collides(scene, poses[0]) and query.collides(scene, poses[2])
    assert query.collides(scene, poses[2], unseen_limit=1) is vpm.Collides.no
    assert list(query.run_batch(scene, poses).collides(1)) == [0, 1, 0]
    for limit in (1.5, -0.1, np.nan):
        for ask in (functools.partial(query.collides, scene, poses[0]), query.run(scene, poses[0]).collides,
                    query.run_batch(scene, poses).collides):
            with pytest.raises(vpm.ArgumentError):
                ask(unseen_limit=limit)
    at_level = vpm.LevelQuery(tool, scene, poses[0], max_error=0.5).another()
    assert [at_level.collides(scene, pose) for pose in poses] == expected
    solid = vpm.Scene([vpm.Body(vpm.SolidBody(tool), poses[1])])
    assert not query.collides(solid, poses[0]) and query.collides(solid, poses[0], solids=poses[:1])


def test_a_batch_tells_which_pose_is_none(tool, scene):
    poses = poses_into_the_wall(9)
    poses[[4, 7], 3:] = 0
    with pytest.raises(vpm.RefusedError, match="pose 4 of 9, from 0: the quaternion"):
        vpm.Query(tool).run_batch(scene, poses)


def test_another_query_has_the_options_of_the_first(tool, scene):
    poses = poses_into_the_wall(20)
    query = vpm.Query(tool, stiffness=300, contacts=2, level=40)
    expected = query.run_batch(scene, poses)
    others, answers = [query.another() for _ in range(3)], {}

    def ask(k):
        answers[k] = [others[k].run(scene, pose).force for pose in poses]

    threads = [threading.Thread(target=ask, args=[k]) for k in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(answers[k], expected.force) for k in range(3))
    assert others[0].level() == 40 and len(others[0].contacts()) == len(query.another().contacts()) + 1


def test_threads_share_a_query(tool, scene):
    poses = poses_into_the_wall(40)
    query = vpm.Query(tool)
    expected = query.run_batch(scene, poses).volume.copy()
    wrong = []

    def ask():
        for k in range(40):
            if query.run(scene, poses[k]).volume != expected[k]:
                wrong.append(k)

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_setups_that_are_wrong_are_said(tool, cloud, scene):
    check = vpm.SetupCheck(tool, cloud)
    poses = poses_into_the_wall(20)
    check.see(poses, vpm.Query(tool).run_batch(scene, poses))
    assert check.remarks() == []
    far = poses * [1000, 1000, 1000, 1, 1, 1, 1]
    wrong = vpm.SetupCheck(tool, cloud)
    wrong.see(far, vpm.Query(tool).run_batch(scene, far))
    assert [remark.is_warning for remark in wrong.remarks()] == [True]


def test_a_coupling_holds_the_tool(tool):
    coupling = vpm.VirtualCoupling(tool.center_of_mass, np.eye(4), stiffness=500, damping=5,
                                   mass=vpm.critical_mass(500, 5), gyration=tool.gyration)
    hand = np.eye(4)
    hand[0, 3] = 0.01
    for _ in range(2000):
        force, torque = coupling.advance(hand, [0, 0, -1.0], [0, 0, 0])
    assert coupling.tool[:3, 3] == pytest.approx([0.01, 0, -1 / 500], abs=1e-6)
    assert force == pytest.approx([0, 0, -1], abs=1e-3) and torque == pytest.approx([0, 0, 0], abs=1e-9)
    energy = coupling.energy()
    assert energy["supplied"] == pytest.approx(sum(energy[name] for name in ("stored", "dissipated", "absorbed", "lost")))
