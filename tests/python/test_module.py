"""The Python module: what it gives is what the library gives, and what it promises of arrays, errors and threads."""
import ast
import base64
import html
import html.parser
import importlib.util
import inspect
import json
import logging
import os
import pathlib
import re
import subprocess
import sys
import threading
import types

import numpy as np
import pytest

import vpm

CUBE = np.array([[x, y, z] for z in (-0.1, 0.1) for y in (-0.1, 0.1) for x in (-0.1, 0.1)])
FACES = np.array([[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
                  [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]])
K = (60, 60, 29.5, 29.5)


@pytest.fixture(scope="module")
def tool():
    return vpm.make_tool((CUBE, FACES), spheres=120, levels=[40], calibrate=True)


@pytest.fixture(scope="module")
def cloud():
    return vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K)


@pytest.fixture(scope="module")
def scene(cloud):
    return vpm.Scene(cloud)


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


def test_errors_tell_what_where_and_how(tmp_path):
    path = tmp_path / "none.vpmg"
    path.write_bytes(b"something else")
    with pytest.raises(vpm.RefusedError) as caught:
        vpm.Tool.read(path)
    assert str(path) in caught.value.where and caught.value.problem and str(caught.value).startswith(caught.value.where)
    assert isinstance(caught.value, vpm.Error) and isinstance(caught.value, ValueError)
    with pytest.raises(vpm.RefusedError):
        vpm.solid_of((CUBE, FACES[:-1]))
    with pytest.raises(vpm.ArgumentError, match="refined.*paper"):
        vpm.Query(vpm.make_tool((CUBE, FACES), spheres=5), measure="exact")
    with pytest.raises(TypeError):
        vpm.import_cloud("x.png", depthscale=1000)
    with pytest.raises(vpm.ArgumentError):
        vpm.SolidMesh.from_triangles(CUBE, FACES - 1)
    with pytest.raises(vpm.ArgumentError):
        vpm.SolidMesh.from_triangles(CUBE, FACES.astype(float))


def test_files_come_back_with_their_bytes(tmp_path, tool, cloud):
    for name, made, kind in (("a.vpmg", tool, vpm.Tool), ("a.vpmc", cloud, vpm.PointCloud)):
        made.write(tmp_path / name)
        kind.read(tmp_path / name).write(str(tmp_path / ("b" + name)))
        assert (tmp_path / name).read_bytes() == (tmp_path / ("b" + name)).read_bytes()


def test_meshes_of_other_libraries_are_taken(tool):
    mesh = types.SimpleNamespace(vertices=CUBE.astype(np.float32).astype(float), faces=FACES.astype(np.int32))
    assert vpm.solid_of(mesh).triangles == 12
    assert vpm.make_tool(mesh, spheres=120).spheres.shape == (120, 4)
    assert tool.spheres[0] == pytest.approx([0, 0, 0, 0.1], abs=1e-6)


def test_depth_images_of_counts_and_metres_are_the_same(tool):
    counts = np.full((60, 60), 1000, np.uint16)
    counts[20:30, 10:50] = 1100
    by_counts = vpm.import_depth(counts, intrinsics=K)
    by_metres = vpm.import_depth(counts.astype(np.float32) / np.float32(1000), intrinsics=np.array(
        [[60, 0, 29.5], [0, 60, 29.5], [0, 0, 1.0]]))
    pose = [0, 0, 1.05, 0, 0, 0, 1]
    query = vpm.Query(tool)
    assert query.run(vpm.Scene(by_counts), pose).volume == query.run(vpm.Scene(by_metres), pose).volume


def test_improbable_data_warn_where_they_are_given():
    with pytest.warns(vpm.SetupWarning, match="depth_scale") as caught:
        vpm.import_depth(np.full((60, 60), 1000, np.float32), intrinsics=K)
    assert caught[0].filename == __file__


def test_good_data_warn_of_nothing(recwarn, caplog):
    with caplog.at_level(logging.INFO, logger="vpm"):
        vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K)
    assert not recwarn.list and not caplog.records


