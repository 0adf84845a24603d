# SPDX-License-Identifier: BSD-3-Clause
"""Reads a URDF, the robot description of ROS: its links, visual shapes and joints."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from unitylink.errors import shown

from .body import GREY, Body, Joint, Link, Mimic, Shape, Vector
from .robot_file import RobotFile

KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_EDGES, _ROUND = 3, {"sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}


def read_urdf(path: str | Path) -> Body:
    """Return the body of a URDF file. No value moves its joints yet.

    Raises UnityLinkError, which names the element, if something is wrong with the file or one of its meshes.
    """
    return _Reader(Path(path)).body()


class _Reader(RobotFile):
    def body(self) -> Body:
        root = self.root
        if root.tag != "robot":
            raise self.wrong(f"no URDF: its root is {shown(root.tag)}, not robot")
        if any("xacro" in one.tag for one in root.iter()):
            raise self.wrong("this is a xacro; make a URDF of it: xacro FILE.urdf.xacro > FILE.urdf")
        for material in root.findall("material"):
            self._colour(material)
        links = tuple(self._link(one) for one in root.findall("link"))
        joints = tuple(self._joint(one) for one in root.findall("joint"))
        return self.checked(root.get("name", ""), links, joints)

    def _link(self, element: Element) -> Link:
        name = self._name(element)
        seen = element.findall("visual") or element.findall("collision")
        shapes = (self._shape(one, f"link {shown(name)}") for one in seen)
        return Link(name, tuple(shape for shape in shapes if shape is not None))

    def _shape(self, element: Element, where: str) -> Shape | None:
        geometry = element.find("geometry")
        if geometry is None or len(geometry) != 1:
            raise self.wrong(f"{where}: a visual has one geometry with one shape")
        given, kind, mesh = geometry[0], geometry[0].tag, -1
        size: tuple[float, ...]
        if kind == "box":
            size = self.numbers(given, "size", where, 3)
        elif kind in _ROUND:
            size = tuple(self.numbers(given, one, where, 1)[0] for one in _ROUND[kind])
            kind = "cylinder" if kind == "capsule" else kind
        elif kind == "mesh":
            size = self.numbers(given, "scale", where, 3, (1.0, 1.0, 1.0))
            found = self.mesh(given.get("filename", ""), where)
            if found is None:
                return None
            mesh = found
        else:
            raise self.wrong(
                f"{where}: the shape {shown(kind)} is not known; there are box, cylinder, sphere, mesh"
            )
        xyz, rpy = self._origin(element, where)
        material = element.find("material")
        colour = self._colour(material) if material is not None else GREY
        return Shape(kind, size, xyz, rpy, colour, mesh)

    def _colour(self, material: Element) -> tuple[float, float, float, float]:
        name, colour = material.get("name", ""), material.find("color")
        if colour is not None:
            red, green, blue, alpha = self.numbers(colour, "rgba", f"material {shown(name)}", 4)
            self.colours[name] = (red, green, blue, alpha)
        return self.colours.get(name, GREY)

    def _joint(self, element: Element) -> Joint:
        name, kind = self._name(element), element.get("type", "")
        where = f"joint {shown(name)}"
        if kind not in KINDS:
            raise self.wrong(f"{where}: the type {shown(kind)} is none of {', '.join(KINDS)}")
        ends = []
        for end in "parent", "child":
            found = element.find(end)
            ends.append(found.get("link", "") if found is not None else "")
        xyz, rpy = self._origin(element, where)
        axis: Vector = (1.0, 0.0, 0.0)
        if (given := element.find("axis")) is not None:
            x, y, z = self.numbers(given, "xyz", where, 3)
            length = math.hypot(x, y, z)
            if length < 1e-9:
                raise self.wrong(f"{where}: its axis has no direction")
            axis = (x / length, y / length, z / length)
        mimic = None
        if (given := element.find("mimic")) is not None:
            (multiplier,) = self.numbers(given, "multiplier", where, 1, (1.0,))
            (offset,) = self.numbers(given, "offset", where, 1, (0.0,))
            mimic = Mimic(given.get("joint", ""), multiplier, offset)
        if kind in ("floating", "planar"):
            self.notes.append(f"{where} is {kind}, and drawn at its origin: no single value moves it")
        return Joint(name, kind, ends[0], ends[1], xyz, rpy, axis, mimic)

    def _origin(self, element: Element, where: str) -> tuple[Vector, Vector]:
        origin = element.find("origin")
        if origin is None:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        x, y, z = self.numbers(origin, "xyz", where, 3, (0.0, 0.0, 0.0))
        roll, pitch, yaw = self.numbers(origin, "rpy", where, 3, (0.0, 0.0, 0.0))
        return (x, y, z), (roll, pitch, yaw)

    def _name(self, element: Element) -> str:
        name = element.get("name", "")
        if not name or len(name) > 200:
            raise self.wrong(f"a {element.tag} has no name, or one of more than 200 letters")
        return name
