# SPDX-License-Identifier: BSD-3-Clause
"""What GHDL 2.0 leaves out of small.vhd, and how it is put back. tests/gateware shows the effect."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.errors import ToolError
from unitylink.gateware import Ghdl
from unitylink.gateware.repairs import (
    refuse_verilog_words,
    repaired,
    with_default_arms,
    with_signed_shifts,
    with_sized_constants,
)

SMALL = Path(__file__).with_name("small.vhd")


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    ghdl = Ghdl(tmp_path_factory.mktemp("work"), [SMALL])
    return ghdl.synthesise("small", "verilog"), ghdl.synthesise("small", "vhdl")


def cases(verilog: str) -> list[str]:
    return re.findall(r"case \(.*?endcase", verilog, re.DOTALL)


def test_default_arms_come_back(printed: tuple[str, str]) -> None:
    verilog, vhdl = printed
    assert len(cases(verilog)) == 2
    assert not [case for case in cases(verilog) if "default:" in case], (
        "GHDL has learned it: retire the repair"
    )
    chosen, wide = cases(with_default_arms(verilog, vhdl))
    assert re.search(r"default: \w+ <= word;\n", chosen), "the port itself, not the name it has in the VHDL"
    assert re.search(r"default: \w+ <= 40'b1111111011011100101110101001100001110110;\n", wide)


def test_default_arms_that_are_there_stay(printed: tuple[str, str]) -> None:
    once = with_default_arms(*printed)
    assert with_default_arms(once, printed[1]) == once


def test_unknown_default_arm_is_refused(printed: tuple[str, str]) -> None:
    verilog, vhdl = printed
    with pytest.raises(ToolError, match=r"net 'n\d+_o' of small"):
        with_default_arms(verilog, vhdl.replace("when others", 'when "11"'))
    with pytest.raises(ToolError, match="not understood"):
        with_default_arms(verilog, re.sub(r"\w+ when others", "f(1) when others", vhdl))


def test_every_form_of_a_value() -> None:
    verilog = "module top\n    case (a)\n      2'b10: n1 <= b;\n    endcase\n"
    vhdl = (
        "architecture rtl of top is\n  signal wrap_b: std_logic;\n  signal wrap_c : std_logic;\nbegin\n"
        '  with a select n1 <=\n    b when "10",\n    {} when others;\n'
    )
    for value, expected in {
        "'X'": "1'bx",
        "'1'": "1'b1",
        '"01-U"': "4'b01xx",
        "(31 downto 0 => 'X')": "{32{1'bx}}",
        "n12_o": "n12_o",
        "wrap_b": "b",
        "wrap_c": "wrap_c",
    }.items():
        assert f"default: n1 <= {expected};\n" in with_default_arms(verilog, vhdl.replace("{}", value))


def test_the_same_net_name_in_two_modules() -> None:
    """GHDL numbers nets for each design, but the name of a signal can come again in the next module."""
    verilog = "".join(
        f"module {name}\n    case (a)\n      2'b10: sum <= b;\n    endcase\n" for name in ("top", "part_8")
    )
    arms = "begin\n  with a select sum <=\n    b when \"10\",\n    '{}' when others;\n"
    # GHDL declares the top entity first and defines it last.
    vhdl = (
        "entity top is\nend entity;\nentity part_8 is\nend entity;\n"
        f"architecture rtl of part_8 is\n{arms.format(0)}architecture rtl of top is\n{arms.format(1)}"
    )
    top, part = cases(with_default_arms(verilog, vhdl))
    assert "default: sum <= 1'b1;" in top
    assert "default: sum <= 1'b0;" in part


def test_wide_constants_become_numbers(printed: tuple[str, str]) -> None:
    verilog, _ = printed
    assert '"0001001000110100010101100111100010011010"' in verilog, "GHDL has learned it: retire the repair"
    mended = with_sized_constants(verilog)
    assert '"' not in mended
    assert "40'b0001001000110100010101100111100010011010" in mended


def test_texts_stay() -> None:
    text = 'if (!n1) $fatal(1, "assertion failure n1744");'
    assert with_sized_constants(text) == text


def test_constant_of_no_bits() -> None:
    assert with_sized_constants("localparam n25_o = 0'bZ;") == "localparam n25_o = 1'b0;"


def test_constants_that_ghdl_makes_zero(tmp_path: Path) -> None:
    """This cannot be repaired, because it is lost before anything is printed.

    The gateware avoids it (register_slave.vhd).
    """
    source = SMALL.read_text().replace("39 downto 0", "63 downto 0")
    source = source.replace('x"123456789A"', 'x"8000000100000000"').replace(
        'x"FEDCBA9876"', 'x"8000000100000001"'
    )
    (tmp_path / "small.vhd").write_text(source)
    printed = Ghdl(tmp_path, [tmp_path / "small.vhd"]).synthesise("small", "vhdl")
    assert f"{0x8000000100000001:064b}" in printed
    assert f"{0x8000000100000000:064b}" not in printed, "GHDL has learned it: the gateware need not avoid it"


SHIFT = """
library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
entity shift is
  port (a : in std_ulogic_vector(15 downto 0); y, z : out std_ulogic_vector(15 downto 0));
end entity;
architecture rtl of shift is
begin
  y <= std_ulogic_vector(shift_right(signed(a), 2));
  z <= std_ulogic_vector(shift_right(unsigned(a), 2));
end architecture;
"""


def test_signed_shifts_keep_their_sign(tmp_path: Path) -> None:
    (tmp_path / "shift.vhd").write_text(SHIFT)
    printed = Ghdl(tmp_path, [tmp_path / "shift.vhd"]).synthesise("shift", "verilog")
    assert "$signed(a) >> 31'b" in printed, "GHDL has learned it: retire the repair"
    mended = with_signed_shifts(printed)
    assert "$signed(a) >>> 31'b" in mended
    assert mended.replace(">>>", ">>") == printed and "= a >> 31'b" in mended


def test_words_of_verilog_are_refused() -> None:
    vhdl = "entity t is\n  port (\n    wire : in std_logic;\n    b : out bit);\n  signal reg : std_logic;\n"
    with pytest.raises(ToolError, match=r"reg, wire: a word of Verilog"):
        refuse_verilog_words(vhdl)
    with pytest.raises(ToolError, match=r"design: a word of Verilog"):
        refuse_verilog_words("begin\n  design : entity work.inner port map (\n")


def test_repaired_does_all(printed: tuple[str, str]) -> None:
    mended = repaired(*printed)
    assert mended.count("default:") == 2
    assert '"' not in mended
