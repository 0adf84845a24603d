# SPDX-License-Identifier: BSD-3-Clause
"""How a fleet starts its bridges: `unitylink bridge zenoh …`, with all imports done once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from unitylink.cli import main
from unitylink.fleet.nursery import Forked

IMPORTS = (
    "unitylink.commands.bridge",
    "unitylink.server.serving",
    "unitylink.simulate.simulated",
    "unitylink.zenoh.bridge.bridge",
    "zenoh",
)


def start_bridge(words: Sequence[str], folder: Path) -> Forked:
    """Start `unitylink WORDS` in a folder."""
    return Forked(main, words, folder, IMPORTS)
