# SPDX-License-Identifier: BSD-3-Clause
"""The error for the absence of a package that only some commands need."""

from __future__ import annotations

import re
import shlex
import sys
from importlib import metadata
from pathlib import Path

from unitylink.errors import ToolError

_CHECKOUT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def absent(package: str, what: str) -> ToolError:
    """Return the error that `what` needs `package`.

    It has the command that installs the package into this Python.

    >>> print(absent("mcap", "an MCAP file"))  # doctest: +ELLIPSIS
    an MCAP file needs the package mcap: ... -m pip install 'mcap...'...
    """
    everything = "; for all optional packages at once: make extras" if _CHECKOUT.is_file() else ""
    return ToolError(f"{what} needs the package {package}: {installation(package)}{everything}")


def installation(package: str) -> str:
    """Return the command that installs a package for this Python."""
    return f"{shlex.quote(sys.executable)} -m pip install '{requirement(package)}'"


def requirement(package: str) -> str:
    """Return the package with the versions that our extras require, or only its name.

    >>> requirement("some_other_package")
    'some_other_package'
    """
    try:
        wanted = metadata.requires("unitylink") or []
    except metadata.PackageNotFoundError:  # this is only the source, without an installation
        wanted = []
    for line in wanted:
        named = line.partition(";")[0].strip()
        if re.split(r"[^A-Za-z0-9._-]", named, maxsplit=1)[0].replace("_", "-") == package.replace("_", "-"):
            return named
    return package
