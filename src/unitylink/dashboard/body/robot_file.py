# SPDX-License-Identifier: BSD-3-Clause
"""What the readers of robot descriptions share: numbers, meshes, and that the links are a tree."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

from unitylink.errors import UnityLinkError, shown

from .body import Body, Joint, Link, Mesh
from .mesh_files import mesh_file
from .stl import read_stl
from .xml_tree import read_xml

MOST_BYTES = 24_000_000  # of the triangles of all meshes
MOST_LINKS = 1000
_MOST = 1e4  # m; a longer robot is a mistake


class RobotFile:
    """A file that describes a robot. Its elements are read by a subclass."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.root = read_xml(path)
        self.meshes: dict[Path, int] = {}
        self.triangles: list[Mesh] = []
        self.notes: list[str] = []
        self.colours: dict[str, tuple[float, float, float, float]] = {}

    def wrong(self, what: str) -> UnityLinkError:
        """Return an error that names the file."""
        return UnityLinkError(f"{self.path}: {what}")

    def checked(self, name: str, links: tuple[Link, ...], joints: tuple[Joint, ...]) -> Body:
        """Return the body of these links and joints, if they are a tree."""
        if not links or len(links) > MOST_LINKS:
            raise self.wrong(f"{len(links)} links; a robot has 1 to {MOST_LINKS}")
        self._check_tree(links, joints)
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

    def mesh(self, name: str, where: str) -> int | None:
        """Return the number of a mesh, or None with a note if it is of a kind that is not drawn."""
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

    def numbers(
        self, element: Element, name: str, where: str, count: int, default: tuple[float, ...] | None = None
    ) -> tuple[float, ...]:
        """Return the `count` numbers of an attribute."""
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
