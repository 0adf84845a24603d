# SPDX-License-Identifier: BSD-3-Clause
"""A catkin package from a spec: messages, services, nodes, launch file, parameters."""

from __future__ import annotations

from ..ros_common.cpp import cpp_robot
from ..ros_common.package import definitions, headers, plan_packages, proxies, rendered
from ..spec_plan import SpecPlan

__all__ = ["ros1_files"]


def ros1_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of a package per public constructor, in the folder ros1/."""
    files: dict[str, str] = {}
    for package in plan.part(plan_packages):
        folder = f"ros1/{package.name}"
        python = f"src/{package.name}"
        templates = {
            "package.xml": "package.xml.jinja",
            "CMakeLists.txt": "CMakeLists.txt.jinja",
            "setup.py": "setup.py.jinja",
            "README.md": "README.md.jinja",
            f"launch/{package.interface.robot}.launch": "robot.launch.jinja",
            "config/parameters.yaml": "parameters.yaml.jinja",
            "scripts/node.py": "node.py.jinja",
            f"{python}/__init__.py": "package_init.py.jinja",
            f"{python}/interface.py": "interface.py.jinja",
        }
        files |= rendered(package, templates, "ros1", folder)
        cpp = {"src/robot.hpp": "robot.hpp.jinja", "src/node.cpp": "node.cpp.jinja"}
        more = {"cpp": cpp_robot(package), "headers": headers(package.interface)}
        files |= rendered(package, cpp, "ros1", folder, **more)
        files |= definitions(package, folder)
        files |= proxies(package, f"{folder}/{python}")
    return files
