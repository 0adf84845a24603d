# SPDX-License-Identifier: BSD-3-Clause
"""The specs with which the bridges of a fleet run: copies, so that a file that is edited changes no robot."""

from __future__ import annotations

import hashlib
import tempfile
from pathlib import Path

from unitylink.errors import FleetError, UnityLinkError, UnknownName
from unitylink.interface.wire_hash import wire_hash
from unitylink.server.scopes import Rights
from unitylink.spec import load
from unitylink.spec.model import Spec
from unitylink.zenoh.spec_files import pack_spec, unpack_spec

from .description import Fleet, FleetRobot
from .reader import own_spec

_COPIED = "sim"  # the links with a spec of their own that run from a copy; others have files beside it


class SpecStore:
    """Copies of specs in a folder that is removed at the end. Each different spec is compiled once."""

    def __init__(self, fleet: Fleet) -> None:
        self._fleet = fleet
        self._folder = tempfile.TemporaryDirectory(prefix="unitylink-fleet-")
        self._known: dict[str, tuple[Spec, Path]] = {}

    def __enter__(self) -> SpecStore:
        return self

    def __exit__(self, *_: object) -> None:
        self._folder.cleanup()

    @property
    def folder(self) -> Path:
        """The folder. Files there are gone at the end."""
        return Path(self._folder.name)

    def taken(self, robot: FleetRobot) -> tuple[str, str]:
        """Return the LINK and the spec file of a robot, as they are now, for its bridge.

        The file is empty if the link brings its own. Raises FleetError if the spec has errors. It also does
        so if the spec has several boards and none is chosen, and if `may` names a part that is not there.
        """
        _, copy = self._copy(robot)
        kind, _, rest = robot.link.partition(":")
        if kind == _COPIED:
            _, mark, query = rest.partition("?")
            return f"{kind}:{copy}{mark}{query}", str(copy)
        if own_spec(robot.link):
            return robot.link, ""
        return robot.link, str(copy)

    def hash(self, robot: FleetRobot) -> str:
        """Return the wire hash of the spec that the file has now. Raises FleetError."""
        return f"{wire_hash(self._copy(robot)[0]):016x}"

    def _copy(self, robot: FleetRobot) -> tuple[Spec, Path]:
        file = self._fleet.place(robot.spec)
        place = f"{self._fleet.file}: {robot.name}"
        try:
            text = pack_spec(file, robot.root or "")
            key = hashlib.sha256(text.encode()).hexdigest()[:16]
            if key not in self._known:
                whole = load(file)
                if not robot.root and len(whole.roots) > 1:
                    names = ", ".join(root.name for root in whole.roots)
                    raise FleetError(
                        f"{place}: {robot.spec} has several boards: {names}; choose one with root"
                    )
                spec = whole.only(robot.root) if robot.root else whole
                folder = Path(self._folder.name, key)
                folder.mkdir()
                text = pack_spec(file, spec.roots[0].name)
                _, copy = unpack_spec(text, folder)
                self._known[key] = spec, copy
            Rights.of(robot.may).check(self._known[key][0].roots[0])
        except FleetError:
            raise
        except UnknownName as error:
            raise FleetError(f"{place}: may: {error}") from None
        except KeyError as error:
            raise FleetError(f"{place}: {error.args[0]}; choose one with root") from None
        except (UnityLinkError, OSError) as error:
            raise FleetError(f"{place}: {error}") from None
        return self._known[key]
