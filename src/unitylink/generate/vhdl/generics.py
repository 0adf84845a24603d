# SPDX-License-Identifier: BSD-3-Clause
"""The generics of a design's core, as constants of its package."""

from __future__ import annotations

from unitylink.board_configuration import BoardConfiguration
from unitylink.errors import BindingError

from .plan import Constant

# What the memory of the framed application holds: so many of each, together.
_EXCHANGES_MOST = 2
_EXCHANGE_SIZE_MOST = 30
_GROUPS_MOST = 128
_SAFE_WORDS_MOST = 64


def generics_of(configuration: BoardConfiguration) -> tuple[Constant, ...]:
    """Return the generics of the core, under their own names."""
    edges = sum(1 << group for group in configuration.edge_event_groups)
    events = f'x"{edges:064X}"' if edges else "(others => '0')"
    switch = str(configuration.configuration_command).lower()
    modes = "0 none, 1 requests first, 2 publishes first"
    return (
        Constant("address_width", "positive", str(configuration.address_bits), "bits"),
        Constant("data_width", "positive", str(configuration.data_bits), "bits"),
        Constant("base_hz", "positive", str(configuration.base_hz), "of publishing"),
        Constant("groups", "positive", str(configuration.groups), "of publishing"),
        Constant("group_size", "positive", str(configuration.group_size), "addresses a group can have"),
        Constant("rate_bytes", "positive", str(configuration.rate_bytes), "of a group's divisor"),
        Constant("read_many", "natural", str(configuration.read_many), "most words of a read-many"),
        Constant("publish_mode", "natural", str(configuration.publish_mode), modes),
        Constant("configuration_command", "boolean", switch, "RLC exists"),
        Constant("datalink", "string", f'"{configuration.datalink}"', "full, lite or none"),
        Constant("checksum", "string", f'"{configuration.checksum}"', ""),
        Constant("polynomial", "natural", f"16#{configuration.polynomial:02X}#", "of crc8"),
        Constant(
            "edge_events", "std_ulogic_vector(255 downto 0)", events, "bit g: group g by edge, not level"
        ),
        *(() if configuration.protocol == "classic" else _framed_generics(configuration)),
    )


def _framed_generics(configuration: BoardConfiguration) -> tuple[Constant, ...]:
    """Return the generics of the framed side; as many exchange groups as fit its memory."""
    framed = configuration.framed
    if configuration.groups > _GROUPS_MOST:
        raise BindingError(
            f"vhdl: the spec has {configuration.groups} publish groups; the gateware's framed side holds "
            f"{_GROUPS_MOST}: give it fewer, or choose classic"
        )
    if len(framed.safe_words) > _SAFE_WORDS_MOST:
        raise BindingError(
            f"vhdl: the spec has {len(framed.safe_words)} words with safe values; "
            f"the gateware's dead-man holds {_SAFE_WORDS_MOST}: give fewer a SAFE, or choose classic"
        )
    words = [
        f'{n} => (x"{address:08X}", x"{word:08X}")' for n, (address, word) in enumerate(framed.safe_words)
    ]
    table = f"safe_values_t(0 to {len(words) - 1})" if words else "safe_values_t(1 to 0)"
    return (
        Constant("protocol", "string", f'"{configuration.protocol}"', "classic, framed or both"),
        Constant("exchanges", "natural", str(min(framed.exchanges, _EXCHANGES_MOST)), "exchange groups"),
        Constant(
            "exchange_size", "natural", str(min(framed.exchange_size, _EXCHANGE_SIZE_MOST)), "words in one"
        ),
        Constant("window", "positive", str(framed.window), "requests in flight"),
        Constant(
            "safe_values", table, f"({', '.join(words)})" if words else "no_safe_values", "of the dead-man"
        ),
        Constant("gateware_version", "word32_t", f'x"{framed.gateware_version:08X}"', ""),
        Constant("build", "word32_t", f'x"{framed.build:08X}"', ""),
        Constant(
            "wire_hash",
            "std_ulogic_vector(63 downto 0)",
            f'x"{framed.spec_hash:016X}"',
            "of what reaches the wire",
            "spec_hash",
        ),
    )
