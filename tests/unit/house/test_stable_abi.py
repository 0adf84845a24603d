# SPDX-License-Identifier: BSD-3-Clause
"""From Python 3.12 on, one wheel is for all versions. So the module uses the stable ABI of Python alone."""

from __future__ import annotations

import re

from unit.house.files import ROOT, text

# What the headers of Python give only to a module that is for one version: macros that look into objects, and
# what begins with an underscore.
INSIDE = re.compile(
    r"\b(?:Py(?:Tuple|List|Sequence_Fast|Sequence|Bytes|Float|Unicode)_(?:[SG]ET_\w+|AS_\w+|ITEMS)|_Py\w+)\("
)


def test_the_module_looks_into_no_object_of_python() -> None:
    for path in (ROOT / "native" / "python").glob("*.?pp"):
        source = path.read_text("utf-8")
        # what is compiled for one version only
        shared = re.sub(r"^#elif PY_VERSION_HEX.*?^#endif", "", source, flags=re.M | re.S)
        assert not INSIDE.findall(shared), path.name
    assert INSIDE.search("PySequence_Fast_GET_SIZE(x)") and INSIDE.search("PyTuple_SET_ITEM(x)")


def test_the_wheel_says_so() -> None:
    assert 'wheel.py-api = "cp312"' in text("pyproject.toml") and "STABLE_ABI" in text("CMakeLists.txt")
