# SPDX-License-Identifier: BSD-3-Clause
"""The open links: what happens to them when the program ends or forks."""

from __future__ import annotations

import atexit
import os
import weakref
from typing import Protocol


class OpenLink(Protocol):
    """What a link must be able to do at the end."""

    def close(self) -> None: ...
    def disown(self) -> None: ...


_open: weakref.WeakSet[OpenLink] = weakref.WeakSet()


def remember(link: OpenLink) -> None:
    """Close `link` when the program ends without close()."""
    _open.add(link)
    # The function that is registered last runs first, so this runs before an in-process board is closed.
    atexit.unregister(_close_all)
    atexit.register(_close_all)


def forget(link: OpenLink) -> None:
    """Forget `link`: it is closed, or belongs to another process."""
    _open.discard(link)


def _close_all() -> None:
    """Close all links, so that no device goes on publishing and no thread is left."""
    for link in list(_open):
        link.close()


def _disown_all() -> None:
    """Leave the links to the parent. A forked child has their descriptors, but none of their threads."""
    for link in list(_open):
        link.disown()


os.register_at_fork(after_in_child=_disown_all)
