# SPDX-License-Identifier: BSD-3-Clause
"""Makes once for a spec what several artefacts need."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from unitylink.spec.model import Spec

R = TypeVar("R")


def kept(function: Callable[[Spec], R]) -> Callable[[Spec], R]:
    """Keep the result of `function` for the last spec, as long as that spec lives. It must not be changed."""
    last: list[tuple[weakref.ref[Spec], R]] = []

    @wraps(function)
    def once(spec: Spec) -> R:
        for of, result in last:
            if of() is spec:
                return result
        result = function(spec)
        last[:] = [(weakref.ref(spec, lambda _: last.clear()), result)]
        return result

    return once
