# SPDX-License-Identifier: BSD-3-Clause
"""A robot in a notebook. See README.md.

>>> import unitylink.jupyter
>>> unitylink.jupyter.live(robot.j1.cpos, robot.j2)  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from unitylink.optional import absent

if TYPE_CHECKING:
    from .chart import Chart

__all__ = ["live"]


def live(*values: Any, window_s: float = 20.0, rate_hz: float = 10.0) -> Chart:
    """Return a widget that draws values as they come.

    `values` are values that the PC reads, or parts, groups and arrays of them. Publishing starts as with
    `on_publish`. Values without PUBLISH in the spec are read at `rate_hz`. The chart shows the last
    `window_s` seconds. It ends with `close()`, or with the link.

    Raises ValueRangeError for something that cannot be drawn, and ToolError if anywidget is absent.

    >>> chart = live(robot.j1.cpos, window_s=5)  # doctest: +SKIP
    """
    try:
        import anywidget  # noqa: F401
    except ImportError:
        raise absent("anywidget", "a live chart") from None
    from .chart import Chart

    return Chart(values, window_s, rate_hz)
