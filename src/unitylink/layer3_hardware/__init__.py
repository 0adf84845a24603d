# SPDX-License-Identifier: BSD-3-Clause
"""Layer 3: one proxy for each kind of gateware module. Addresses are relative to the module."""

from __future__ import annotations

from .committed import CommittedProxy
from .double_buffer import DoubleBufferProxy
from .fifo import FifoProxy, FifoStatus
from .interrupt import InterruptProxy
from .memory import MemoryProxy
from .proxy import HardwareProxy
from .tosnet import TosNetNode, TosNetProxy, TosNetRegister, TosNetWords
from .tosnet_events import NetworkEvent, NetworkWatch
from .tosnet_status import NetworkNode, TosNetCounters, TosNetStatus

__all__ = [
    "CommittedProxy",
    "DoubleBufferProxy",
    "FifoProxy",
    "FifoStatus",
    "HardwareProxy",
    "InterruptProxy",
    "MemoryProxy",
    "NetworkEvent",
    "NetworkNode",
    "NetworkWatch",
    "TosNetCounters",
    "TosNetNode",
    "TosNetProxy",
    "TosNetRegister",
    "TosNetStatus",
    "TosNetWords",
]
