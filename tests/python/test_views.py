"""Pages of poses in their scene."""
import base64
import html.parser
import json
import re

import numpy as np
import pytest

import vpm
from wall_and_cube import K, matrices_of, poses_into_the_wall


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


def test_views_show_what_was_removed(drawn, tool):
    removed = vpm.SolidRemover([vpm.SolidBody(tool, with_force=False)]).remove(
        vpm.import_depth(np.full((60, 60), 1000, np.uint16), intrinsics=K), [[0, 0, 1, 0, 0, 0, 1]])
    layer, = (layer for layer in shown_in(vpm.View(vpm.Query(tool), vpm.Scene(removed), [0, 0, 1, 0, 0, 0, 1]).html)["layers"] if layer["type"] == "image")
    assert "removed" in layer["images"][0]


def test_views_of_nothing_are_refused(drawn, tool, scene):
    query = vpm.Query(tool)
    with pytest.raises(vpm.RefusedError, match="no pose"):
        vpm.View(query, scene).html
    with pytest.raises(vpm.ArgumentError, match="names"):
        vpm.View(query, scene, names=["wall", "floor"])
    with pytest.raises(vpm.ArgumentError):
        vpm.View(query, scene, np.eye(4), solids=[np.eye(4)])
