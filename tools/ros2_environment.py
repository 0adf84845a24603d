# SPDX-License-Identifier: BSD-3-Clause
"""An environment with ROS 2 that sees this checkout: `python tools/ros2_environment.py FOLDER LOCK`.

LOCK names the wheels of ROS 2's own packages on PyPI, with their hashes: tools/locks/jazzy.txt. The
environment is separate from .venv, because ROS 2 needs older versions of what the tests use. A second run
with the same lock changes nothing. It prints the path of the environment's Python.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path


def make(folder: Path, lock: Path) -> Path:
    """Make the environment, unless it was already made from this lock. Return its Python."""
    python, stamp = folder / "bin" / "python3", folder / "made-of.txt"
    made_of = f"{sys.executable} {sys.version}\n{lock.read_text()}"
    if stamp.exists() and stamp.read_text() == made_of:
        return python
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", "--clear", folder], check=True)
    pip = [sys.executable, "-m", "pip", "--python", python, "-qq", "--disable-pip-version-check"]
    subprocess.run([*pip, "install", "--no-compile", "--require-hashes", "-r", lock], check=True)
    (site,) = (folder / "lib").glob("python3*/site-packages")
    here = next(path for path in sys.path if path.endswith("site-packages"))
    (site / "unitylink.pth").write_text(f"import site; site.addsitedir({here!r})\n")
    _place(folder, python)
    subprocess.run([python, "-c", "import rclpy, unitylink"], check=True)
    stamp.write_text(made_of)
    return python


def _place(folder: Path, python: Path) -> None:
    """Correct paths in the wheels' CMake files. They name the builder's headers of Python and numpy."""
    asked = [python, "-c", "import numpy; print(numpy.get_include())"]
    numpy = subprocess.run(asked, check=True, capture_output=True, text=True).stdout.strip()
    tag = f"{sys.version_info.major}{sys.version_info.minor}"
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    theirs = f"/opt/python/cp{tag}-cp{tag}"
    for file in (folder / "share").rglob("*.cmake"):
        text = file.read_text()
        if theirs in text:
            text = text.replace(f"{theirs}/lib/{version}/site-packages/numpy/_core/include", numpy)
            file.write_text(text.replace(f"{theirs}/include/{version}", sysconfig.get_path("include")))


if __name__ == "__main__":
    print(make(Path(sys.argv[1]).absolute(), Path(sys.argv[2])))
