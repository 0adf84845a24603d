# SPDX-License-Identifier: BSD-3-Clause
"""The formatter: canonical layout, comments kept.

(test_properties.py tests that it is idempotent and keeps the meaning)
"""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.errors import SpecError
from unitylink.spec import format_text

EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*/*.ul"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_formatted(path: Path) -> None:
    text = path.read_text("utf-8")
    assert format_text(text) == text


UGLY = """\ufeff// head comment
link  robots . a ;
/* block
     comment */


public a( ctrl , comm ){TOSNET ( CTRL = ctrl,UART=comm , BASE = 0 ) ; // trailing


// own line
j1:joint ( "one","two"+ctrl_ ) @( 0x80 , 0X8a );

p : pair( )@ l=( 0x1,0x2 ),@ r = 0x3 ; @ x=0x10:signed   READ( ID = 'it' , CRC,PUBLISH( 1 , 10 ) );
 all = j1 . cpos,ALL( joint ) . ^READ ;   /* last */ }
pair ( ) :@l,@r{ @l : leg( /* none */ ) ;
@r:leg(   // why
);
}
empty(){}
"""

PRETTY = """// head comment
link robots.a;
/* block
     comment */

public a(ctrl,comm) {
   TOSNET(CTRL=ctrl, UART=comm, BASE=0);  // trailing

   // own line
   j1: joint("one", "two"+ctrl_) @ (0x80,0X8a);

   p: pair() @l=(0x1,0x2), @r=0x3;
   @x = 0x10: signed READ(ID='it', CRC, PUBLISH(1,10));
   all = j1.cpos, ALL(joint).^READ;  /* last */
}
pair(): @l, @r {
   @l: leg( /* none */ );
   @r: leg(  // why
         );
}
empty() {
}
"""


def test_layout() -> None:
    assert format_text(UGLY) == PRETTY
    assert format_text(PRETTY) == PRETTY


def test_long_statements_go_on_behind_a_comma() -> None:
    addresses = ",".join(f"0x{i:X}" for i in range(60))
    text = f"public a() {{\n   x: x() @ ({addresses});\n}}\n"
    formatted = format_text(text)
    lines = formatted.splitlines()
    assert len(lines) > 4
    assert all(len(line) <= 110 for line in lines)
    assert all(line.endswith(",") and line.startswith("   ") for line in lines[1:-2])
    assert format_text(formatted) == formatted
    assert formatted.replace("\n         ", "") == text


def test_line_ends_become_one_kind() -> None:
    assert format_text("public a() {\r\n/* x\r\ny */\r}\r\n") == "public a() {\n   /* x\ny */\n}\n"


def test_nothing_stays_nothing() -> None:
    assert format_text("") == ""
    assert format_text(" \n\n") == ""
    assert format_text("// only\n") == "// only\n"


def test_syntax_errors_are_raised_with_a_report() -> None:
    with pytest.raises(SpecError, match=r"UL011") as caught:
        format_text("public a() { @x = 0x1: READ() }", "a.ul")
    assert len(caught.value.diagnostics) == 1
    with pytest.raises(SpecError, match="larger"):
        format_text(" " * 3_000_000)


def test_mistakes_of_meaning_do_not_matter() -> None:
    assert format_text("public a(){@x:READ();}") == "public a() {\n   @x: READ();\n}\n"
