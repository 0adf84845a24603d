# SPDX-License-Identifier: BSD-3-Clause
"""Generate what follows from the table of settings.

A new setting needs one row in it, beside the code that uses it.
"""

from __future__ import annotations

from typing import Any

Row = dict[str, Any]
Settings = dict[str, Row]

NOTE = "Generated from protocol/protocol.toml by protocol/generate.py; edit there."
LINE = 120  # longest line of VHDL or C++
GROUPS_MOST = 256  # width of the type `groups` in bits
MANUAL = (
    "The settings fix what a device is built with. A setting has the same name, range and default",
    "everywhere:",
    "",
    "- in Python, as a field of `BoardConfiguration`;",
    "- in VHDL, as a field of the core's generic `settings`, made by `core_settings(NAME => VALUE, …)`;",
    "- in the twin, the software model of the board;",
    "- in the URLs of `sim:` and `rtl:` links (`?NAME=VALUE`);",
    "- as options of `unitylink simulate`.",
    "",
    "**Needed by** names the parts that use a setting:",
    "",
    "- *core*: the VHDL.",
    "- *twin*: the native model of it. If only the twin uses a setting, gateware has the default. A design",
    "  that asks for another value is refused.",
    "- *line*: the model of a physical layer before either of them.",
    "- *top*: the generated top level.",
    "",
    "**Changed by** names where a value can come from:",
    "",
    "- *spec*: the compiler takes it from the spec.",
    "- *url*: a URL.",
    "- *python*: a program.",
    "- *own design*: only a design of your own. It can change all settings of the core.",
    "",
    "To add a setting, write a row of `[settings]` in protocol/protocol.toml, run",
    "`python protocol/generate.py`, and use it.",
    "",
    "Read the columns *unit* and *meaning* together: 8 *bits of a word's address*.",
)
RESERVED = {"xor": "exclusive_or"}  # a choice whose name is a keyword of C++


def needed_by(settings: Settings, *who: str) -> Settings:
    return {name: row for name, row in settings.items() if set(who) & set(row["needed_by"])}


def choices(settings: Settings) -> dict[str, list[str]]:
    return {name: row["choices"] for name, row in settings.items() if row["type"] == "choice"}


def meaning(row: Row) -> str:
    unit = f"{row['unit']}: " if row["unit"] else ""
    return f"{unit}{row['what']}"


def described(declared: str, comment: str) -> list[str]:
    """Return a declaration with its comment. The comment is beside it if that fits, else above it."""
    beside = f"{declared}  {comment}"
    indent = declared[: len(declared) - len(declared.lstrip())]
    return [beside] if len(beside) <= LINE else [indent + comment, declared]


# ---- Python


def python_text(settings: Settings) -> str:
    lines = [
        "# SPDX-License-Identifier: BSD-3-Clause",
        f'"""What a device is built with (docs/settings.md).\n\n{NOTE}\n"""',
        "",
        "from __future__ import annotations",
        "",
        "from dataclasses import dataclass",
        "from types import MappingProxyType",
        "from typing import Any, Final",
        "",
        "",
        "@dataclass(frozen=True)",
        "class Setting:",
        '    """A row of the table; `least` and `most` are those of a count, `choices` those of a choice."""',
        "",
        "    name: str",
        "    type: str",
        "    default: Any",
        "    unit: str",
        "    needed_by: tuple[str, ...]",
        "    changed_by: tuple[str, ...]",
        "    what: str",
        "    least: int = 0",
        "    most: int = 0",
        "    choices: tuple[str, ...] = ()",
        "    told: bool = False",
        '    option: str = ""  # its name in a URL',
        "",
        "",
        "@dataclass(frozen=True)",
        "class Settings:",
        '    """Every setting of a device, under the name that C++, VHDL and URLs have for it, too."""',
        "",
    ]
    types = {"count": "int", "switch": "bool", "choice": "str", "groups": "tuple[int, ...]"}
    for name, row in settings.items():
        value = () if row["type"] == "groups" else row["default"]
        lines += [f"    {name}: {types.get(row['type'], 'int')} = {python_literal(value)}"]
        lines += [f'    """{meaning(row)}"""']
    lines += ["", "", "# fmt: off", "SETTINGS: Final = MappingProxyType(", "    {"]
    for name, row in settings.items():
        lines += python_row(name, row)
    lines += ["    }", ")", "# fmt: on"]
    return "\n".join(lines) + "\n"


