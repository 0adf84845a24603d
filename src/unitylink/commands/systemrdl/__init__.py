# SPDX-License-Identifier: BSD-3-Clause
"""UL-spec from SystemRDL. See README.md."""

from __future__ import annotations

from .read import read_systemrdl
from .write import write_spec

__all__ = ["read_systemrdl", "write_spec"]
