# The job of somebody with arrays of NumPy, from an empty folder, by help(vpm) and its page: where above a table may a part be, how deep is
# it elsewhere, and what pushes it out; the answers stay arrays, and those that hit are looked at.

$ export PYTHONPATH=$(dirname $(dirname $(command -v vpm-query)))/python; printf '%s\n' 'import numpy as np' 'import vpm' 'depth = np.full((48, 64), 1000, np.uint16)' 'corners = np.array([[x, y, z] for z in (-.05, .05) for y in (-.05, .05) for x in (-.05, .05)])' 'faces = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]' 'tool = vpm.make_tool((corners, faces), spheres=1000)' 'scene = vpm.Scene(vpm.import_depth(depth, intrinsics=(60, 60, 31.5, 23.5)))' 'x, y, z = (axis.ravel() for axis in np.meshgrid(np.linspace(-.2, .2, 10), np.linspace(-.1, .1, 10), np.linspace(.9, .99, 10)))' 'poses = np.stack([x, y, z, 0 * x, 0 * x, 0 * x, 0 * x + 1], axis=1)' 'query = vpm.Query(tool, stiffness=1e5)' 'answers = query.run_batch(scene, poses)' 'free = answers.collides() == vpm.Collides.no' 'np.savez("answers.npz", poses=poses, volume=answers.volume, force=answers.force)' 'vpm.View(query, scene, poses[~free]).save("hits.html")' 'print(len(poses), free.sum())' > job.py; python3 job.py
1000 600

# Cubes whose far face is behind the table's plane are in it by that depth; the force is the stiffness times the volume, toward the camera.
$ python3 -c 'import numpy as np; a = np.load("answers.npz"); truth = .01 * np.maximum(a["poses"][:, 2] + .05 - 1, 0); print(np.abs(a["volume"] - truth).max() < .002 * .001, np.abs(a["force"] + np.stack([0 * truth, 0 * truth, 1e5 * truth], axis=1)).max() < .01 * 1e5 * truth.max())' && grep -c '<html' hits.html
True True
1
