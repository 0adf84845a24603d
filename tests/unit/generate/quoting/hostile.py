# SPDX-License-Identifier: BSD-3-Clause
"""Specs whose texts try to act as code in what is generated.

There is a text for every place of a spec that has one.

The long form is `python tests/unit/generate/quoting/hostile.py --seconds 300`. It tries every payload in
every place, and then random mixtures. The tests run a part of it.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
import time
from collections.abc import Hashable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from itertools import chain, count
from pathlib import Path

from unitylink.errors import SpecError, UnityLinkError
from unitylink.generate import ARTEFACTS, generate
from unitylink.spec import compile_text, render

sys.path.insert(0, str(Path(__file__).parent))

from structure import Broken, structure

CANARY = "hostile_was_here"  # the trace of a payload that acted: a name, a file, a file of a command
_ACTS = f"__import__('builtins').{CANARY}=1"
PAYLOADS = (
    *(
        '"',
        "'",
        '"""',
        "'''",
        '""',
        '""""',
        "\\",
        '\\"',
        "\\\\",
        '"parked"',
        "it's",
        'say "x"',
        '\\"""',
        "`",
        "``",
    ),
    f'"""\n{_ACTS}\n"""',
    f'"""; {_ACTS}; """',
    f"'''; {_ACTS}; '''",
    f'"; {_ACTS}; "',
    f"'; {_ACTS}; '",
    f'" + str({_ACTS}) + "',
    f">>> {_ACTS}",
    f'>>> """\n{_ACTS} #',
    f"# -*- coding: utf-7 -*- +AAo-{_ACTS}",
    f"coding=utf-7 +AAo{_ACTS}",
    f"\n{_ACTS}\n",
    f"\r{_ACTS}\r",
    f"\r\n{_ACTS}",
    f"\x0b{_ACTS}\x0c{_ACTS}",
    f"\u2028{_ACTS}\u2029",
    f"\x85{_ACTS}",
    f"{{{_ACTS}}}",
    *(
        "\0",
        "\x1b[31m",
        "\x07\x08\x7f",
        "\ufeff",
        "\u202e }; system(0); {",
        "\u2066//\u2069",
        "\u200b",
        "\ufffe",
    ),
    *(
        "*/",
        "/*",
        "*/ system(0); /*",
        "//",
        "/**/",
        "\\\n",
        "a\\",
        "??/",
        "??/\n",
        "??'",
        '??/" + x',
        "%s%n",
        "%:",
        "<:",
    ),
    '"); system("touch x"); //',
    '")\n#error x\n("',
    '\n#include "/etc/passwd"\n',
    '"sv; L"',
    'R"(x',
    ')"; y',
    "-->",
    "--",
    "---",
    "--!>",
    "a-",
    "]]>",
    "<![CDATA[",
    "<?php x ?>",
    "<!DOCTYPE x>",
    '<!ENTITY x SYSTEM "file:///etc/passwd">',
    "&lt;",
    "&x;",
    "<b onload=x>",
    '"/><x y="',
    "'/><x y='",
    "</script><script>x()</script>",
    "<!--<script>",
    "</description><exec_depend>x</exec_depend>",
    "<script>alert(1)</script>",
    "${__import__('os').system('x')}",
    "$${x}",
    "$(eval x)",
    "$(arg x)$(find y)",
    "$(touch x)",
    "`touch x`",
    "; touch x #",
    "&& touch x",
    "|| x",
    "| x |",
    "> x",
    "\n[exec touch x]\n",
    "[exec touch x]",
    "} ; exec x ; {",
    "{{",
    "}}",
    "{ [exit] }",
    "$env(HOME)",
    "#{x}",
    "{{ x }}",
    "{% for x in y %}",
    "{{ ''.__class__ }}",
    "{# x #}",
    "#[[",
    "#[==[",
    "]]",
    "]==]",
    '")\nexecute_process(COMMAND touch x)\nset(y "',
    "${CMAKE_BINARY_DIR}",
    "$ENV{HOME}",
    "$<1:x>",
    "\n---\n- !!python/object/apply:os.system [x]\n",
    "!!python/object/apply:os.system [x]",
    "a: b",
    "- a",
    "? a",
    "&a *a",
    "no",
    "null",
    "~",
    "1e3",
    "0x10",
    "2026-01-01",
    "<<: x",
    "@x",
    "%YAML 1.1",
    "a #b",
    " a ",
    "\t",
    "''",
    '\n";\nassert false severity failure;\n--',
    '" & x & "',
    "\nsynthesis translate_off\n",
    "synthesis translate_off",
    "pragma translate_off",
    "`protect begin",
    "vim: set exrc:",
    "-*- mode: x; eval: (x) -*-",
    "![x](javascript:x)",
    "[x]: javascript:x",
    "</td></tr></table>",
    "a|b|c",
    "# x",
    "```\nx\n```",
    "é µ 日本 😀",
    "x" * 5000,
    '"' * 3000,
    "\\" * 2999,
    ' "' * 1500,
)
BENIGN = "plain"

