# SPDX-License-Identifier: BSD-3-Clause
"""What is compiled: a design with byte streams, and where the words of its user's side stand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Union

from unitylink.board_configuration import BoardConfiguration
from unitylink.generate.vhdl import design_name, generate_vhdl, word_map
from unitylink.spec.model import Spec


@dataclass(frozen=True)
class RtlDesign:
    """An entity `top` and the VHDL that the gateware has not: `files`, name to text.

    Its ports: clock, reset, rx_valid, rx_ready, rx_data, rx_error, tx_valid, tx_ready, tx_data, events (a bit
    a group), read_words and write_words (32 bits an address, in the order of the addresses here). The last
    three may be missing. Further inputs are held low, further outputs ignored.
    """

    top: str
    files: Mapping[str, str] = field(default_factory=dict)
    read_addresses: tuple[int, ...] = ()
    write_addresses: tuple[int, ...] = ()
    generics: Mapping[str, Union[int, str, bool]] = field(default_factory=dict)


def design_of(spec: Spec, configuration: BoardConfiguration) -> RtlDesign:
    """Return the design that `unitylink generate --only vhdl` makes of `spec`; raise BindingError."""
    words = word_map(spec, configuration)
    return RtlDesign(
        top=f"{design_name(spec)}_design",
        files={
            name.rpartition("/")[2]: text
            for name, text in generate_vhdl(spec, configuration).items()
            if name.endswith(("_config_pkg.vhd", "_design.vhd"))  # without what stands around the design
        },
        read_addresses=tuple(words.read),
        write_addresses=tuple(words.write),
        generics={"clock_hz": configuration.clock_hz},
    )


@dataclass(frozen=True)
class RtlModel:
    """A design, compiled: the shared library and where its words stand."""

    library: str
    read_addresses: tuple[int, ...]
    write_addresses: tuple[int, ...]
