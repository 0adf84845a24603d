# SPDX-License-Identifier: BSD-3-Clause
"""Jobs of several links at the same time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

R = TypeVar("R")


def at_once(links: Iterable[Link], jobs: Sequence[Callable[[], R]]) -> list[R]:
    """Run the jobs of some links at the same time, each in a thread of its own.

    All jobs end before the first error is raised. In steps they run one after another, so that each run is
    the same.
    """
    if len(jobs) <= 1 or any(link.in_steps for link in links):
        return [job() for job in jobs]
    with ThreadPoolExecutor(len(jobs)) as pool:
        return [future.result() for future in [pool.submit(job) for job in jobs]]
