# SPDX-License-Identifier: BSD-3-Clause
"""Reads a URDF, the robot description of ROS: its links, visual shapes and joints."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from unitylink.errors import UnityLinkError, shown

from .body import GREY, Body, Joint, Link, Mesh, Mimic, Shape, Vector
from .mesh_files import mesh_file
from .stl import read_stl
from .xml_tree import read_xml

KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
MOST_BYTES = 24_000_000  # of the triangles of all meshes
MOST_LINKS = 1000
_MOST = 1e4  # m; a longer robot is a mistake
_EDGES, _ROUND = 3, {"sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}


def read_urdf(path: str | Path) -> Body:
    """Return the body of a URDF file. No value moves its joints yet.

    Raises UnityLinkError, which names the element, if something is wrong with the file or one of its meshes.
    """
    return _Reader(Path(path)).body()


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.root = read_xml(path)
        self.meshes: dict[Path, int] = {}
        self.triangles: list[Mesh] = []
        self.notes: list[str] = []
        self.colours: dict[str, tuple[float, float, float, float]] = {}

    def wrong(self, what: str) -> UnityLinkError:
        return UnityLinkError(f"{self.path}: {what}")

    def body(self) -> Body:
        root = self.root
        if root.tag != "robot":
            raise self.wrong(f"no URDF: its root is {shown(root.tag)}, not robot")
        if any("xacro" in one.tag for one in root.iter()):
            raise self.wrong("this is a xacro; make a URDF of it: xacro FILE.urdf.xacro > FILE.urdf")
        for material in root.findall("material"):
            self._colour(material)
        links = tuple(self._link(one) for one in root.findall("link"))
        if not links or len(links) > MOST_LINKS:
            raise self.wrong(f"{len(links)} links; a robot has 1 to {MOST_LINKS}")
        joints = tuple(self._joint(one) for one in root.findall("joint"))
        self._check_tree(links, joints)
        name = root.get("name", "")
        return Body(name, links, joints, tuple(self.triangles), notes=tuple(self.notes))

    def _check_tree(self, links: tuple[Link, ...], joints: tuple[Joint, ...]) -> None:
        """Each link is held by one joint at most, one by none, and all hang together."""
        for what, names in ("link", [one.name for one in links]), ("joint", [one.name for one in joints]):
            for name in names:
                if names.count(name) > 1:
                    raise self.wrong(f"two {what}s have the name {shown(name)}")
        known, parents = {one.name for one in links}, {}
        for joint in joints:
            for end in joint.parent, joint.child:
                if end not in known:
                    raise self.wrong(f"joint {shown(joint.name)}: there is no link {shown(end)}")
            if joint.child in parents:
                raise self.wrong(f"link {shown(joint.child)} is the child of two joints")
            parents[joint.child] = joint.parent
            if joint.mimic is not None and joint.mimic.joint not in {one.name for one in joints}:
                raise self.wrong(
                    f"joint {shown(joint.name)} mimics {shown(joint.mimic.joint)}, which is not there"
                )
        roots = [one.name for one in links if one.name not in parents]
        if len(roots) != 1:
            raise self.wrong(
                f"{len(roots)} links without a parent; a robot has one: {shown(', '.join(roots))}"
            )
        for link in known:
            seen, above = {link}, link
            while above in parents:
                above = parents[above]
                if above in seen:
                    raise self.wrong(f"link {shown(above)} is above itself")
                seen.add(above)
        followed = {one.name: one.mimic.joint for one in joints if one.mimic is not None}
        for name, other in followed.items():
            if other in followed:
                raise self.wrong(f"joint {shown(name)} mimics one that itself mimics another; name that one")

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
            size = self._numbers(given, "size", where, 3)
        elif kind in _ROUND:
            size = tuple(self._numbers(given, one, where, 1)[0] for one in _ROUND[kind])
            kind = "cylinder" if kind == "capsule" else kind
        elif kind == "mesh":
            size = self._numbers(given, "scale", where, 3, (1.0, 1.0, 1.0))
            found = self._mesh(given.get("filename", ""), where)
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

    def _mesh(self, name: str, where: str) -> int | None:
        path = mesh_file(name, self.path)
        if path.suffix.lower() != ".stl":
            self.notes.append(f"{where} is drawn without {path.name}: only STL meshes are drawn; convert it")
            return None
        if path not in self.meshes:
            self.meshes[path] = len(self.triangles)
            self.triangles.append(Mesh(path.name, read_stl(path)))
            if sum(len(mesh.triangles) for mesh in self.triangles) > MOST_BYTES:
                raise self.wrong(f"its meshes have more than {MOST_BYTES // 36:,} triangles; simplify them")
        return self.meshes[path]

    def _colour(self, material: Element) -> tuple[float, float, float, float]:
        name, colour = material.get("name", ""), material.find("color")
        if colour is not None:
            red, green, blue, alpha = self._numbers(colour, "rgba", f"material {shown(name)}", 4)
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
            x, y, z = self._numbers(given, "xyz", where, 3)
            length = math.hypot(x, y, z)
            if length < 1e-9:
                raise self.wrong(f"{where}: its axis has no direction")
            axis = (x / length, y / length, z / length)
        mimic = None
        if (given := element.find("mimic")) is not None:
            (multiplier,) = self._numbers(given, "multiplier", where, 1, (1.0,))
            (offset,) = self._numbers(given, "offset", where, 1, (0.0,))
            mimic = Mimic(given.get("joint", ""), multiplier, offset)
        if kind in ("floating", "planar"):
            self.notes.append(f"{where} is {kind}, and drawn at its origin: no single value moves it")
        return Joint(name, kind, ends[0], ends[1], xyz, rpy, axis, mimic)

    def _origin(self, element: Element, where: str) -> tuple[Vector, Vector]:
        origin = element.find("origin")
        if origin is None:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        x, y, z = self._numbers(origin, "xyz", where, 3, (0.0, 0.0, 0.0))
        roll, pitch, yaw = self._numbers(origin, "rpy", where, 3, (0.0, 0.0, 0.0))
        return (x, y, z), (roll, pitch, yaw)

    def _name(self, element: Element) -> str:
        name = element.get("name", "")
        if not name or len(name) > 200:
            raise self.wrong(f"a {element.tag} has no name, or one of more than 200 letters")
        return name

    def _numbers(
        self, element: Element, name: str, where: str, count: int, default: tuple[float, ...] | None = None
    ) -> tuple[float, ...]:
        text = element.get(name)
        if text is None and default is not None:
            return default
        try:
            numbers = tuple(float(word) for word in (text or "").split())
        except ValueError:
            numbers = ()
        if len(numbers) != count or not all(abs(number) < _MOST for number in numbers):
            plural = "s" if count > 1 else ""
            raise self.wrong(
                f"{where}: {name}={shown(text or '')}; expected {count} number{plural} below {_MOST:g}"
            )
        return numbers
