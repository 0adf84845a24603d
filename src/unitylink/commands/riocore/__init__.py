# SPDX-License-Identifier: BSD-3-Clause
"""UL-spec from a configuration of riocore. See README.md."""

from __future__ import annotations

from .write import import_riocore

__all__ = ["import_riocore"]
