"""Builds the wheel of the package by CMake (PEP 517), with nothing but the standard library.

The extension is built in build/wheel for the Python that runs pip. `--config-settings build-dir=DIR` takes a build tree that is
configured already.
"""
import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import sysconfig
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = "lodestone_python_package"


def version():
    """As the project's CMakeLists.txt says."""
    return re.search(r"project\(lodestone VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def metadata():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version()}", f"Summary: {project['description']}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {needed}" for needed in project["dependencies"]]
    for extra, needed in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {each}; extra == "{extra}"' for each in needed)]
    return "\n".join(lines) + "\n"


def build(config_settings):
    """The folder that holds the package."""
    folder = (config_settings or {}).get("build-dir")
    if folder is None:
        folder = ROOT / "build" / "wheel"
        subprocess.run(["cmake", "--preset", "release", "-B", folder, f"-DLODESTONE_PYTHON_EXECUTABLE={sys.executable}"], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", folder, "--target", TARGET], cwd=ROOT, check=True)
    return pathlib.Path(folder) / "python"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The one hook that pip must have; returns the file's name."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    name = f"lodestone-{version()}"
    place = build(config_settings)
    content = {str(path.relative_to(place)): path.read_bytes() for path in sorted((place / "lodestone").rglob("*"))
               if path.is_file() and path.suffix != ".pyc"}
    info = f"{name}.dist-info"
    content[f"{info}/METADATA"] = metadata().encode()
    content[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: lodestone\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    content[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    rows = [f"{path},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()},{len(data)}"
            for path, data in content.items()]
    content[f"{info}/RECORD"] = ("\n".join([*rows, f"{info}/RECORD,,"]) + "\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / f"{name}-{tag}.whl", "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in content.items():
            wheel.writestr(path, data)
    return f"{name}-{tag}.whl"


def build_sdist(sdist_directory, config_settings=None):
    """There is none: the sources are the repository."""
    raise RuntimeError("build the wheel from the repository: pip install --no-build-isolation --no-deps .")
