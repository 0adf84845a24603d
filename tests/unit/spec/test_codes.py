# SPDX-License-Identifier: BSD-3-Clause
"""Every diagnostic code: one file that gives it, it alone, at one place."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.spec import CODES, Result, compile_file, compile_text

ERRORS = Path(__file__).parent / "errors"

# file -> line, column of its diagnostic
PLACES = {
    "UL002_not_utf8": (2, 32),
    "UL004_unexpected_character": (2, 27),
    "UL005_comment_never_ends": (2, 22),
    "UL006_string_never_ends": (2, 22),
    "UL007_unknown_escape": (2, 29),
    "UL008_malformed_number": (2, 9),
    "UL009_name_too_long": (2, 5),
    "UL010_unexpected_token": (2, 17),
    "UL011_missing_semicolon": (2, 20),
    "UL012_brace_never_closed": (1, 12),
    "UL013_closing_brace_alone": (4, 1),
    "UL014_keyword_as_name": (2, 5),
    "UL015_unknown_property": (2, 27),
    "UL016_property_twice": (2, 27),
    "UL017_second_header": (2, 1),
    "UL018_header_not_first": (4, 1),
    "UL019_address_not_hexadecimal": (2, 9),
    "UL020_constructor_twice": (7, 1),
    "UL021_member_twice": (3, 5),
    "UL022_parameter_twice": (4, 7),
    "UL023_address_twice": (4, 14),
    "UL024_unknown_constructor": (2, 7),
    "UL025_unknown_parameter": (5, 18),
    "UL026_unknown_address": (6, 5),
    "UL027_unknown_group_member": (4, 21),
    "UL028_all_matches_nothing": (3, 15),
    "UL029_no_public_constructor": (1, 1),
    "UL030_wrong_argument_count": (2, 7),
    "UL031_wrong_address_count": (2, 20),
    "UL032_bindings_do_not_fit": (2, 14),
    "UL033_address_bound_twice": (2, 22),
    "UL034_constructor_expands_itself": (9, 7),
    "UL035_group_contains_itself": (4, 4),
    "UL036_public_takes_addresses": (1, 8),
    "UL037_run_time_parameter_as_string": (3, 22),
    "UL038_expansion_too_large": (1, 8),
    "UL039_nested_too_deep": (1, 8),
    "UL040_string_too_long": (5, 16),
    "UL041_second_tosnet": (3, 4),
    "UL050_beyond_32_bits": (2, 9),
    "UL051_two_elements_at_one_address": (3, 24),
    "UL052_read_and_write_of_one_word": (3, 15),
    "UL053_outside_tosnet_memory": (3, 9),
    "UL054_tosnet_access_rights": (3, 9),
    "UL060_publish_on_write": (2, 20),
    "UL061_publish_mode": (2, 27),
    "UL062_divisor_zero": (2, 29),
    "UL063_divisor_too_large": (2, 29),
    "UL064_more_than_a_2012_group": (33, 5),
    "UL066_more_than_2012_groups": (18, 5),
    "UL069_element_twice_in_group": (4, 17),
    "UL070_constructor_never_expanded": (4, 1),
    "UL071_parameter_never_used": (4, 7),
    "UL072_address_never_used": (4, 17),
    "UL073_string_parameter_of_public": (1, 10),
    "UL074_group_without_elements": (3, 4),
}


def _flat(*members: str) -> str:
    return "public a() {\n" + "".join(f"   {member}\n" for member in members) + "}\n"


def _reads(count: int, divisor: str) -> list[str]:
    return [f"@x{i} = 0x{i:X}: READ(PUBLISH(1,{divisor or i + 1}));" for i in range(count)]


# code -> text, line and column: those whose text is too long for a file, and the other codes it also gives
BUILT = {
    "UL000": (_flat("@;" * 1200), (2, 2003), {"UL010"}),
    "UL003": (" " * (2 * 1024 * 1024 + 1), (1, 1), set()),
    "UL065": (_flat(*_reads(256, "10")), (257, 5), set()),
    "UL067": (_flat(*_reads(257, "")), (258, 5), {"UL066"}),
    "UL068": (
        _flat("all = p;", "p: p();") + "p() {" + "".join(f"@x{i}=0x{i:X}:READ();" for i in range(256)) + "}",
        (2, 4),
        set(),
    ),
}


def _only(result: Result, code: str, place: tuple[int, int]) -> None:
    assert [d.code for d in result.diagnostics] == [code]
    diagnostic = result.diagnostics[0]
    assert (diagnostic.span.line, diagnostic.span.column) == place
    assert diagnostic.severity == CODES[code].severity
    assert (result.spec is None) == (diagnostic.severity == "error")


@pytest.mark.parametrize("name", PLACES)
def test_file_gives_its_code_and_nothing_else(name: str) -> None:
    _only(compile_file(ERRORS / f"{name}.ul"), name[:5], PLACES[name])


@pytest.mark.parametrize("code", BUILT)
def test_long_text_gives_its_code(code: str) -> None:
    text, place, also = BUILT[code]
    diagnostics = compile_text(text).diagnostics
    assert {d.code for d in diagnostics} == {code, *also}
    ours = [d for d in diagnostics if d.code == code]
    assert [(d.span.line, d.span.column) for d in ours] == [place]


def test_file_that_is_not_there(tmp_path: Path) -> None:
    _only(compile_file(tmp_path / "none.ul"), "UL001", (1, 1))
    _only(compile_file(tmp_path), "UL001", (1, 1))
    _only(compile_file("a\0b.ul"), "UL001", (1, 1))


def test_every_code_has_a_test_and_every_file_a_code() -> None:
    assert {name[:5] for name in PLACES} | set(BUILT) | {"UL001"} == set(CODES)
    assert {path.stem for path in ERRORS.glob("*.ul")} == set(PLACES)


@pytest.mark.parametrize("name", PLACES)
def test_every_diagnostic_says_what_to_do(name: str) -> None:
    if name[:5] != "UL010":  # what was expected is said in the message
        assert compile_file(ERRORS / f"{name}.ul").diagnostics[0].hint
