# SPDX-License-Identifier: BSD-3-Clause
"""Which ports there are, what answers on them, and what is wrong with them.

>>> from unitylink.ports import FINDINGS
>>> FINDINGS["silence"].title
'Nothing answers'
"""

from __future__ import annotations

from .doctor import examine
from .findings import FINDINGS, Finding, FindingKind
from .machine import Holder, Machine, SerialPort
from .probe import Answer, probe

__all__ = [
    "FINDINGS",
    "Answer",
    "Finding",
    "FindingKind",
    "Holder",
    "Machine",
    "SerialPort",
    "examine",
    "probe",
]
