# SPDX-License-Identifier: BSD-3-Clause
"""Write protocol.toml for Python, C++, VHDL and the documentation: its constants, and the table of settings.

    python protocol/generate.py            write what is stale
    python protocol/generate.py --check    write nothing, name what is stale, exit 1 if anything is

There is one function for each artefact. It takes the table and returns a text, so the same input gives the
same bytes.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import settings

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "protocol" / "protocol.toml"
NOTE = "Generated from protocol/protocol.toml by protocol/generate.py; edit there."

Table = dict[str, Any]

HEXADECIMAL = (
    "crc8",
    "datalink_error",
    "tosnet",
    "tosnet_wire",
    "request_kind",
    "device_kind",
    "list_operation",
    "control",
    "control_value",
)


def read_table() -> Table:
    return tomllib.loads(SOURCE.read_text(encoding="utf-8"))


def python_text(table: Table) -> str:
    lines = [
        "# SPDX-License-Identifier: BSD-3-Clause",
        f'"""The constants of the wire protocols.\n\n{NOTE}\n"""',
        "",
        "from __future__ import annotations",
        "",
        "from types import MappingProxyType",
        "from typing import Final",
        "",
    ]

    def constant(name: str, value: object) -> None:
        lines.append(f"{name}: Final = {python_literal(value)}")

    for key, value in table["protocol"].items():
        constant(key.upper(), value)
    for section, values in table.items():
        if section == "protocol" or isinstance(next(iter(values.values())), dict):
            continue
        lines.append("")
        prefix = "" if section == "limits" else f"{'byte' if section == 'bytes' else section}_".upper()
        for key, value in values.items():
            constant(prefix + key.upper(), value)
    for section, title in (
        ("application_error", "APPLICATION_ERRORS"),
        ("datalink_error", "DATALINK_ERRORS"),
    ):
        lines += ["", f"{title}: Final = MappingProxyType(", "    {"]
        lines += [
            f"        {python_literal(e['code'])}: {python_literal(e['meaning'])},"
            for e in table[section].values()
        ]
        lines += ["    }", ")"]
        for key, entry in table[section].items():
            constant(f"{section.upper()}_{key.upper()}", entry["code"])
    return "\n".join(lines) + "\n"


def python_literal(value: object) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    assert isinstance(value, int)
    return str(value)


def cpp_text(table: Table) -> str:
    lines = [
        "// SPDX-License-Identifier: BSD-3-Clause",
        f"// The constants of the wire protocols. {NOTE}",
        "#pragma once",
        "",
        "#include <cstdint>",
        "#include <string_view>",
        "",
        "namespace unitylink::protocol {",
        "",
    ]
    for section, values in table.items():
        if section in ("application_error", "datalink_error"):
            lines.append(f"namespace {section} {{")
            for key, entry in values.items():
                typed = cpp_typed(key, entry["code"], "std::uint8_t")
                lines.append(f"inline constexpr {typed};  // {entry['meaning']}")
            lines += [f"}}  // namespace {section}", ""]
            continue
        kind = {"bytes": "char", "crc8": "std::uint8_t"}.get(section, "std::uint32_t")
        namespace = "version" if section == "protocol" else section
        lines.append(f"namespace {namespace} {{")
        lines += [f"inline constexpr {cpp_typed(key, value, kind)};" for key, value in values.items()]
        lines += [f"}}  // namespace {namespace}", ""]
    lines.append("}  // namespace unitylink::protocol")
    return "\n".join(lines) + "\n"


def cpp_typed(name: str, value: object, kind: str) -> str:
    if isinstance(value, str):
        return f'std::string_view {name} = "{value}"'
    return f"{kind} {name} = {f'0x{value:02X}' if kind in ('char', 'std::uint8_t') else value}"


def vhdl_text(table: Table, package: str = "protocol_pkg") -> str:
    lines = [
        "-- SPDX-License-Identifier: BSD-3-Clause",
        f"-- The constants of the wire protocols. {NOTE}",
        "library ieee;",
        "use ieee.std_logic_1164.all;",
        "",
        f"package {package} is",
    ]
    if package == "protocol_pkg":
        lines += ["", "  subtype byte_t is std_logic_vector(7 downto 0);"]
    for section, values in table.items():
        lines += ["", f"  -- {section}"]
        for key, raw in values.items():
            value = raw["code"] if isinstance(raw, dict) else raw
            name = f"{section.rstrip('s') if section == 'bytes' else section}_{key}_c"
            if isinstance(value, str):
                kind, text = "string", f'"{value}"'
            elif section in ("bytes", "crc8", "datalink_error"):
                kind, text = "byte_t", f'x"{value:02X}"'
            elif value >= 2**31:  # too large for the type natural
                kind, text = "std_logic_vector(31 downto 0)", f'x"{value:08X}"'
            else:
                kind, text = "natural", str(value)
            lines.append(f"  constant {name} : {kind} := {text};")
    lines += ["", f"end package {package};"]
    return "\n".join(lines) + "\n"


def markdown_text(table: Table) -> str:
    lines = [f"<!-- {NOTE} -->", "# Protocol constants", ""]
    lines += [
        "These are the constants of the wire protocols. Their use is explained in the",
        "[framed protocol](protocol.md) and the [classic protocol](classic-protocol.md).",
        "",
    ]
    for section, values in table.items():
        lines += [f"## {section}", ""]
        first = next(iter(values.values()))
        if isinstance(first, dict):
            lines += ["| name | code | meaning |", "|---|---|---|"]
            lines += [
                f"| {k} | {markdown_value(e['code'], section)} | {e['meaning']} |" for k, e in values.items()
            ]
        else:
            lines += ["| name | value |", "|---|---|"]
            lines += [f"| {k} | {markdown_value(v, section)} |" for k, v in values.items()]
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def markdown_value(value: object, section: str) -> str:
    if isinstance(value, str):
        return f"`{value}`"
    assert isinstance(value, int)
    if section == "bytes":
        shown = chr(value) if 0x21 <= value < 0x7F else {0x0A: "LF", 0x0D: "CR"}.get(value, "")
        return f"`{shown}` ({value:02X} hex)"
    if section in HEXADECIMAL:
        return f"{value} ({value:02X} hex)"
    return str(value)


def of_constants(text: Callable[[Table], str], *without: str) -> Callable[[Table], str]:
    left_out = ("settings", *without)
    return lambda table: text({name: values for name, values in table.items() if name not in left_out})


def of_the_ring(table: Table) -> str:
    """Return the package that only the ring's gateware knows."""
    return vhdl_text({"tosnet_wire": table["tosnet_wire"]}, "tosnet_wire_pkg")