# Each place has a name of its own in angle brackets. `s_` places are within quotes, `d_` places after `///`.
SPEC = """\
/// <d_link>
link lab (DATA=32, ADDRESS=16, BASE_RATE=1000 Hz, BAUD=3000000);
const title = "<s_const>";
/// <d_enum>
@note("<s_note>", key="<s_option>")
enum mode: u2 {
   idle = 0;  /// <d_value>
   /// <d_other>
   run = 1;
}
/// <d_bits>
bits status: u16 {
   ready: bool @ 0;  /// <d_field>
   mode: mode @ 2..1;
   heat: i8 @ 11..4 (UNIT="degC", SCALE=0.5);
}
/// <d_root>
@note("<s_root_note>")
public arm(up) {
   /// <d_part>
   @ros(type="JointState", joint="<s_joint>", frame="<s_frame>")
   hip: joint("<s_argument>") @ (0x80,0x84,0x86,0x87,0x88);
   leg[2]: joint("<s_array>") @ (0x90+i*8,0x91+i*8,0x92+i*8,0x93+i*8,0x94+i*8);
   @lamp = 0x10: bool WRITE(ID="<s_id>", SAFE=0);  /// <d_element>
   @gain = 0x14: f32 READWRITE(ID=title, INITIAL=1.5);
   /// <d_changing>
   @fault = 0x17: u8 READ(PUBLISH(on change));
   motors: drive() @ 0x100;
   all = ALL(joint).torque;
}
/// <d_constructor>
@ros(type="JointState", frame="<s_frame>")
joint(name: string): @ (pos,torque,state,mode,goal) {
   /// <d_pos>
   @pos: i16 READ(ID=name+"<s_sum>", UNIT="rad", SCALE=0.001, PUBLISH(100 Hz, GROUP=pose));
   @torque: fixed(8,8) WRITE(UNIT="N m", MIN=-20, MAX=20, INITIAL=0, SAFE=0);
   @state: status READ(PUBLISH(100 Hz, GROUP=pose));
   @mode: mode WRITE(INITIAL=idle, SAFE=run);
   @goal: i16 WRITE(UNIT="rad", SCALE=0.001, SAFE=0);
}
/// <d_component>
@component("<n_entity>") @generic(channels=2) @pin("<n_pin>", "out", 2) @event("<n_event>")
drive(): @base[4] {
   @duty = base: u8 WRITE();
   /// <d_word>
   @state = base+1: u8 READ(PUBLISH(on changed));
}
"""
PLACES = (*dict.fromkeys(re.findall(r"<(\w_\w+)>", SPEC)), "file")
# a text in one of these places must be a name, or is refused
NAMES = {"n_entity": "pwm", "n_pin": "pins", "n_event": "changed"}
SHOWN = ("s_joint", "s_frame", "file")  # a text in one of these places can be printed, or is refused
LONGEST_SHOWN = 200