def python_row(name: str, row: Row) -> list[str]:
    """Return a row in few lines. The formatter would take a line for each of its fields."""
    default = () if row["type"] == "groups" else row["default"]
    first = [name, row["type"], default, row["unit"], tuple(row["needed_by"]), tuple(row["changed_by"])]
    more: dict[str, Any] = {}
    if "range" in row:
        more["least"], more["most"] = row["range"]
    if "choices" in row:
        more["choices"] = tuple(row["choices"])
    if row.get("told"):
        more["told"] = True
    if "url" in row["changed_by"]:
        more["option"] = row.get("option", name)
    last = ", ".join(f"{key}={python_literal(value)}" for key, value in more.items())
    return [
        f'        "{name}": Setting(',
        f"            {', '.join(map(python_literal, first))},",
        f"            {python_literal(row['what'])}{',' if last else '),'}",
        *([f"            {last}),"] if last else []),
    ]


def python_literal(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple):
        inside = ", ".join(python_literal(one) for one in value)
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    return repr(value)


# ---- C++


def cpp_text(settings: Settings) -> str:
    """Return the structure of the twin, the code that visits its fields, and the limits of the numbers."""
    needed = needed_by(settings, "twin", "line")
    lines = [
        "// SPDX-License-Identifier: BSD-3-Clause",
        "// What a device is built with (docs/settings.md).",
        f"// {NOTE}",
        "#pragma once",
        "",
        "#include <bitset>",
        "#include <cstdint>",
        "#include <string_view>",
        "",
        "namespace unitylink {",
        "",
        "// Of a number, both ends included.",
        "struct SettingLimits {",
        "  std::uint32_t least;",
        "  std::uint32_t most;",
        "};",
        "",
        "namespace limits_of {",
    ]
    for name, row in settings.items():
        if row["type"] == "count":
            lines.append(f"inline constexpr SettingLimits {name}{{{row['range'][0]}, {row['range'][1]}}};")
    lines += ["}  // namespace limits_of", "", "namespace device {", ""]
    for name, values in choices(needed).items():
        inside = ", ".join(RESERVED.get(value, value) for value in values)
        lines.append(f"enum class {camel(name)} : std::uint8_t {{ {inside} }};")
    lines += ["", "struct Settings {"]
    for name, row in needed.items():
        lines += described(f"  {cpp_field(name, row)}", f"// {meaning(row)}")
    lines += ["};", ""]
    lines += ["// Calls visit(name, field) for each of them."]
    lines += ["template <class Visit>", "void each_setting(Settings& settings, Visit&& visit) {"]
    lines += [f'  visit("{name}", settings.{name});' for name in needed]
    lines += ["}", ""]
    lines += ["// Calls judge(name, value, limits) for each that is a count."]
    lines += ["template <class Judge>", "void each_limit(const Settings& settings, Judge&& judge) {"]
    for name, row in needed.items():
        if row["type"] == "count":
            lines.append(f'  judge("{name}", settings.{name}, limits_of::{name});')
    lines += ["}", ""]
    for name, values in choices(needed).items():
        kind = camel(name)
        lines.append(
            f"[[nodiscard]] constexpr bool choose(std::string_view text, {kind}& chosen) noexcept {{"
        )
        for value in values:
            lines.append(f'  if (text == "{value}") {{')
            lines += [f"    chosen = {kind}::{RESERVED.get(value, value)};", "    return true;", "  }"]
        lines += ["  return false;", "}", ""]
    lines += ["}  // namespace device", "}  // namespace unitylink"]
    return "\n".join(lines) + "\n"


def cpp_field(name: str, row: Row) -> str:
    kind, default = row["type"], row["default"]
    if kind == "switch":
        return f"bool {name} = {str(default).lower()};"
    if kind == "choice":
        return f"{camel(name)} {name} = {camel(name)}::{RESERVED.get(default, default)};"
    if kind == "groups":
        return f"std::bitset<{GROUPS_MOST}> {name};"
    return f"std::uint{64 if kind == 'hash' else 32}_t {name} = {default};"


