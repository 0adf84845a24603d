# SPDX-License-Identifier: BSD-3-Clause
"""What a control loop asks of a link in each turn. Each is one call of the native core."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from unitylink._native import NativeLink

COMMIT_LOOKS = 8  # one is enough if the network's cycle is short


class LinkLoop:
    """The part of a `Link` for loops. The same bytes travel as with single calls, and less time is lost."""

    _native: NativeLink

    def sample(
        self,
        addresses: Sequence[int],
        *,
        atomic: bool = False,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> tuple[float, list[int]]:
        """Return the time in the middle of a read, and the words, as `read_many` reads them."""
        return self._native.sample(addresses, atomic, checked, repeat, timeout_s)

    def commit(
        self,
        addresses: Sequence[int],
        words: Sequence[int],
        commit: int,
        pending: tuple[int, int],
        *,
        timeout_s: float | None = None,
    ) -> int:
        """Write words, then 1 to `commit`, in one message. Return the word that is read there.

        `pending` are a mask and the bits that say that the commit waits. Then the link looks again, a few
        times, and returns what it has seen last. It does not wait for ever. Raises as `exchange` does.
        """
        mask, waiting = pending
        return self._native.commit(addresses, words, commit, mask, waiting, COMMIT_LOOKS, timeout_s)
