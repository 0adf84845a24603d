# SPDX-License-Identifier: BSD-3-Clause
"""What a dashboard has beside the robot and its spec."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .shelf import Shelf

if TYPE_CHECKING:
    from .body.body import Body


@dataclass(frozen=True)
class Extras:
    """Where recordings are kept, the text of the spec for them, and the shape of the robot, if known.

    `report` gives the state of the server that the page belongs to, if there is one.
    """

    shelf: Shelf = field(default_factory=Shelf)
    text: str = ""
    body: Body | None = None
    report: Callable[[], Mapping[str, Any]] | None = None
