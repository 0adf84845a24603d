# SPDX-License-Identifier: BSD-3-Clause
"""The boxes of the screen: a value, a question, a text. The stop works while they are open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import click
from textual.binding import Binding
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from unitylink.errors import UnityLinkError
from unitylink.values import format_value

from ..names import Item
from ..value_text import parse_value

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from unitylink.layer4_data import WriteValue
    from unitylink.spec.model import Element

_BOX = """{ align: center middle; }
#box { width: 76; height: auto; max-height: 22; padding: 0 1; }"""


class ValueBox(ModalScreen["tuple[Any, str] | None"]):
    """Asks for the value of an item. The result is the value and its text, or None."""

    DEFAULT_CSS = f"ValueBox {_BOX}"
    BINDINGS: ClassVar[list[Any]] = [Binding("escape", "dismiss(None)", priority=True)]

    def __init__(self, element: Element, value: WriteValue[Any]) -> None:
        super().__init__()
        self._element, self._value = element, value

    def compose(self) -> ComposeResult:
        with Vertical(id="box"):
            yield Static(f"{self._element.path}: {allowed(self._element, self._value)}", markup=False)
            yield _Line(placeholder="new value, then Enter; Escape leaves", compact=True)
            yield Static("", id="mistake", markup=False)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        text = event.value.strip()
        try:
            item = Item(self._element.path, self._element.address, self._element)
            value = parse_value(text, item)
            self._value.encode(value)
        except click.UsageError as error:
            self._mistake(error.message)
        except UnityLinkError as error:
            self._mistake(str(error))
        else:
            self.dismiss((value, text))

    def _mistake(self, text: str) -> None:
        self.query_one("#mistake", Static).update(text)


class _Line(Input):
    """A line to type in. It leaves the space bar to the stop."""

    def check_consume_key(self, key: str, character: str | None) -> bool:
        return key != "space" and super().check_consume_key(key, character)


class Question(ModalScreen[bool]):
    """Asks a question. Only the key y means yes."""

    DEFAULT_CSS = f"Question {_BOX}"
    BINDINGS: ClassVar[list[Any]] = [
        Binding("y", "dismiss(True)"),
        Binding("n,escape,enter", "dismiss(False)"),
    ]

    def __init__(self, question: str) -> None:
        super().__init__()
        self._question = question

    def compose(self) -> ComposeResult:
        with Vertical(id="box"):
            yield Static(f"{self._question}\n\ny yes   n no", markup=False)


class TextBox(ModalScreen[None]):
    """Shows a text, the end of it first. Any of the usual keys closes it."""

    DEFAULT_CSS = f"TextBox {_BOX}"
    BINDINGS: ClassVar[list[Any]] = [Binding("escape,enter,q,l,question_mark", "dismiss(None)")]

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text

    def compose(self) -> ComposeResult:
        with VerticalScroll(id="box"):
            yield Static(self._text, markup=False)

    def on_mount(self) -> None:
        self.query_one("#box", VerticalScroll).scroll_end(animate=False)


def allowed(element: Element, value: WriteValue[Any]) -> str:
    """Return what may be written to an item, as text."""
    kind = element.type.kind
    if element.type.enum is not None:
        return " | ".join(one.name for one in element.type.enum.values)
    if kind == "bool":
        return "on | off"
    if kind == "bits":
        return "{" + ", ".join(f"{field.name}=…" for field in element.type.fields) + "} or a number"
    unit = f" {element.unit}" if element.unit else ""
    return f"{format_value(value.minimum)} to {format_value(value.maximum)}{unit}"
