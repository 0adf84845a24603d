# SPDX-License-Identifier: BSD-3-Clause
"""The examples in the docstrings of the experiments are true."""

from __future__ import annotations

import doctest
from importlib import import_module
from pkgutil import iter_modules

import pytest

from unitylink_lab import experiments


@pytest.mark.parametrize("name", [module.name for module in iter_modules(experiments.__path__)])
def test_examples(name: str) -> None:
    assert doctest.testmod(import_module(f"{experiments.__name__}.{name}")).failed == 0
