# SPDX-License-Identifier: BSD-3-Clause
"""Virtual boards: the twin of the gateware, with a plant that moves behind its registers."""

from __future__ import annotations

from unitylink.interface.board_configuration import (
    BoardConfiguration,
    DoubleBufferConfiguration,
    FifoConfiguration,
    TosnetConfiguration,
    TosnetNode,
)

from .board import Board, BoardStatistics
from .board_values import BoardValues
from .components import BoardComponent, BoardComponents
from .plant import DEFAULT_PLANT, PLANTS, Plant, load_plant
from .plants import Echo, LoopbackPlant, Ramp, RampPlant, ScaraPlant, WordPlant
from .registers import Registers
from .simulated import simulated_board
from .state import BoardState

__all__ = [
    "DEFAULT_PLANT",
    "PLANTS",
    "Board",
    "BoardComponent",
    "BoardComponents",
    "BoardConfiguration",
    "BoardState",
    "BoardStatistics",
    "BoardValues",
    "DoubleBufferConfiguration",
    "Echo",
    "FifoConfiguration",
    "LoopbackPlant",
    "Plant",
    "Ramp",
    "RampPlant",
    "Registers",
    "ScaraPlant",
    "TosnetConfiguration",
    "TosnetNode",
    "WordPlant",
    "load_plant",
    "simulated_board",
]
