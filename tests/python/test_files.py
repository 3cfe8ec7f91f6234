"""Files, meshes of other libraries, errors and progress."""
import types

import numpy as np
import pytest

import vpm
from wall_and_cube import CUBE, FACES


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


@pytest.mark.parametrize("second", [None, 0.3 * CUBE, 0.3 * CUBE + 2, CUBE + 0.05])
@pytest.mark.parametrize("turned", [False, True])
def test_packings_in_memory_make_the_tools_of_their_files(tmp_path, second, turned):
    """A cube alone, and with another one in it, a cavity where it is turned, beside it, and across it."""
    if second is None:
        corners, faces = CUBE, FACES
    else:
        corners, faces = np.vstack([CUBE, second]), np.vstack([FACES, (FACES[:, ::-1] if turned else FACES) + len(CUBE)])
    packing = vpm.pack(vpm.solid_of((corners, faces)), spheres=30)
    packing.write(tmp_path / "a.vpmp")
    vpm.build_tool(packing).write(tmp_path / "a.vpmg")
    vpm.build_tool(vpm.SpherePacking.read(tmp_path / "a.vpmp")).write(tmp_path / "b.vpmg")
    assert (tmp_path / "a.vpmg").read_bytes() == (tmp_path / "b.vpmg").read_bytes()


def test_meshes_of_other_libraries_are_taken(tool):
    mesh = types.SimpleNamespace(vertices=CUBE.astype(np.float32).astype(float), faces=FACES.astype(np.int32))
    assert vpm.solid_of(mesh).triangles == 12
    assert vpm.make_tool(mesh, spheres=120).spheres.shape == (120, 4)
    assert tool.spheres[0] == pytest.approx([0, 0, 0, 0.1], abs=1e-6)


def test_what_progress_raises_ends_the_work():
    class Stop(Exception):
        pass

    def stop(fraction):
        assert 0 <= fraction <= 1
        raise Stop

    with pytest.raises(Stop):
        vpm.pack(vpm.solid_of((CUBE, FACES)), spheres=500, progress=stop)