def of_settings(text: Callable[[settings.Settings], str]) -> Callable[[Table], str]:
    return lambda table: text(table["settings"])


ARTEFACTS = {
    "src/unitylink/protocol.py": of_constants(python_text),
    "native/include/unitylink/protocol.hpp": of_constants(cpp_text),
    # The program of the small engine tells its sizes to the VHDL. The latencies of the framed engine are
    # measured at its VHDL. No gateware knows a server.
    "gateware/common/protocol_pkg.vhd": of_constants(
        vhdl_text, "tosnet_wire", "small_engine", "framed_latency", "small_latency", "serve"
    ),
    "gateware/tosnet/tosnet_wire_pkg.vhd": of_the_ring,
    "docs/protocol-constants.md": of_constants(markdown_text),
    "src/unitylink/settings.py": of_settings(settings.python_text),
    "native/include/unitylink/settings.hpp": of_settings(settings.cpp_text),
    "gateware/common/settings_pkg.vhd": of_settings(settings.vhdl_text),
    "docs/settings.md": of_settings(settings.markdown_text),
}


def main(arguments: list[str]) -> int:
    check = arguments == ["--check"]
    if arguments and not check:
        print(__doc__, file=sys.stderr)
        return 2
    table = read_table()
    stale = [name for name, text in ARTEFACTS.items() if current(name) != text(table)]
    for name in stale:
        if check:
            print(f"stale: {name}; run: python protocol/generate.py")
        else:
            path = ROOT / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(ARTEFACTS[name](table), encoding="utf-8")
            print(f"wrote {name}")
    return 1 if check and stale else 0


def current(name: str) -> str | None:
    path = ROOT / name
    return path.read_text(encoding="utf-8") if path.exists() else None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
