# SPDX-License-Identifier: BSD-3-Clause
"""Packages whose names are imported when they are first used, so that a command loads only what it needs."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module


def load_name(package: str, homes: Mapping[str, str], name: str) -> object:
    """Import `name` of a package from its module in `homes` and keep it.

    "" stands for a module with the name itself.

    A package calls this from its `__getattr__`. Raises AttributeError for a name that is not in `homes`.
    """
    if name not in homes:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    module = import_module(f"{package}.{homes[name] or name}")
    value = getattr(module, name) if homes[name] else module
    setattr(sys.modules[package], name, value)
    return value
