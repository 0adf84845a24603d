# SPDX-License-Identifier: BSD-3-Clause
"""A core with the small engine in the bench replay_tb."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reference.settings import Settings

from unitylink.interface.board_configuration import BoardConfiguration

BAD = 0x38  # four addresses answer with an error, and the next four do not answer
SILENCE = 3000  # clocks; longer than any pause within the answers to a step, if no counters are read


def core_of(settings: Settings) -> tuple[BoardConfiguration, dict[str, Any]]:
    """Return the configuration for the player, and the other generics of the bench."""
    configuration = BoardConfiguration(
        address_bits=8 * settings.a,
        data_bits=8 * settings.d,
        base_hz=settings.base_hz,
        groups=max(1, settings.groups),
        group_size=max(1, settings.group_size),
    )
    generics = {"engine": "small", "protocol": "framed", "lists": False, "exchanges": 0, "recorded": 0}
    generics |= {"publish_mode": 2 if settings.groups else 0, "window": settings.window, "bad_base": BAD}
    return configuration, generics


def play(
    rtl: Any, settings: Settings, steps: Sequence[Any], *, silence: int = SILENCE, **generics: Any
) -> list[bytes]:
    """Return what the core answers to each step.

    A step is bytes, sent until all is quiet, or a step of the bench.
    """
    configuration, own = core_of(settings)
    exchanges = [
        [("send", step.decode("latin-1")), ("quiet", silence)] if isinstance(step, bytes) else [step]
        for step in steps
    ]
    answers: list[bytes] = rtl(configuration, exchanges, **{**own, **generics})
    return answers