def test_a_stream_gives_what_an_image_gives(tool, cloud):
    stream = vpm.DepthStream(K, 60, 60, counts_per_metre=1000)
    stream.image()[:] = 1000
    body = stream.prepare(np.eye(4))
    pose = [0, 0, 1.02, 0, 0, 0, 1]
    query = vpm.Query(tool)
    assert query.run(vpm.Scene(body), pose).volume == query.run(vpm.Scene(cloud), pose).volume
    assert query.run(vpm.Scene([body, vpm.Body(cloud)]), pose).volume == pytest.approx(
        2 * query.run(vpm.Scene(body), pose).volume, rel=1e-12)


def test_cameras_are_one_body(tool):
    left, right = (vpm.Body(vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K, camera_pose=[x, 0, 0, 0, 0, 0, 1]))
                   for x in (-0.05, 0.05))
    pose, query = [0, 0, 1.02, 0, 0, 0, 1], vpm.Query(tool)
    both = query.run(vpm.Scene(vpm.Body.of_cameras([left, right])), pose)
    assert both.volume == query.run(vpm.Scene(vpm.Body.of_cameras([right, left, right])), pose).volume
    assert both.volume == pytest.approx(query.run(vpm.Scene(left), pose).volume, rel=0.01)
    assert query.run(vpm.Scene([left, right]), pose).volume == pytest.approx(2 * both.volume, rel=0.01)
    assert query.run(vpm.Scene(vpm.Body.of_cameras([left])), pose).volume == query.run(vpm.Scene(left), pose).volume
    with pytest.raises(vpm.ArgumentError, match="depth images"):
        vpm.Body.of_cameras([left, vpm.Body(vpm.SolidBody(tool))])


def test_a_camera_that_contradicts_another_is_named():
    def camera(pose):
        return vpm.Body(vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K, camera_pose=pose))

    left, right = camera([-0.05, 0, 0, 0, 0, 0, 1]), camera([0.05, 0, 0, 0, 0, 0, 1])
    assert vpm.doubted_camera([left, right]) is None
    place, remark = vpm.doubted_camera([left, camera([0.05, 0, 0.2, 0, 0, 0, 1]), right])
    assert place == 1 and remark.is_warning and remark.text
    with pytest.raises(vpm.ArgumentError, match="depth images"):
        vpm.doubted_camera([left, vpm.Body(vpm.SolidBody(vpm.solid_of((CUBE, FACES))))])


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
    with pytest.raises(vpm.ArgumentError):
        query.collides(scene, poses[0], unseen_limit=1.5)
    at_level = vpm.LevelQuery(tool, scene, poses[0], max_error=0.5).another()
    assert [at_level.collides(scene, pose) for pose in poses] == expected
    solid = vpm.Scene([vpm.Body(vpm.SolidBody(tool), poses[1])])
    assert not query.collides(solid, poses[0]) and query.collides(solid, poses[0], solids=poses[:1])


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


@pytest.fixture
def held_cube():
    """Depth image of the cube, with its centre at 0.6 m, before a wall at about 1 m; and the cube's pose."""
    image = np.tile(np.linspace(1, 1.1, 60, dtype=np.float32), (60, 1))
    image[18:42, 18:42] = 0.5  # the pixels whose rays meet the face at 0.5 m
    return image, np.array([[0, 0, 0.6, 0, 0, 0, 1.0]])


def test_a_solid_that_is_removed_is_unseen_and_no_contact(tool, held_cube):
    image, at = held_cube
    cloud, query = vpm.import_depth(image, intrinsics=K), vpm.Query(tool)
    assert query.run(vpm.Scene(cloud), at[0]).volume_fraction > 0.5
    remover = vpm.SolidRemover([vpm.SolidBody(tool, with_force=False)])
    rest = remover.remove(cloud, at)
    found, = remover.found
    assert (found.explained, found.hidden, found.holds_camera) == (576, 0, False)
    assert 576 <= found.in_view <= 26 * 26  # with the pixels whose squares it meets
    assert len(rest) < len(cloud)
    result = query.run(vpm.Scene(rest), at[0])
    assert result.volume == 0 and result.unseen > 0.9 and result.collides() is vpm.Collides.unknown
    # What is before the solid stays, unless the margin reaches there.
    behind = at + [0, 0, 0.05, 0, 0, 0, 0]
    assert query.run(vpm.Scene(remover.remove(cloud, behind)), at[0]).volume > 0 and remover.found[0].hidden > 400
    assert query.run(vpm.Scene(remover.remove(cloud, behind, margin=[0.06])), at[0]).volume == 0


