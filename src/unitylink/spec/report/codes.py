# SPDX-License-Identifier: BSD-3-Clause
"""Every diagnostic code, with its severity and title. A code never changes its meaning."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Code:
    """One kind of diagnostic."""

    severity: str  # "error" or "warning"
    title: str


def _errors(**titles: str) -> dict[str, Code]:
    return {code: Code("error", title) for code, title in titles.items()}


def _warnings(**titles: str) -> dict[str, Code]:
    return {code: Code("warning", title) for code, title in titles.items()}


_TEXT = _errors(
    UL000="too many diagnostics",
    UL001="file cannot be read",
    UL002="text is not valid UTF-8",
    UL003="text too large",
    UL004="unexpected character",
    UL005="comment never ends",
    UL006="string never ends",
    UL007="unknown escape in a string",
    UL008="malformed number",
    UL009="name too long",
)

_SYNTAX = _errors(
    UL010="unexpected token",
    UL011="missing `;`",
    UL012="brace never closed",
    UL013="closing brace without an opening one",
    UL014="keyword used as a name",
    UL015="unknown property",
    UL016="property given twice",
    UL017="second `link` header",
    UL018="`link` header not at the beginning",
    UL019="address not hexadecimal",
)

_NAMES = _errors(
    UL020="constructor declared twice",
    UL021="member declared twice",
    UL022="parameter declared twice",
    UL023="address declared twice",
    UL024="unknown constructor",
    UL025="unknown parameter",
    UL026="unknown address",
    UL027="unknown name in a group",
    UL028="`ALL` matches nothing",
    UL029="no public constructor",
)

_EXPANSION = _errors(
    UL030="wrong number of arguments",
    UL031="wrong number of addresses",
    UL032="bindings that do not fit the constructor",
    UL033="address bound twice",
    UL034="constructor expands itself",
    UL035="group contains itself",
    UL036="public constructor takes addresses",
    UL037="run-time parameter used as a string, or the reverse",
    UL038="expansion too large",
    UL039="expansion nested too deep",
    UL040="string too long",
    UL041="second TOSNET in a constructor",
    UL042="import cannot be read",
    UL043="file imports itself",
    UL044="import outside the search path",
    UL045="number or expression too large",
    UL046="not a whole number",
    UL047="number where a string is needed, or the reverse",
    UL048="arithmetic without a result",
    UL049="number out of range",
)

_HARDWARE = {
    **_errors(
        UL050="number beyond 32 bits",
        UL051="two elements at one address",
        UL052="READ and WRITE of one word",
        UL055="address outside the constructor's block",
        UL056="no room for a block of addresses",
        UL057="address inside another block",
        UL058="not possible on this kind of link",
        UL059="address beyond the link's width",
        UL060="PUBLISH on a WRITE",
        UL061="PUBLISH mode neither 1 nor 2",
        UL062="PUBLISH divisor 0",
        UL063="PUBLISH divisor too large",
        UL065="more publishes than a message can carry",
        UL067="more publish groups than a message can name",
        UL068="group too large",
        UL101="rate out of reach",
        UL102="unknown event of a component",
        UL103="snapshot group with two rates",
        UL104="publishes that the line cannot carry",
        UL105="what the small engine lacks",
        UL108="ring that cannot be",
        UL110="not possible for a component in a ring's node",
    ),
    **_warnings(
        UL053="address outside TosNet's shared memory",
        UL054="access that TosNet does not allow",
        UL064="more publishes at one rate than the 2012 gateware can hold in a group",
        UL066="more publish groups than the 2012 gateware can hold",
        UL069="element twice in a group",
        UL100="rate rounded",
        UL107="node id that does not suit a ring",
        UL109="publish faster than the ring",
    ),
}

_VALUES = _errors(
    UL080="unknown type",
    UL081="type that cannot be",
    UL082="name declared twice",
    UL083="two values with one number",
    UL084="type without content",
    UL085="bit fields overlap",
    UL086="field that does not fit its bits",
    UL087="unknown unit",
    UL088="units that do not match",
    UL089="MAX below MIN",
    UL090="value out of range",
    UL091="SCALE of 0",
    UL092="property that does not fit",
    UL093="unknown choice",
    UL094="arguments that do not fit the parameters",
    UL095="unknown link",
    UL096="link not named",
    UL097="unknown constant",
    UL098="incomplete component",
    UL106="wire that leads nowhere",
)

_UNUSED = _warnings(
    UL070="constructor never expanded",
    UL071="parameter never used",
    UL072="address never used",
    UL073="string parameter of a public constructor",
    UL074="group without elements",
    UL075="documentation of nothing",
    UL076="constant or type never used",
)

CODES: dict[str, Code] = dict(
    sorted({**_TEXT, **_SYNTAX, **_NAMES, **_EXPANSION, **_HARDWARE, **_VALUES, **_UNUSED}.items())
)
