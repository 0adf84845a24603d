# SPDX-License-Identifier: BSD-3-Clause
"""An environment that sees this checkout and the ROS 1 of Debian: `python tools/ros_environment.py FOLDER`.

A user gets the same with `python3 -m venv --system-site-packages`. This needs the Python for which ROS was
built. The Python of a checkout may be another build of the same version.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

DEBIAN = Path("/usr/lib/python3/dist-packages")


def make(folder: Path) -> Path:
    """Make the environment. Return its Python."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", "--clear", folder], check=True)
    (site,) = (folder / "lib").glob("python3*/site-packages")
    here = next(path for path in sys.path if path.endswith("site-packages"))
    (site / "ros.pth").write_text(f"import site; site.addsitedir({here!r})\n{DEBIAN}\n")
    python = folder / "bin" / "python3"
    subprocess.run([python, "-c", "import rospy, unitylink"], check=True)
    return python


if __name__ == "__main__":
    print(make(Path(sys.argv[1])))
