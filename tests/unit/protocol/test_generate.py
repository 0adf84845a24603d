# SPDX-License-Identifier: BSD-3-Clause
"""protocol.toml and the files generated from it agree, and the generated code works."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from unitylink import protocol

ROOT = Path(__file__).resolve().parents[3]


def test_generated_files_are_fresh() -> None:
    result = subprocess.run(
        [sys.executable, "protocol/generate.py", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout


def test_unknown_argument_is_a_usage_error() -> None:
    result = subprocess.run(
        [sys.executable, "protocol/generate.py", "--frob"], cwd=ROOT, capture_output=True, check=False
    )
    assert result.returncode == 2


def test_crc_check_value() -> None:
    """The polynomial gives the catalogued check value of CRC-8/SMBUS."""
    value = protocol.CRC8_INITIAL
    for byte in b"123456789":
        value ^= byte
        for _ in range(8):
            value = ((value << 1) ^ (protocol.CRC8_POLYNOMIAL if value & 0x80 else 0)) & 0xFF
    assert value == protocol.CRC8_CHECK


def test_cpp_constants_compile(tmp_path: Path) -> None:
    source = tmp_path / "use.cpp"
    source.write_text(
        '#include "unitylink/protocol.hpp"\n'
        f"static_assert(unitylink::protocol::crc8::check == {protocol.CRC8_CHECK});\n"
        f"static_assert(unitylink::protocol::bytes::line_feed == {protocol.BYTE_LINE_FEED});\n"
        f'static_assert(unitylink::protocol::reply::publish == "{protocol.REPLY_PUBLISH}");\n'
    )
    subprocess.run(
        [
            "c++",
            "-std=c++20",
            "-Wall",
            "-Werror",
            "-fsyntax-only",
            f"-I{ROOT / 'native' / 'include'}",
            str(source),
        ],
        check=True,
    )


def test_vhdl_constants_compile_and_agree(tmp_path: Path) -> None:
    bench = tmp_path / "bench.vhd"
    bench.write_text(
        "library ieee;\nuse ieee.std_logic_1164.all;\nuse work.protocol_pkg.all;\n"
        "entity bench is end entity;\narchitecture sim of bench is\nbegin\n"
        f'  assert crc8_polynomial_c = x"{protocol.CRC8_POLYNOMIAL:02X}" severity failure;\n'
        f"  assert limits_group_size_max_c = {protocol.GROUP_SIZE_MAX} severity failure;\n"
        f'  assert reply_publish_c = "{protocol.REPLY_PUBLISH}" severity failure;\n'
        "end architecture;\n"
    )
    package = ROOT / "gateware" / "common" / "protocol_pkg.vhd"
    for command in (
        ["-a", "--std=08", str(package), str(bench)],
        ["-e", "--std=08", "bench"],
        ["-r", "--std=08", "bench"],
    ):
        subprocess.run(["ghdl", *command], cwd=tmp_path, check=True)


@pytest.mark.parametrize("code", sorted(protocol.APPLICATION_ERRORS))
def test_application_error_codes_have_the_wire_form(code: str) -> None:
    assert len(code) == 5 and code.startswith("E_")
