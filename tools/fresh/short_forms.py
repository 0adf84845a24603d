# SPDX-License-Identifier: BSD-3-Clause
"""The targets of `make help`, each with the variables of its short form: full set-up, little work."""

from __future__ import annotations

import re

SHORT_FORMS = {
    "demo": "",
    "demo-walker": "RTL=1",  # what the gateware's own VHDL needs, too
    "demo-pa10": "",
    "demo-learn": "",
    "demo-tosnet": "",
    "demo-ros": "",
    "demo-serve": "SECONDS=3",
    "demo-fleet": "SECONDS=15",
    "page": "CHECK=1",
    "extras": "",
    "test": "TESTS=tests/unit/values",
    "develop": "",
    "check": "",
    "format": "",
    "bench": "QUICK=1",
    "experiments": "QUICK=1 ONLY=simplicity",
    "experiments-json": "",
    "docs": "",
    "coverage": "BENCHES=gpio",
    "synth": "ROWS=lite",
    "bitstreams": "ONLY=icebreaker",
    "formal": "BLOCKS=fifo",
    "boards": "",
    "fuzz": "SECONDS=2 STRINGS=20000 MESSAGES=1000",
    "sanitize": "KINDS=thread",
    "lerobot": "",
    "soak": "MESSAGES=200000",
    "mutants": "SAMPLE=3",
    "wheel": "",
    "packages": "",
    "sbom": "",
    "build": "",
    "long": "TESTS=tests/gateware/test_own_core.py",
    "unit": "",
    "native-tests": "",
    "clean": "",
    "fresh": "TARGETS=clean",
}


def targets(told: str) -> list[str]:
    """Return the targets that the text of `make help` names, in its order.

    >>> targets("make demo    a robot moves; make soak: for hours, as `make demo` does")
    ['demo', 'soak']
    """
    return list(dict.fromkeys(re.findall(r"\bmake ([a-z][a-z0-9-]*)", told)))