def test_a_solid_is_removed_from_the_image_of_a_stream(tool, held_cube):
    image, at = held_cube
    remover = vpm.SolidRemover([vpm.SolidBody(tool)])
    stream = vpm.DepthStream(K, 60, 60)
    metres = stream.image()
    metres[:] = image
    removed = remover.remove_from_image(metres, K, at)
    gone = (metres == 0) & np.signbit(metres)
    assert removed == gone.sum() >= 576 and gone[18:42, 18:42].all() and np.array_equal(metres[~gone], image[~gone])
    result = vpm.Query(tool).run(vpm.Scene(stream.prepare(np.eye(4))), at[0])
    assert result.volume == 0 and result.unseen > 0.9
    for wrong in (image.astype(float), image.T[:, ::2], image.ravel()):
        with pytest.raises(vpm.ArgumentError, match="float32"):
            remover.remove_from_image(wrong, K, at)
    for poses, margin in ((np.repeat(at, 2, axis=0), 0), (at, [0, 0]), (at, -1), (at[:0], 0)):
        with pytest.raises(vpm.ArgumentError):
            remover.remove_from_image(image, K, poses, margin=margin)


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


def test_what_progress_raises_ends_the_work():
    class Stop(Exception):
        pass

    def stop(fraction):
        assert 0 <= fraction <= 1
        raise Stop

    with pytest.raises(Stop):
        vpm.pack(vpm.solid_of((CUBE, FACES)), spheres=500, progress=stop)


def test_setups_that_are_wrong_are_said(tool, cloud, scene):
    check = vpm.SetupCheck(tool, cloud)
    poses = poses_into_the_wall(20)
    check.see(poses, vpm.Query(tool).run_batch(scene, poses))
    assert check.remarks() == []
    far = poses * [1000, 1000, 1000, 1, 1, 1, 1]
    wrong = vpm.SetupCheck(tool, cloud)
    wrong.see(far, vpm.Query(tool).run_batch(scene, far))
    assert [remark.is_warning for remark in wrong.remarks()] == [True]


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


def shown_in(page):
    """Returns the data of a page: its one script of JSON."""
    data, = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    return json.loads(data)


def column_of(data, name):
    packed, = (column["values"] for column in data["columns"] if column["name"] == name)
    return np.frombuffer(base64.b64decode(packed["data"]), {"f32": np.float32}[packed["type"]])


@pytest.fixture(scope="module")
def drawn(tool, scene):
    """Skips tests of pages where this build draws none."""
    try:
        vpm.View(vpm.Query(tool), scene)
    except vpm.UnavailableError as error:
        pytest.skip(str(error))


def test_a_view_shows_tool_scene_and_answers(drawn, tmp_path, tool, cloud):
    scene = vpm.Scene([vpm.Body(cloud), vpm.Body(vpm.SolidBody(tool), [0.15, 0, 0.95, 0, 0, 0, 1])])
    query, poses = vpm.Query(tool, stiffness=300, contacts=2), poses_into_the_wall(12)
    before = query.run(scene, poses[3])
    states = query.states()
    view = vpm.View(query, scene, poses, tool="<script>cube", names=["wall", "box"])
    data = shown_in(view.html)
    assert data["program"] == "vpm" and data["title"] == "<script>cube in wall, box" and data["steps"]["count"] == 12
    assert {"image", "spheres", "mesh", "arrow", "path", "lines"} == {layer["type"] for layer in data["layers"]}
    assert "solid box" in [layer["name"] for layer in data["layers"]]
    expected = query.another().run_batch(scene, poses)
    assert np.array_equal(column_of(data, "volume"), expected.volume.astype(np.float32))
    assert np.array_equal(column_of(data, "force"), expected.force.astype(np.float32).ravel())
    assert np.array_equal(query.states(), states) and before.volume == query.run(scene, poses[3]).volume
    view.add(poses[0])
    view.add(matrices_of(poses)[1])
    view.add(poses[2:3], solids=poses[2:3, None])
    assert shown_in(view.html)["steps"]["count"] == 15
    view.save(tmp_path / "view.html")
    assert (tmp_path / "view.html").read_text() == view.html


