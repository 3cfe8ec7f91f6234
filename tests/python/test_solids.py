"""Solids: what two share, in scenes and by themselves, and their contacts."""
import numpy as np
import pytest

import vpm
from wall_and_cube import CUBE, FACES, matrices_of, poses_into_the_wall


def test_solids_share_what_geometry_says():
    body = vpm.SolidBody(vpm.solid_of((CUBE, FACES)))
    query = vpm.OverlapQuery(body, body)
    for shift, shared in ((0.25, 0), (0.2, 0), (0.15, 0.05 * 0.04), (0, 0.008)):
        overlap = query.run(np.eye(4), [shift, 0, 0, 0, 0, 0, 1])
        assert overlap.volume == pytest.approx(shared, abs=1e-11) and overlap.closure <= 1e-8
    pose = [0.15, 0.03, -0.02, 0, 0, 0, 1]
    overlap = query.run(np.eye(4), pose)
    assert overlap.volume == pytest.approx(0.05 * 0.17 * 0.18, abs=1e-11)
    assert overlap.centroid == pytest.approx([0.075, 0.015, -0.01], abs=1e-9)
    assert overlap.area == pytest.approx([0.17 * 0.18, 0.05 * 0.18, -0.05 * 0.17], abs=1e-9) and overlap.force[0] < 0
    other = query.run(pose, np.eye(4))
    assert other.volume == overlap.volume and np.array_equal(other.force, -overlap.force)
    with pytest.raises(vpm.ArgumentError):
        vpm.OverlapQuery(vpm.SolidBody(vpm.solid_of((CUBE, FACES)), with_force=False), body)


def test_solids_of_a_scene_move_and_add_up(tool, cloud):
    solid = vpm.SolidBody(tool)
    assert solid.volume == pytest.approx(0.008, rel=1e-9)
    wall, near, far = vpm.Body(cloud), vpm.Body(solid, [0.15, 0, 0.95, 0, 0, 0, 1]), vpm.Body(solid)
    assert near.is_solid and not wall.is_solid and near.points == 0
    scene, pose, query = vpm.Scene([wall, near, far]), [0, 0, 0.95, 0, 0, 0, 1], vpm.Query(tool)
    whole = query.run(scene, pose)
    alone, shared, none = query.parts()
    assert shared.volume == pytest.approx(0.05 * 0.04, abs=1e-11) and none.volume == 0
    assert whole.volume == pytest.approx(alone.volume + shared.volume, rel=1e-12) and 0 <= whole.closure <= 1e-8
    assert np.allclose(whole.force, np.add(alone.force, shared.force), atol=1e-15)
    assert vpm.Query(tool).run(vpm.Scene([far, near, wall]), pose).volume == whole.volume
    moved = [[0.18, 0, 0.95, 0, 0, 0, 1], [0, -0.19, 0.95, 0, 0, 0, 1]]
    assert query.run(scene, pose, moved).volume - alone.volume == pytest.approx(0.04 * (0.02 + 0.01), abs=1e-10)
    assert query.run(scene, pose, matrices_of(np.array(moved))).volume == query.run(scene, pose, moved).volume


def test_contacts_add_up_and_say_where(tool, cloud):
    scene = vpm.Scene([vpm.Body(cloud), vpm.Body(vpm.SolidBody(tool), [0.15, 0.02, 0.96, 0, 0, 0, 1])])
    pose, query = [0, 0, 0.95, 0, 0, 0, 1], vpm.Query(tool, contacts=4, stiffness=2e4)
    assert query.contacts() == []
    whole = query.run(scene, pose)
    wall, side = query.contacts()
    assert (wall.body, side.body) == (0, 1) and wall.patches == side.patches == 1
    assert wall.volume + side.volume == whole.volume and np.array_equal(wall.force + side.force, whole.force)
    assert np.array_equal(wall.torque + side.torque, whole.torque)
    assert side.centroid == pytest.approx([0.075, 0.01, 0.955], abs=1e-8) and 0 < side.depth < 0.051
    assert side.area * side.normal == pytest.approx([0.18 * 0.19, 0.05 * 0.19, 0.05 * 0.18], abs=1e-9)
    assert wall.normal == pytest.approx([0, 0, 1], abs=1e-3) and wall.depth == pytest.approx(0.05, abs=0.005)
    few = vpm.Query(tool, contacts=1)
    both = vpm.Scene(scene.bodies[1:] + [vpm.Body(vpm.SolidBody(tool), [-0.16, 0, 0.95, 0, 0, 0, 1])] + scene.bodies[:1])
    few.run(both, pose)
    assert [contact.patches for contact in few.contacts()] == [1, 2] and few.contacts()[1].body is None
    body = vpm.SolidBody(tool)
    overlap = vpm.overlap(body, pose, body, [0.15, 0, 0.95, 0, 0, 0, 1], contacts=3)
    assert [contact.volume for contact in overlap.contacts] == [overlap.volume]
    level = vpm.LevelQuery(tool, scene, pose, contacts=4, stiffness=2e4)
    assert level.run(scene, pose).volume == sum(contact.volume for contact in level.contacts())


def test_each_job_has_poses_of_its_solids(tool, cloud):
    scene, query = vpm.Scene([vpm.Body(vpm.SolidBody(tool)), vpm.Body(cloud)]), vpm.Query(tool)
    poses = poses_into_the_wall(5)
    solids = np.repeat(poses[:, None], 1, axis=1) + [0.05, 0, 0, 0, 0, 0, 0]
    batch = query.run_batch(scene, poses, solids=solids)
    ones = [query.run(scene, pose, moved) for pose, moved in zip(poses, solids)]
    assert list(batch.volume) == [one.volume for one in ones] and list(batch.closure) == [one.closure for one in ones]
    assert np.isnan(vpm.Query(tool).run_batch(vpm.Scene(cloud), poses).closure).all()
    matrices = matrices_of(solids[:, 0])[:, None]  # which differ from the quaternions by rounding
    assert query.run_batch(scene, poses, solids=matrices).volume == pytest.approx(batch.volume, rel=1e-9)
    for wrong in (solids[0], solids[:4], np.concatenate([solids, solids], axis=1), solids[:, :0]):
        with pytest.raises(vpm.Error):
            query.run_batch(scene, poses, solids=wrong)
    for none in ([], np.empty((0, 7))):
        with pytest.raises(vpm.ArgumentError):
            query.run(scene, poses[0], none)
    with pytest.raises(vpm.ArgumentError):
        vpm.Body(vpm.SolidBody(tool, with_force=False))
    levels = vpm.LevelQuery(tool, scene, poses[0], max_error=0.5)
    answer = levels.run(scene, poses[0], solids[0])
    assert answer.closure is not None and sum(part.volume for part in levels.parts()) == answer.volume
