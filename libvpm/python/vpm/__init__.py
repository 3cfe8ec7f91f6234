"""How much of a solid tool is in a scanned scene, and which force and torque push it out.

    import vpm
    tool = vpm.make_tool("gripper.stl", scale=0.001)             # or Tool.read("gripper.vpmg")
    cloud = vpm.import_depth(image, intrinsics=(525, 525, 319.5, 239.5))
    query = vpm.Query(tool)
    result = query.run(vpm.Scene(cloud), [0, 0, 1, 0, 0, 0, 1])      # tool to world
    print(result.volume_fraction, result.force)

Lengths are metres. A pose maps tool (or camera) to world coordinates: 7 numbers tx ty tz qx
qy qz qw, or a matrix (4, 4) or (3, 4). Errors are vpm.Error and its subclasses; data that are
probably not what was meant give vpm.SetupWarning.
"""
import os as _os

from . import _vpm
from ._errors import ArgumentError, Error, RefusedError, SetupWarning, UnavailableError, WriteError
from ._vpm import (
    Body,
    Collides,
    Contact,
    DepthStream,
    DeviceArray,
    DeviceResults,
    LevelQuery,
    Overlap,
    OverlapQuery,
    PointCloud,
    Query,
    Registration,
    Remark,
    RemovedSolid,
    Result,
    Results,
    Scene,
    SetupCheck,
    SolidBody,
    SolidMesh,
    SolidRemover,
    SpherePacking,
    Tool,
    ToolLevel,
    View,
    VirtualCoupling,
    __version__,
    build_tool,
    coupling_limits,
    critical_mass,
    cuda_device_count,
    device_name,
    doubted_camera,
    pack,
    register_cameras,
    set_thread_count,
    stable_rate,
    uncertain_thickness,
)

__all__ = [
    "ArgumentError", "Body", "Collides", "Contact", "DepthStream", "DeviceArray", "DeviceResults", "Error", "LevelQuery",
    "Overlap", "OverlapQuery", "PointCloud", "Query", "RefusedError", "Registration", "Remark", "RemovedSolid", "Result", "Results",
    "Scene", "SetupCheck", "SetupWarning", "SolidBody", "SolidMesh", "SolidRemover", "SpherePacking", "Tool", "ToolLevel",
    "UnavailableError", "View", "VirtualCoupling", "WriteError", "build_tool", "coupling_limits", "critical_mass",
    "cuda_device_count", "device_name", "doubted_camera", "import_cloud", "import_depth", "make_tool", "overlap",
    "pack", "register_cameras", "set_thread_count", "solid_of", "stable_rate", "uncertain_thickness",
]


def import_cloud(path, *, intrinsics=None, camera_pose=None, axes="opencv", depth_scale=None, decode="", invalid=(),
                 usual_invalid=True, range=None, along_ray=False, channel="", flip=False, orient="", method="inverse-depth",
                 window=7, edge_gate=0.02):
    return _vpm.import_cloud(_os.fspath(path), intrinsics=intrinsics, camera_pose=camera_pose, axes=axes,
                             depth_scale=depth_scale, decode=decode, invalid=list(invalid), usual_invalid=usual_invalid,
                             range=range, along_ray=along_ray, channel=channel, flip=flip, orient=orient, method=method,
                             window=window, edge_gate=edge_gate)


def import_depth(image, *, intrinsics, camera_pose=None, axes="opencv", depth_scale=None, decode="", invalid=(),
                 usual_invalid=True, range=None, along_ray=False, method="inverse-depth", window=7, edge_gate=0.02):
    return _vpm.import_depth(image, intrinsics=intrinsics, camera_pose=camera_pose, axes=axes, depth_scale=depth_scale,
                             decode=decode, invalid=list(invalid), usual_invalid=usual_invalid, range=range,
                             along_ray=along_ray, method=method, window=window, edge_gate=edge_gate)


import_cloud.__doc__ = _vpm.import_cloud.__doc__.split("\n\n", 1)[1]
import_depth.__doc__ = _vpm.import_depth.__doc__.split("\n\n", 1)[1]


def solid_of(mesh, **options):
    """Returns the vpm.SolidMesh of a file's path, of (vertices, triangles), or of what has
    `vertices` and `faces`, as meshes of trimesh and Open3D-like libraries do. Options are those
    of SolidMesh.read and from_triangles."""
    if isinstance(mesh, SolidMesh):
        if options:
            raise ArgumentError("a SolidMesh takes no further options")
        return mesh
    if isinstance(mesh, (str, _os.PathLike)):
        return SolidMesh.read(_os.fspath(mesh), **options)
    vertices, triangles = (mesh.vertices, mesh.faces) if hasattr(mesh, "faces") else mesh
    return SolidMesh.from_triangles(vertices, triangles, **options)


def make_tool(mesh, *, spheres=1000, levels=(), calibrate=False, progress=None, **options):
    """Packs a mesh and returns its vpm.Tool.

    mesh: what solid_of() takes; options are passed on. spheres: number of spheres. levels:
    numbers of spheres of further levels. calibrate: measures each level's error, for
    vpm.LevelQuery."""
    packing = pack(solid_of(mesh, **options), spheres=spheres, progress=progress)
    return build_tool(packing, levels=list(levels), calibrate=calibrate, progress=progress)


def overlap(a, pose_a, b, pose_b, *, with_force=True, stiffness=1.0, contacts=0):
    """Returns the vpm.Overlap of two solids at a pose each: vpm.SolidBody, or what solid_of()
    takes.

    Exact for closed meshes: flush faces share nothing, thin, coincident and enclosed solids
    are right. Keep an OverlapQuery of two SolidBody for many poses: preparing them takes longer
    than asking."""
    bodies = (solid if isinstance(solid, SolidBody) else SolidBody(solid_of(solid), with_force=with_force)
              for solid in (a, b))
    return OverlapQuery(*bodies, with_force=with_force, stiffness=stiffness, contacts=contacts).run(pose_a, pose_b)
