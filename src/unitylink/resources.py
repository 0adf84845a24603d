# SPDX-License-Identifier: BSD-3-Clause
"""The places of the VHDL, the components and the examples, in a checkout or in a wheel."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from unitylink.errors import ToolError

_PACKAGE = Path(__file__).resolve().parent


def cache_folder(name: str) -> Path:
    """Return the folder of a cache: $XDG_CACHE_HOME/unitylink/`name`, or else below ~/.cache."""
    base = os.environ.get("XDG_CACHE_HOME") or ""
    return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "unitylink" / name


@cache
def resource_folder(name: str) -> Path:
    """Return the folder called `name` ("gateware", "components", "examples").

    Raises ToolError if this installation does not have it.

    >>> (resource_folder("examples") / "scara" / "scara.ul").is_file()
    True
    """
    for root in (_PACKAGE.parents[1], _PACKAGE / "share"):
        folder = root / name
        if folder.is_dir() and (root.name == "share" or (root / "pyproject.toml").is_file()):
            return folder
    raise ToolError(
        f"the folder {name}/ did not come with this installation ({_PACKAGE}); "
        "install a wheel of Unity-Link, or a checkout with `pip install --editable`"
    )
