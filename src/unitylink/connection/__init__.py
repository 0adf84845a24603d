# SPDX-License-Identifier: BSD-3-Clause
"""From a link URL to a Link: the table of schemes, `connect(url)` and `open_driver(url)`.

Names are loaded when they are first used: the command line reads the table without the native core.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.lazy import load_name

if TYPE_CHECKING:
    from .opening import check_link, connect, open_driver

__all__ = ["check_link", "connect", "open_driver"]

_HOMES = dict.fromkeys(__all__, "opening")


def __getattr__(name: str) -> object:
    return load_name(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
