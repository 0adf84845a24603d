# SPDX-License-Identifier: BSD-3-Clause
"""Things that only a checkout of the source has: the package `unitylink_lab`, which measures Unity-Link
itself.
"""

from __future__ import annotations

from importlib.util import find_spec

from .failure import Failure

CHECKOUT_NEEDED = "needs a checkout of the source, which this installation is not; run it there"


def in_checkout() -> bool:
    """Tell whether this installation is a checkout. A wheel has no `unitylink_lab`."""
    return find_spec("unitylink_lab") is not None


def need_checkout(what: str) -> None:
    """Raises Failure in an installed wheel. `what` names what the user asked for."""
    if not in_checkout():
        raise Failure(f"{what} {CHECKOUT_NEEDED}", "clone the project and run `make build` in it")
