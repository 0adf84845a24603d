# SPDX-License-Identifier: BSD-3-Clause
"""The VHDL file that `@source("stepper.vhd")` names for a component.

It is below the folder of the file in UL-spec. A spec may come from anywhere, so a name never leads out of
there: it is relative, has no `..`, and no symbolic link leads elsewhere.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from ..report.diagnostics import Reporter
from ..text.imports import is_below
from ..text.syntax import Argument

_FILE = re.compile(r"[A-Za-z0-9_][\w. -]*\.vhdl?", re.ASCII | re.IGNORECASE)


def find_source(name: str, argument: Argument, reporter: Reporter) -> str | None:
    """Return the path of the file `name`. Return None after a diagnostic."""
    place = argument.start, argument.end
    folder = Path(reporter.sources.at(argument.start).file).parent
    if not is_below(name) or not _FILE.fullmatch(name.rpartition("/")[2]):
        message = f"{name[:80]!r} is not the name of a VHDL file below the spec's folder"
        hint = 'write it relative to this file, such as `@source("parts/stepper.vhd")`, without `..`'
        reporter.report("UL044", *place, message, hint)
        return None
    path = folder / name
    try:
        there, real = path.is_file(), Path(os.path.realpath(path))
    except (OSError, ValueError):  # the name is too long for the operating system
        there = False
    if not there:
        hint = f"it was looked for in `{folder}`, where the file in UL-spec is"
        reporter.report("UL042", *place, f"there is no file `{name[:80]}`", hint)
        return None
    if not real.is_relative_to(os.path.realpath(folder)):
        message = f"`{name}` is a symbolic link that leads to `{real}`"
        reporter.report("UL044", *place, message, "put the file itself there")
        return None
    return str(path)
