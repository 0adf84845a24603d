# SPDX-License-Identifier: BSD-3-Clause
"""UL-spec, the specification language: from text to a checked, frozen model. docs/ul-spec.md describes it.

>>> result = compile_text("public led() { @on = 0x10: WRITE(); }", "led.ul")
>>> [(path, hex(element.address)) for path, element in result.spec.walk()]
[('on', '0x10')]
"""

from __future__ import annotations

from .annotation import Annotation
from .compile import Result, compile_file, compile_text, load
from .model import (
    Component,
    Device,
    Element,
    Group,
    Instance,
    Link,
    LinkBinding,
    Member,
    Publish,
    Span,
    Spec,
    SubscriptionGroup,
)
from .report.codes import CODES, Code
from .report.diagnostics import Diagnostic, Fix, Label, render, summary
from .text.format import format_text
from .types import EnumType, EnumValue, Field, ValueType

__all__ = [
    "CODES",
    "Annotation",
    "Code",
    "Component",
    "Device",
    "Diagnostic",
    "Element",
    "EnumType",
    "EnumValue",
    "Field",
    "Fix",
    "Group",
    "Instance",
    "Label",
    "Link",
    "LinkBinding",
    "Member",
    "Publish",
    "Result",
    "Span",
    "Spec",
    "SubscriptionGroup",
    "ValueType",
    "compile_file",
    "compile_text",
    "format_text",
    "load",
    "render",
    "summary",
]
