# SPDX-License-Identifier: BSD-3-Clause
"""The settings of a core as VHDL: the arguments of `core_settings` in gateware/common/settings_pkg.vhd."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.settings import SETTINGS, Setting

from ..quoting import Vhdl
from .plan import Constant, Given

CORE = tuple(setting for setting in SETTINGS.values() if "core" in setting.needed_by)


def settings_of(configuration: BoardConfiguration) -> tuple[Given, ...]:
    """Return every setting of the core that a board configuration has, in the order of the table."""
    told = [setting for setting in CORE if setting.changed_by]
    return tuple(Given(one.name, literal(one, getattr(configuration, one.name)), one.what) for one in told)


def core_settings(changed: Mapping[str, Any]) -> Vhdl:
    """Return the VHDL of settings that differ from the defaults only in `changed`.

    >>> core_settings({"groups": 4, "protocol": "framed"})
    'core_settings(groups => 4, protocol => protocol_framed)'
    """
    inside = Vhdl(", ").join(
        Vhdl.of("{} => {}", name, literal(SETTINGS[name], value)) for name, value in changed.items()
    )
    return Vhdl.of("core_settings({})", inside) if inside else Vhdl("core_settings")


def core_settings_of(configuration: BoardConfiguration) -> Vhdl:
    """Return the settings of the core that a board configuration has, as VHDL."""
    return core_settings({one.name: getattr(configuration, one.name) for one in CORE if one.changed_by})


def safe_values_of(configuration: BoardConfiguration) -> Constant:
    """Return the table of words that the dead-man writes."""
    words = [
        Vhdl.of('{} => (x"{:08X}", x"{:08X}")', n, address, word)
        for n, (address, word) in enumerate(configuration.safe_words)
    ]
    if not words:
        return Constant("safe_values", Vhdl("safe_values_t(1 to 0)"), Vhdl("no_safe_values"), "")
    kind = Vhdl.of("safe_values_t(0 to {})", len(words) - 1)
    return Constant("safe_values", kind, Vhdl.of("({})", Vhdl(", ").join(words)), "")


def literal(setting: Setting, value: Any) -> Vhdl:
    """Return a value of a setting as a VHDL literal."""
    if setting.type == "switch":
        return Vhdl.of("{}", str(value).lower())
    if setting.type == "choice":
        return Vhdl.of("{}_{}", setting.name, value)
    if setting.type == "groups":
        mask = sum(1 << group for group in value)
        return Vhdl.of('x"{:064X}"', mask) if value else Vhdl("(others => '0')")
    if setting.type in ("word", "hash"):
        return Vhdl.of('x"{:08X}"' if setting.type == "word" else 'x"{:016X}"', value)
    return Vhdl.of("{}", value)
