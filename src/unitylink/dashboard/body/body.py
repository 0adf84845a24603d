# SPDX-License-Identifier: BSD-3-Clause
"""What a robot looks like: links with shapes, and joints between them. Lengths in m, angles in rad."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

Vector = tuple[float, float, float]
GREY = (0.6, 0.65, 0.7, 1.0)


@dataclass(frozen=True)
class Shape:
    """A shape of a link, at `xyz` and turned by `rpy` (roll, pitch, yaw).

    `size` is, by `kind`: the three edges of a box; radius and length of a cylinder, whose axis is z; the
    radius of a sphere; the three scales of a mesh. `mesh` is the number of the mesh, or -1.
    """

    kind: str
    size: tuple[float, ...]
    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)
    colour: tuple[float, float, float, float] = GREY
    mesh: int = -1


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another one: `multiplier` * its position + `offset`."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A joint. `kind` is one of URDF: revolute, continuous, prismatic, fixed, floating or planar."""

    name: str
    kind: str
    parent: str
    child: str
    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (1.0, 0.0, 0.0)
    mimic: Mimic | None = None

    @property
    def turns(self) -> bool:
        return self.kind in ("revolute", "continuous")

    @property
    def moves(self) -> bool:
        """Whether one value moves it."""
        return self.turns or self.kind == "prismatic"


@dataclass(frozen=True)
class Link:
    """A rigid part with its shapes."""

    name: str
    shapes: tuple[Shape, ...] = ()


@dataclass(frozen=True)
class Mesh:
    """Triangles: nine little-endian 32-bit floats each, three corners with x, y and z."""

    name: str
    triangles: bytes


@dataclass(frozen=True)
class Moved:
    """The value that moves a joint: an item by its index and path, times `factor`, in rad or m."""

    item: int
    path: str
    factor: float


@dataclass(frozen=True)
class Body:
    """A whole robot. `moved` says by the name of a joint which value moves it. `notes` are for the user."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    meshes: tuple[Mesh, ...] = ()
    moved: Mapping[str, Moved] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def told(self) -> dict[str, Any]:
        """Return it for JSON. The triangles of meshes are fetched by themselves."""
        return {
            "name": self.name,
            "links": [asdict(link) for link in self.links],
            "joints": [asdict(joint) for joint in self.joints],
            "meshes": [mesh.name for mesh in self.meshes],
            "moved": {name: asdict(moved) for name, moved in self.moved.items()},
            "notes": list(self.notes),
        }
