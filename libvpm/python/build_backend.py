"""Makes the wheel of the module `vpm`, as PEP 517 asks, without any package of Python's.

Builds in build/python of the repository, or takes the build folder that the environment variable VPM_BUILD names, which was
configured with -DVPM_PYTHON=ON. The wheel holds libvpm.so and libvpm_solid.so; their other libraries are Debian's.
"""
import base64
import hashlib
import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent


def _run(*command):
    subprocess.run([str(part) for part in command], check=True)


def _build():
    """Returns the build folder with the module in it."""
    build = pathlib.Path(os.environ.get("VPM_BUILD", REPOSITORY / "build/python"))
    if "VPM_BUILD" not in os.environ:
        _run("cmake", "-S", REPOSITORY, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DVPM_PYTHON=ON",
             f"-DPython3_EXECUTABLE={getattr(sys, '_base_executable', sys.executable)}")
    _run("cmake", "--build", build, "--parallel", os.cpu_count() or 1, "--target", "vpm_python", "vpm_public",
         "vpm_solid_public")
    return build


def _version():
    for line in (HERE.parent / "include/vpm/version.h").read_text().splitlines():
        if line.startswith("#define VPM_VERSION "):
            return line.split('"')[1]
    raise RuntimeError("version.h has no VPM_VERSION")


def _metadata():
    readme = (HERE / "README.md").read_text()
    return (f"Metadata-Version: 2.1\nName: vpm\nVersion: {_version()}\nSummary: Volumetric penetration measure\n"
            f"Requires-Python: >=3.11\nRequires-Dist: numpy\nDescription-Content-Type: text/markdown\n\n{readme}")


def _record_of(name, content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    info = f"vpm-{_version()}.dist-info"
    wheel = f"vpm-{_version()}-{tag}.whl"
    with tempfile.TemporaryDirectory() as folder:
        _run("cmake", "--install", _build(), "--component", "vpm_python", "--prefix", folder, "--strip")
        files = {path.relative_to(folder).as_posix(): path.read_bytes()
                 for path in sorted(pathlib.Path(folder).rglob("*")) if path.is_file() and not path.is_symlink()}
        # A wheel has no links: the libraries stand there by the names that the module asks for.
        for link in sorted(pathlib.Path(folder).rglob("*")):
            if link.is_symlink():
                files[link.relative_to(folder).as_posix()] = link.read_bytes()
                files.pop(link.resolve().relative_to(pathlib.Path(folder).resolve()).as_posix(), None)
    files[f"{info}/METADATA"] = _metadata().encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: vpm\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = [_record_of(name, content) for name, content in files.items()] + [f"{info}/RECORD,,"]
    files[f"{info}/RECORD"] = ("\n".join(record) + "\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return wheel