def camel(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


# ---- VHDL


def vhdl_text(settings: Settings) -> str:
    """Return the record of the core, and the function that makes one from the settings that differ from the
    defaults.
    """
    needed = needed_by(settings, "core")
    width = max(map(len, needed))
    lines = [
        "-- SPDX-License-Identifier: BSD-3-Clause",
        "-- What a core is built with (docs/settings.md).",
        f"-- {NOTE}",
        "--",
        "--   core : entity unitylink.core",
        "--     generic map (settings => core_settings(clock_hz => 12_000_000, groups => 4))",
        "library ieee;",
        "  use ieee.std_logic_1164.all;",
        "",
        "package settings_pkg is",
        "",
    ]
    for name, values in choices(needed).items():
        lines.append(f"  type {name}_t is ({', '.join(f'{name}_{value}' for value in values)});")
    lines += ["", "  type settings_t is record"]
    for name, row in needed.items():
        declared = f"    {name.ljust(width)} : {vhdl_type(name, row)};"
        lines += described(declared, f"-- {meaning(row)}")
    lines += ["  end record;", ""]
    lines += ["  -- The defaults, but for what is named.", *vhdl_function(needed), ""]
    lines += ["  -- The same at another clock: of a design whose clock is a generic."]
    lines += ["  function at_clock(settings : settings_t; clock_hz : positive) return settings_t;", ""]
    lines += ["  -- What a choice is called."]
    for name in choices(needed):
        lines.append(f"  function text_of(choice : {name}_t) return string;")
        lines.append(f"  function {name}_of(text : string) return {name}_t;")
    lines += ["", "end package;", "", "package body settings_pkg is", ""]
    lines += [
        line.removesuffix(";") if "return settings_t;" in line else line for line in vhdl_function(needed)
    ]
    lines[-1] += " is"
    lines += ["  begin", "    return ("]
    lines += [f"      {name.ljust(width)} => {name}," for name in needed]
    lines[-1] = lines[-1].removesuffix(",") + ");"
    lines += ["  end function;", ""]
    lines += ["  function at_clock(settings : settings_t; clock_hz : positive) return settings_t is"]
    lines += [
        "    variable changed : settings_t := settings;",
        "  begin",
        "    changed.clock_hz := clock_hz;",
    ]
    lines += ["    return changed;", "  end function;"]
    for name, values in choices(needed).items():
        lines += [
            "",
            f"  function text_of(choice : {name}_t) return string is",
            "  begin",
            "    case choice is",
        ]
        lines += [f'      when {name}_{value} => return "{value}";' for value in values]
        lines += ["    end case;", "  end function;"]
        lines += ["", f"  function {name}_of(text : string) return {name}_t is", "  begin"]
        for value in values[1:]:
            lines += [f'    if text = "{value}" then', f"      return {name}_{value};", "    end if;"]
        unknown = f'report "settings_pkg: no {name} is called " & text severity failure;'
        lines += [f'    assert text = "{values[0]}" {unknown}']
        lines += [f"    return {name}_{values[0]};", "  end function;"]
    lines += ["", "end package body;"]
    return "\n".join(lines) + "\n"


def vhdl_function(needed: Settings) -> list[str]:
    width = max(map(len, needed))
    parameters = []
    for name, row in needed.items():
        default = vhdl_literal(name, row["type"], row["default"])
        parameters.append(f"    {name.ljust(width)} : {vhdl_type(name, row)} := {default};")
    parameters[-1] = parameters[-1].removesuffix(";")
    return ["  function core_settings(", *parameters, "  ) return settings_t;"]


def vhdl_type(name: str, row: Row) -> str:
    kind = row["type"]
    if kind == "count":
        least, most = row["range"]
        return f"natural range {least} to {most}"
    bits = {"groups": GROUPS_MOST, "word": 32, "hash": 64}
    return (
        f"std_ulogic_vector({bits[kind] - 1} downto 0)"
        if kind in bits
        else {"switch": "boolean"}.get(kind, f"{name}_t")
    )


def vhdl_literal(name: str, kind: str, value: Any) -> str:
    """Return `value` of the setting `name` as a VHDL literal."""
    if kind == "switch":
        return str(value).lower()
    if kind == "choice":
        return f"{name}_{value}"
    if kind == "groups":
        return "(others => '0')"
    return f'x"{value:0{16 if kind == "hash" else 8}X}"' if kind in ("word", "hash") else str(value)


# ---- the documentation


def markdown_text(settings: Settings) -> str:
    lines = [
        f"<!-- {NOTE} -->",
        "# Settings",
        "",
        *MANUAL,
        "",
        "| name | range | default | unit | meaning | needed by | changed by |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, row in settings.items():
        option = f" (URL: `{row['option']}`)" if "option" in row else ""
        cells = [f"`{name}`{option}", markdown_range(row), markdown_default(row), row["unit"], row["what"]]
        cells += [", ".join(row["needed_by"]), ", ".join(row["changed_by"]) or "own design"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def markdown_range(row: Row) -> str:
    kind = row["type"]
    if kind == "count":
        return f"{row['range'][0]:,} to {row['range'][1]:,}"
    if kind == "choice":
        return ", ".join(f"`{value}`" for value in row["choices"])
    return {"switch": "true, false", "groups": "numbers of groups", "word": "32 bits", "hash": "64 bits"}[
        kind
    ]


def markdown_default(row: Row) -> str:
    kind, value = row["type"], row["default"]
    if kind == "count":
        return f"{value:,}"
    if kind in ("word", "hash"):
        return f"{value:0{8 if kind == 'word' else 16}X} hex"
    return "none" if kind == "groups" else f"`{str(value).lower()}`"
