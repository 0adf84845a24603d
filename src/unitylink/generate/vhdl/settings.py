# SPDX-License-Identifier: BSD-3-Clause
"""The settings of a core as VHDL: what `core_settings` of gateware/common/settings_pkg.vhd is given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from unitylink.board_configuration import BoardConfiguration
from unitylink.settings import SETTINGS, Setting

from .plan import Constant, Given

CORE = tuple(setting for setting in SETTINGS.values() if "core" in setting.needed_by)


def settings_of(configuration: BoardConfiguration) -> tuple[Given, ...]:
    """Return every setting of the core that a board configuration has, in the order of the table."""
    told = [setting for setting in CORE if setting.changed_by]
    return tuple(Given(one.name, literal(one, getattr(configuration, one.name)), one.what) for one in told)


def core_settings(changed: Mapping[str, Any]) -> str:
    """Return the expression of the settings that differ from the defaults only in `changed`.

    >>> core_settings({"groups": 4, "protocol": "framed"})
    'core_settings(groups => 4, protocol => protocol_framed)'
    """
    inside = ", ".join(f"{name} => {literal(SETTINGS[name], value)}" for name, value in changed.items())
    return f"core_settings({inside})" if inside else "core_settings"


def safe_values_of(configuration: BoardConfiguration) -> Constant:
    """Return the table of the dead-man."""
    words = [
        f'{n} => (x"{address:08X}", x"{word:08X}")'
        for n, (address, word) in enumerate(configuration.safe_words)
    ]
    kind = f"safe_values_t(0 to {len(words) - 1})" if words else "safe_values_t(1 to 0)"
    return Constant("safe_values", kind, f"({', '.join(words)})" if words else "no_safe_values", "")


def literal(setting: Setting, value: Any) -> str:
    """Return a value of a setting as VHDL writes it."""
    if setting.type == "switch":
        return str(value).lower()
    if setting.type == "choice":
        return f"{setting.name}_{value}"
    if setting.type == "groups":
        return f'x"{sum(1 << group for group in value):064X}"' if value else "(others => '0')"
    if setting.type in ("word", "hash"):
        return f'x"{value:0{8 if setting.type == "word" else 16}X}"'
    return str(value)