def spec_text(texts: Mapping[str, str]) -> str:
    """Return the spec with `texts` in its places. All other texts are harmless."""

    def said(match: re.Match[str]) -> str:
        place = match[1]
        text = texts.get(place, NAMES.get(place, BENIGN))
        if place.startswith("d_"):
            return text.replace("\n", " ").replace("\r", " ")
        text = text.replace("{", "{{").replace("}", "}}") if place == "s_array" else text
        return "".join(c if c.isalnum() or ord(c) > 0xFFFF else f"\\u{ord(c):04x}" for c in text)

    return re.sub(r"<(\w_\w+)>", said, SPEC)


def placed(place: str, payload: str) -> str | None:
    """Return a payload in a form that can stand in a place.

    Return None if it is refused there, or is too long.
    """
    if place in NAMES or (place in SHOWN and not payload.isprintable()):
        return None
    if place == "file":
        return f"{payload.replace('/', '_')}.ul" if len(payload) <= LONGEST_SHOWN else None
    if place.startswith("s_") and len(payload) > LONGEST_SHOWN:
        return None
    return payload if any(c.isprintable() and not c.isspace() for c in payload) else f"a{payload}b"


def files_of(texts: Mapping[str, str], artefacts: Iterable[str] = ARTEFACTS) -> dict[str, str]:
    """Return the generated files of these artefacts of the spec with these texts.

    Raises UnityLinkError if a text is refused.
    """
    result = compile_text(spec_text(texts), texts.get("file", "arm.ul"))
    if result.spec is None:
        raise SpecError(render(result.diagnostics))
    return {f"{a}:{name}": text for a in artefacts for name, text in generate(result.spec, a).items()}


@cache
def benign() -> tuple[dict[str, str], dict[str, Hashable]]:
    files = files_of({})
    return files, {name: structure(name, text) for name, text in files.items()}


def check(texts: Mapping[str, str], artefacts: Iterable[str] = ARTEFACTS) -> dict[str, str]:
    """Return the files. Raises Broken unless every file has the structure of its benign twin."""
    plain, structures = benign()
    files = files_of(texts, artefacts)
    expected = {name for name in plain if name.partition(":")[0] in artefacts}
    if files.keys() != expected:
        raise Broken(f"other files: {files.keys() ^ expected}")
    for name, text in files.items():
        if text != plain[name] and structure(name, text) != structures[name]:
            raise Broken(f"{name} has another structure")
    return files


def mixed(turn: int) -> dict[str, str]:
    """Return the texts of one turn, with a different payload in each place.

    `len(PAYLOADS)` turns bring every payload to every place.
    """
    texts = {}
    for number, place in enumerate(PLACES):
        text = placed(place, PAYLOADS[(turn + 5 * number) % len(PAYLOADS)])
        if text is not None:
            texts[place] = text
    return texts


def made_up(seed: int) -> dict[str, str]:
    """Return random texts that are made of pieces of payloads."""
    random_ = random.Random(seed)
    pieces = [p for p in PAYLOADS if len(p) < 100]
    texts = {}
    for place in PLACES:
        text = placed(place, "".join(random_.choices(pieces, k=random_.randint(1, 4)))[:LONGEST_SHOWN])
        if text is not None:
            texts[place] = text
    return texts


def main() -> int:
    """Bring every payload to every place. Then try made-up ones until the time is used up."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    end = time.monotonic() + arguments.seconds
    turns: Iterator[tuple[str, dict[str, str]]] = chain(
        ((f"turn {turn}", mixed(turn)) for turn in range(len(PAYLOADS))),
        ((f"seed {seed}", made_up(seed)) for seed in count(arguments.seed)),
    )
    tried = failures = 0
    for name, texts in turns:
        tried += 1
        try:
            check(texts)
        except Exception as error:
            failures += 1
            print(f"{name}: {type(error).__name__}: {error}", flush=True)
            for place, text in texts.items():
                with suppress(UnityLinkError):
                    try:
                        check({place: text})
                    except Broken as broken:
                        print(f"   {place} = {text!r}: {broken}", flush=True)
        if tried >= len(PAYLOADS) and time.monotonic() > end:
            break
    print(f"hostile: {tried:,} specs of {len(PLACES)} places, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
