# SPDX-License-Identifier: BSD-3-Clause
"""An ament package from a spec: messages, services, nodes, launch file, parameters."""

from __future__ import annotations

import re

from ..ros_common.cpp import cpp_robot
from ..ros_common.package import definitions, headers, plan_packages, proxies, rendered
from ..spec_plan import SpecPlan
from .control import control

__all__ = ["ros2_files"]


def ros2_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of a package per public constructor, in the folder ros2/."""
    files: dict[str, str] = {}
    for package in plan.part(plan_packages):
        folder = f"ros2/{package.name}"
        python = f"{package.name}_node"  # rosidl itself makes the Python package with the name of the package
        templates = {
            "package.xml": "package.xml.jinja",
            "CMakeLists.txt": "CMakeLists.txt.jinja",
            "README.md": "README.md.jinja",
            f"launch/{package.interface.robot}.launch.py": "robot.launch.py.jinja",
            "config/parameters.yaml": "parameters.yaml.jinja",
            "scripts/node.py": "node.py.jinja",
            f"{python}/__init__.py": "package_init.py.jinja",
            f"{python}/interface.py": "interface.py.jinja",
        }
        plugin = control(package, folder)
        files |= rendered(package, templates, "ros2", folder, control=bool(plugin))
        files |= plugin
        cpp = {"src/robot.hpp": "robot.hpp.jinja", "src/node.cpp": "node.cpp.jinja"}
        more = {"cpp": cpp_robot(package), "headers": [_header(t) for t in headers(package.interface)]}
        files |= rendered(package, cpp, "ros2", folder, **more)
        files |= definitions(package, folder)
        files |= proxies(package, f"{folder}/{python}")
    return files


def _header(type_name: str) -> str:
    """Return the header that rosidl makes for a message: `sensor_msgs/msg/joint_state` for
    `sensor_msgs/JointState`.
    """
    package, _, name = type_name.partition("/")
    parted = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name)
    return f"{package}/msg/{parted.lower()}"
