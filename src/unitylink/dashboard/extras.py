# SPDX-License-Identifier: BSD-3-Clause
"""What a dashboard has beside the robot and its spec."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .shelf import Shelf

if TYPE_CHECKING:
    from .body.body import Body


@dataclass(frozen=True)
class Extras:
    """Where recordings are kept, the text of the spec for them, and the shape of the robot, if known."""

    shelf: Shelf = field(default_factory=Shelf)
    text: str = ""
    body: Body | None = None
