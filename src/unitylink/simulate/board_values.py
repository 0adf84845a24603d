# SPDX-License-Identifier: BSD-3-Clause
"""The items of a spec from the FPGA's side, by name and in their units."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Element, Spec
from unitylink.spec.report.suggest import nearest
from unitylink.values import Codec, Quantity

from .registers import Registers


class BoardValues:
    """The values that a plant reads and sets: `values["x.position"]` is in the unit of the spec.

    A value beyond the limits of an item is set to the limit, as with a sensor. Raises UnityLinkError for a
    name that the spec does not have, and ValueRangeError for a wrong value.

        values = BoardValues(spec, registers)           # in attach() of a plant
        values["x.position"] = 0.5 * values["x.target"]  # both in rad, as the spec says
    """

    def __init__(self, spec: Spec | None, registers: Registers) -> None:
        self._registers = registers
        self._items: dict[str, tuple[Element, Codec]] = {}
        for path, element in spec.walk() if spec else ():
            quantity = replace(Quantity.of(element), overflow="saturate")
            self._items[path] = element, Codec(path, quantity, registers.data_bits)

    def __getitem__(self, name: str) -> Any:
        element, codec = self._item(name)
        return codec.decode(codec.join([self._registers[address] for address in element.addresses]))

    def __setitem__(self, name: str, value: Any) -> None:
        element, codec = self._item(name)
        for address, word in zip(element.addresses, codec.split(codec.encode(value)), strict=True):
            self._registers[address] = word

    def _item(self, name: str) -> tuple[Element, Codec]:
        try:
            return self._items[name]
        except KeyError:
            near = nearest(name, self._items)
            hint = f"; did you mean {near!r}?" if near else f"; there are {', '.join(self._items) or 'none'}"
            raise UnityLinkError(f"the spec has no item {name!r}{hint}") from None
