"""What a scene is made of: depth images, streams, several cameras, points, and solids that are taken out of images."""
import logging

import numpy as np
import pytest

import vpm
from wall_and_cube import CUBE, FACES, K


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


def test_cameras_that_are_wrong_by_little_are_moved_until_they_agree():
    clouds = [vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K, camera_pose=[0, 0, z, 0, 0, 0, 1]) for z in (0, 0.006)]
    found = vpm.register_cameras([vpm.Body(cloud) for cloud in clouds])
    assert (found.observable, found.motions) == (3, 6) and found.after < 1e-5 < found.before
    assert [pose[2, 3] for pose in found.camera_poses] == pytest.approx([0.003, 0.003], abs=1e-5)
    moved = [vpm.Body(cloud.seen_from(pose)) for cloud, pose in zip(clouds, found.camera_poses)]
    assert vpm.register_cameras(moved).before < 1e-5
    with pytest.raises(vpm.RefusedError, match="one camera"):
        vpm.register_cameras(moved[:1])


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