def test_a_view_is_an_element_of_a_notebook_that_asks_for_nothing(drawn, tool, scene):
    class Frames(html.parser.HTMLParser):
        found = []

        def handle_starttag(self, tag, attributes):
            self.found.append((tag, dict(attributes)))

    view = vpm.View(vpm.LevelQuery(tool, scene, [0, 0, 1, 0, 0, 0, 1], max_error=0.5), scene, np.eye(4), height=321)
    parser = Frames()
    parser.feed(view._repr_html_())
    (tag, attributes), = parser.found
    assert tag == "iframe" and attributes["srcdoc"] == view.html and "321px" in attributes["style"]
    assert attributes["sandbox"] == "allow-scripts"  # and nothing of the notebook's
    policy, = re.findall(r'Content-Security-Policy" content="(.*?)"', view.html)
    assert "default-src 'none'" in policy and not re.search(r"https?:", policy)


def test_views_of_several_cameras_and_of_points(drawn, tool, cloud):
    left, right = (vpm.Body(vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K, camera_pose=[x, 0, 0, 0, 0, 0, 1]))
                   for x in (-0.05, 0.05))
    places = np.stack([*np.meshgrid(np.linspace(-1, 1, 20), np.linspace(-1, 1, 20)), np.ones((20, 20))], axis=-1).reshape(-1, 3)
    points = vpm.PointCloud.from_points(places, np.tile([0, 0, -1.0], (400, 1)))
    scene = vpm.Scene([vpm.Body.of_cameras([left, right]), vpm.Body(points)])
    data = shown_in(vpm.View(vpm.Query(tool), scene, [0, 0, 1, 0, 0, 0, 1]).html)
    assert [layer["type"] for layer in data["layers"]].count("image") == 2
    assert data["title"] == "tool in camera 0 of body 0, camera 1 of body 0, body 1"


def test_views_of_nothing_are_refused(drawn, tool, scene):
    query = vpm.Query(tool)
    with pytest.raises(vpm.RefusedError, match="no pose"):
        vpm.View(query, scene).html
    with pytest.raises(vpm.ArgumentError, match="names"):
        vpm.View(query, scene, names=["wall", "floor"])
    with pytest.raises(vpm.ArgumentError):
        vpm.View(query, scene, np.eye(4), solids=[np.eye(4)])


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


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_mypy_finds_no_fault_in_the_stubs():
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "vpm", "--ignore-missing-stub"], capture_output=True,
                          text=True, env=dict(os.environ))
    assert done.returncode == 0, done.stdout


def test_everything_has_its_help():
    for name in vpm.__all__:
        documented = getattr(vpm, name)
        assert inspect.getdoc(documented), name
        if inspect.isclass(documented) and not issubclass(documented, Exception):
            assert documented.__module__ == "vpm"
            for member, value in vars(documented).items():
                if not member.startswith("_"):
                    assert inspect.getdoc(value), f"{name}.{member}"


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


def test_normals_of_points_are_turned_by_their_neighbours(tmp_path):
    places = [(x / 20, y / 20, 1.0) for x in range(20) for y in range(20)]
    lines = [f"{x} {y} {z} 0 0 {1 if k % 3 == 0 else -1}" for k, (x, y, z) in enumerate(places)]
    header = ["ply", "format ascii 1.0", f"element vertex {len(lines)}"]
    header += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    path = tmp_path / "wall.ply"
    path.write_text("\n".join([*header, "end_header", *lines]) + "\n")
    with pytest.raises(vpm.RefusedError, match="orient"):
        vpm.import_cloud(path)
    assert len(vpm.import_cloud(path, orient="0.5,0.5,0")) == 400
    with pytest.raises(vpm.ArgumentError, match="neighbours"):
        vpm.import_cloud(path, orient="0.5,0.5")
