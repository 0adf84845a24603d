# SPDX-License-Identifier: BSD-3-Clause
"""The native link, which does the work of this layer: how it is opened, and the types of its arguments and
results.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from unitylink._native import check_link_url, open_link

__all__ = ["Pairs", "Times", "Words", "check_url", "open_link"]

Words = npt.NDArray[np.uint32]
Times = npt.NDArray[np.float64]
Pairs = Iterable[tuple[int, int]] | npt.NDArray[Any]


def check_url(url: str) -> None:
    """Raise UrlError if no link accepts the form or the options of this URL. Opens nothing."""
    check_link_url(url)
