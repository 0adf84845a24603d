# SPDX-License-Identifier: BSD-3-Clause
"""Reads an MJCF, the model of MuJoCo: its bodies, joints and geoms, with defaults, materials and frames.

The format is described at https://mujoco.readthedocs.io/en/stable/XMLreference.html.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from unitylink.errors import shown

from .body import GREY, Body, Joint, Link, Mimic, Shape, Vector
from .robot_file import RobotFile
from .turning import Matrix, about, of_eulers, of_quaternion, rpy_of, with_x_and_y, with_z

KINDS = {"hinge": "revolute", "slide": "prismatic", "ball": "floating", "free": "floating"}
SEEN_GROUPS = 3  # MuJoCo draws the groups 0 to 2; those above have the shapes of collisions
LEFT_OUT = ("plane", "hfield", "sdf", "ellipsoid")
NOT_READ = ("include", "attach", "replicate", "composite", "flexcomp")
WAYS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")


@dataclass(frozen=True)
class Pose:
    """A place and an orientation within another frame."""

    at: NDArray[np.float64]
    turned: Matrix

    def then(self, inner: Pose) -> Pose:
        """Return the pose of `inner`, which is within this one."""
        return Pose(self.at + self.turned @ inner.at, self.turned @ inner.turned)


def read_mjcf(path: str | Path) -> Body:
    """Return the body of an MJCF file. No value moves its joints yet.

    Each body is a link. Between two joints of one body is a link without a shape. Raises UnityLinkError,
    which names the element, if something is wrong with the file or one of its meshes.
    """
    return _Reader(Path(path)).body()


class _Reader(RobotFile):
    def body(self) -> Body:
        root = self.root
        if root.tag != "mujoco":
            raise self.wrong(f"no MJCF: its root is {shown(root.tag)}, not mujoco")
        for one in root.iter():
            if one.tag in NOT_READ:
                remedy = "save the whole model with MuJoCo (mj_saveLastXML), and give that file"
                raise self.wrong(f"<{one.tag}> is not read; {remedy}")
        self.compiler = {name: value for one in root.iter("compiler") for name, value in one.items()}
        self.in_degrees = self.compiler.get("angle", "degree") == "degree"
        self.defaults: dict[str, dict[str, dict[str, str]]] = {"main": {}}
        for one in root.findall("default"):
            self._default(one, {})
        for material in self._assets("material"):
            name = material.get("name", "")
            white = (1.0, 1.0, 1.0, 1.0)
            red, green, blue, alpha = self.numbers(material, "rgba", f"material {shown(name)}", 4, white)
            self.colours[name] = (red, green, blue, alpha)
        self.files = {one.get("name") or Path(one.get("file", "")).stem: one for one in self._assets("mesh")}
        self.links: list[Link] = []
        self.joints: list[Joint] = []
        self.mimics = self._mimics()
        for world in root.findall("worldbody"):
            self._link("world", world, Pose(np.zeros(3), np.eye(3)), "main")
        return self.checked(root.get("model", ""), tuple(self.links), tuple(self.joints))

    def _default(self, element: Element, above: Mapping[str, dict[str, str]]) -> None:
        """Keep the attributes of a class, which has those of the class around it, too."""
        mine = {name: dict(values) for name, values in above.items()}
        for one in element:
            if one.tag != "default":
                mine[one.tag] = mine.get(one.tag, {}) | dict(one.items())
        self.defaults[element.get("class", "main")] = mine
        for one in element.findall("default"):
            self._default(one, mine)

    def _whole(self, element: Element, kind: str) -> Element:
        """Return the element with the attributes of its class. One's own say more."""
        name = element.get("class", kind)
        if name not in self.defaults:
            raise self.wrong(f"<{element.tag}>: there is no default class {shown(name)}")
        whole = self.defaults[name].get(element.tag, {}) | dict(element.items())
        if any(way in element.attrib for way in WAYS):
            whole = {key: value for key, value in whole.items() if key not in WAYS or key in element.attrib}
        return Element(element.tag, whole)

    def _assets(self, tag: str) -> list[Element]:
        return [
            self._whole(one, "main") for all_of in self.root.findall("asset") for one in all_of.findall(tag)
        ]

    def _mimics(self) -> dict[str, Mimic]:
        found = {}
        for one in (one for all_of in self.root.findall("equality") for one in all_of.findall("joint")):
            name, other = one.get("joint1", ""), one.get("joint2", "")
            where = f"equality of {shown(name)}"
            offset, factor, *more = self.numbers(one, "polycoef", where, 5, (0.0, 1.0, 0.0, 0.0, 0.0))
            if other and not any(more):
                found[name] = Mimic(other, factor, offset)
        return found

    def _link(self, name: str, element: Element, inner: Pose, kind: str) -> None:
        """Read a body whose frame is `inner` within the frame of its link, and all that it holds."""
        place = len(self.links)
        self.links.append(Link(name))
        shapes: list[Shape] = []
        self._content(name, element, inner, kind, shapes)
        self.links[place] = Link(name, tuple(shapes))

    def _content(self, name: str, element: Element, inner: Pose, kind: str, shapes: list[Shape]) -> None:
        for one in element:
            if one.tag == "geom":
                shape = self._shape(self._whole(one, kind), f"body {shown(name)}", inner)
                shapes += [] if shape is None else [shape]
            elif one.tag == "frame":
                within = inner.then(self._pose(one, f"a frame of {shown(name)}"))
                self._content(name, one, within, one.get("childclass", kind), shapes)
            elif one.tag == "body":
                self._body(name, one, inner, one.get("childclass", kind))

    def _body(self, parent: str, element: Element, inner: Pose, kind: str) -> None:
        name = element.get("name") or f"body {len(self.links)}"
        at = inner.then(self._pose(element, f"body {shown(name)}"))
        joints = [self._whole(one, kind) for one in element if one.tag in ("joint", "freejoint")]
        shift = np.zeros(3)  # from the frame of the body to that of its link, which is that of its last joint
        for number, joint in enumerate(joints):
            last = number == len(joints) - 1
            called = joint.get("name") or f"joint {number} of {name}"
            link = name if last else f"{name}, behind {called}"
            anchor = np.array(self.numbers(joint, "pos", f"joint {shown(called)}", 3, (0.0, 0.0, 0.0)))
            here = at.then(Pose(anchor - shift, np.eye(3)))
            self.joints.append(self._joint(called, joint, parent, link, here))
            if not last:
                self.links.append(Link(link))
            parent, at, shift = link, Pose(np.zeros(3), np.eye(3)), anchor
        if not joints:
            self.joints.append(Joint(f"to {name}", "fixed", parent, name, _xyz(at.at), rpy_of(at.turned)))
        self._link(name, element, Pose(-shift, np.eye(3)), kind)

    def _joint(self, name: str, element: Element, parent: str, child: str, at: Pose) -> Joint:
        kind = "free" if element.tag == "freejoint" else element.get("type", "hinge")
        where = f"joint {shown(name)}"
        if kind not in KINDS:
            raise self.wrong(f"{where}: the type {shown(kind)} is none of {', '.join(KINDS)}")
        axis = np.array(self.numbers(element, "axis", where, 3, (0.0, 0.0, 1.0)))
        if np.linalg.norm(axis) < 1e-9:
            raise self.wrong(f"{where}: its axis has no direction")
        axis /= np.linalg.norm(axis)
        if KINDS[kind] == "floating":
            self.notes.append(f"{where} is {kind}, and drawn at its origin: no single value moves it")
        (reference,) = self.numbers(element, "ref", where, 1, (0.0,))
        made = Joint(name, KINDS[kind], parent, child, _xyz(at.at), rpy_of(at.turned))
        made = replace(made, axis=_xyz(axis), mimic=self.mimics.get(name))
        if reference and made.moves:  # the model is drawn at the value `ref`
            angle = math.radians(reference) if self.in_degrees and made.turns else reference
            back = (
                Pose(np.zeros(3), about(_xyz(axis), -angle)) if made.turns else Pose(-angle * axis, np.eye(3))
            )
            at = at.then(back)
            made = replace(made, xyz=_xyz(at.at), rpy=rpy_of(at.turned))
        return made

    def _shape(self, element: Element, where: str, inner: Pose) -> Shape | None:
        kind = element.get("type", "mesh" if "mesh" in element.attrib else "sphere")
        if self.numbers(element, "group", where, 1, (0.0,))[0] >= SEEN_GROUPS:
            return None
        if kind in LEFT_OUT:
            self.notes.append(f"{where} is drawn without its {kind}")
            return None
        at, length = self._placed(element, where)
        pose, mesh, size = inner.then(at), -1, tuple[float, ...]()
        if kind == "mesh":
            name = element.get("mesh", "")
            if name not in self.files:
                raise self.wrong(f"{where}: there is no mesh {shown(name)}")
            folder = self.compiler.get("meshdir", self.compiler.get("assetdir", ""))
            found = self.mesh(str(Path(folder) / self.files[name].get("file", "")), where)
            if found is None:
                return None
            mesh, size = found, self.numbers(self.files[name], "scale", where, 3, (1.0, 1.0, 1.0))
        elif kind in ("sphere", "capsule", "cylinder", "box"):
            given = (element.get("size") or "").split()
            count = {"sphere": 1, "box": 3}.get(kind, 2) if length is None else 1
            element.set("size", " ".join(given[:count]))
            half = self.numbers(element, "size", where, count)
            if length is not None:
                half = (*half, *half, length / 2) if kind == "box" else (*half, length / 2)
            if kind == "box":
                size = tuple(2 * one for one in half)
            else:
                size = half[:1] if kind == "sphere" else (half[0], 2 * half[1])
                kind = "sphere" if kind == "sphere" else "cylinder"
        else:
            raise self.wrong(f"{where}: the shape {shown(kind)} is not known")
        colour = self.colours.get(element.get("material", ""), GREY)
        red, green, blue, alpha = self.numbers(element, "rgba", where, 4, colour)
        return Shape(kind, size, _xyz(pose.at), rpy_of(pose.turned), (red, green, blue, alpha), mesh)

    def _placed(self, element: Element, where: str) -> tuple[Pose, float | None]:
        """Return the pose of a geom, and its length if that is said by its ends."""
        if "fromto" not in element.attrib:
            return self._pose(element, where), None
        ends = np.array(self.numbers(element, "fromto", where, 6))
        way = ends[3:] - ends[:3]
        length = float(np.linalg.norm(way))
        if length < 1e-9:
            raise self.wrong(f"{where}: fromto has no length")
        return Pose((ends[:3] + ends[3:]) / 2, with_z(-way)), length  # as MuJoCo: z points to the first end

    def _pose(self, element: Element, where: str) -> Pose:
        at = np.array(self.numbers(element, "pos", where, 3, (0.0, 0.0, 0.0)))
        given = [way for way in WAYS if way in element.attrib]
        if len(given) > 1:
            raise self.wrong(f"{where}: {' and '.join(given)}; one orientation is enough")
        if not given:
            return Pose(at, np.eye(3))
        numbers = self.numbers(
            element, given[0], where, {"quat": 4, "axisangle": 4, "xyaxes": 6}.get(given[0], 3)
        )
        unit = math.pi / 180 if self.in_degrees else 1.0
        try:
            if given[0] == "euler":
                order = self.compiler.get("eulerseq", "xyz")
                if len(order) != 3 or not set(order.lower()) <= set("xyz"):
                    raise self.wrong(f"eulerseq={shown(order)}; expected three letters of x, y, z, X, Y, Z")
                turned = of_eulers([unit * angle for angle in numbers], order)
            else:
                with np.errstate(divide="raise", invalid="raise"):
                    turned = {
                        "quat": lambda: of_quaternion(*numbers),
                        "axisangle": lambda: about(numbers[:3], unit * numbers[3]),
                        "xyaxes": lambda: with_x_and_y(numbers[:3], numbers[3:]),
                        "zaxis": lambda: with_z(numbers),
                    }[given[0]]()
        except ArithmeticError:
            raise self.wrong(f"{where}: {given[0]} has no direction") from None
        return Pose(at, turned)


def _xyz(vector: NDArray[np.float64]) -> Vector:
    x, y, z = (float(one) + 0.0 for one in vector)
    return x, y, z
