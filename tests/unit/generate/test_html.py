# SPDX-License-Identifier: BSD-3-Clause
"""The register map runs in a JavaScript engine. dom.js gives it the few parts of a browser that it needs."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from pathlib import Path
from typing import Any

import pytest
import quickjs

from unitylink import cli
from unitylink.generate import generate
from unitylink.spec import Spec, compile_text, load

ROOT = Path(__file__).resolve().parents[3]
DOM = (Path(__file__).parent / "dom.js").read_text("utf-8")


def page_of(spec: Spec) -> str:
    ((name, text),) = generate(spec, "html").items()
    assert name == f"{spec.name}.html"
    return text


def spec_of(text: str) -> Spec:
    result = compile_text(text, "robot.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def parts(page: str) -> tuple[str, str]:
    """Return the model's JSON and the script as a browser finds them."""
    found = re.fullmatch(
        r'.*<script type="application/json" id="model">(.*?)</script>\s*'
        r"<script>(.*?)</script>\s*</body>\s*</html>\s*",
        page,
        re.DOTALL,
    )
    assert found is not None
    return found[1], found[2]


def run(spec: Spec) -> quickjs.Context:
    """Return an engine in which the page of a spec has started."""
    model, script = parts(page_of(spec))
    context = quickjs.Context()
    context.set("MODEL", model)
    context.eval(DOM)
    context.eval(script)
    return context


def ask(context: quickjs.Context, expression: str) -> Any:
    return json.loads(context.eval(f"JSON.stringify({expression})"))


@pytest.fixture(scope="module")
def scara() -> quickjs.Context:
    return run(load(ROOT / "examples" / "scara" / "scara.ul"))


def test_all_registers_are_shown(scara: quickjs.Context) -> None:
    spec = load(ROOT / "examples" / "scara" / "scara.ul")
    assert ask(scara, "shownRows()") == [path for path, _ in spec.walk()]
    assert spec.hash in ask(scara, "ids.facts.textContent")
    assert "joint 3:cpos" in ask(scara, "rowOf('j3.cpos').textContent")
    assert "0x008A" in ask(scara, "rowOf('j3.cpos').textContent")


SEARCHES = {
    "cpos": ["j1.cpos", "j2.cpos", "j3.cpos", "j4.cpos"],
    "0x88": ["j1.cpos"],
    "J2 write": ["j2.pos_sp", "j2.spd_sp"],
    "joint 4:spd_SP": ["j4.spd_sp"],
    "nothing like it": [],
}


@pytest.mark.parametrize("words", SEARCHES)
def test_search(scara: quickjs.Context, words: str) -> None:
    ask(scara, f"type(ids.search, {json.dumps(words)}) ?? 0")
    assert ask(scara, "shownRows()") == SEARCHES[words]
    ask(scara, "type(ids.search, '') ?? 0")
    assert len(ask(scara, "shownRows()")) == 16


def test_boxes_convert_both_ways(scara: quickjs.Context) -> None:
    """Signed words: each box follows the other, and bits can be clicked.

    Nonsense is reported and changes nothing.
    """
    assert ask(scara, "boxes('j1.cpos').map((box) => box.value)") == ["0x00000000", "0"]
    ask(scara, "type(boxes('j1.cpos')[1], '-2') ?? 0")
    assert ask(scara, "boxes('j1.cpos')[0].value") == "0xFFFFFFFE"
    ask(scara, "type(boxes('j1.cpos')[0], '0x7F') ?? 0")
    assert ask(scara, "boxes('j1.cpos')[1].value") == "127"
    ask(scara, "opened('j1.cpos').querySelectorAll('button')[0].fire('click') ?? 0")
    assert ask(scara, "boxes('j1.cpos').map((box) => box.value)") == ["0x8000007F", str(0x7F - (1 << 31))]
    ask(scara, "type(boxes('j1.cpos')[1], '2147483648') ?? 0")
    assert ask(scara, "boxes('j1.cpos')[1].classList.contains('wrong')")
    assert "-2147483648 to 2147483647" in ask(scara, "opened('j1.cpos').textContent")
    assert ask(scara, "boxes('j1.cpos')[0].value") == "0x8000007F"


@pytest.fixture(scope="module")
def arm() -> quickjs.Context:
    return run(load(Path(__file__).parent / "rich" / "arm.ul"))


def test_fields_enumerations_and_units_convert(arm: quickjs.Context) -> None:
    """Packed bits: there is a raw box and a box for each field. The word is put together from all of them."""
    values = "boxes('j[1].state').map((box) => box.value)"
    assert ask(arm, values) == ["0x0000", "false", "idle", "0", "0"]
    ask(arm, "type(boxes('j[1].state')[2], 'stop') ?? 0")
    ask(arm, "type(boxes('j[1].state')[3], '-2.5') ?? 0")
    assert ask(arm, values) == ["0x0FB6", "false", "stop", "-2.5", "0"]
    ask(arm, "type(boxes('j[1].state')[0], '0x1005') ?? 0")
    # 2 is no mode, so it is reported and not shown as another one
    assert ask(arm, values) == ["0x1005", "true", "", "0", "1"]
    assert ask(arm, "boxes('j[1].state')[2].classList.contains('wrong')")
    assert ask(arm, "boxes('j[0].torque').map((box) => box.value)") == ["0x0000", "0"]
    ask(arm, "type(boxes('j[0].torque')[1], '50 N m') ?? 0")
    assert ask(arm, "boxes('j[0].torque')[0].value") == "0x1400"  # the value saturates at 20
    assert "-20 to 20 N m, saturates" in ask(arm, "opened('j[0].torque').textContent")
    assert ask(arm, "boxes('gain').map((box) => box.value)") == ["0x3FC00000", "1.5"]  # it starts at INITIAL


def test_everything_of_the_language_is_shown(arm: quickjs.Context) -> None:
    page = ask(arm, "ids.map.textContent")
    for text in (
        "Three joints and a lamp.",
        "Angle of the motor's shaft.",
        "100 Hz, pose",
        "brakes on",
        "0x0012…13",
    ):
        assert text in page
    assert "a read changes it" in ask(arm, "opened('lost').textContent")
    ask(arm, "type(ids.search, 'rad jointstate') ?? 0")
    assert ask(arm, "shownRows()") == []
    ask(arm, "type(ids.search, 'rad shaft') ?? 0")
    assert ask(arm, "shownRows()") == ["j[0].pos", "j[1].pos", "j[2].pos"]
    ask(arm, "type(ids.search, '') ?? 0")


def test_nothing_from_a_spec_is_read_as_html() -> None:
    hostile = "</script><script>alert(1)</script><!-- <img src=x onerror=alert(2)> \\u2028 ]]> {{ script }}"
    spec = spec_of(f'public a() {{ @x = 0x1: READ(ID="{hostile}"); }}')
    page = page_of(spec)
    assert page.count("<script") == 2 and page.count("</script") == 2
    assert "<img" not in page and "<!-- <" not in page
    context = run(spec)
    shown = spec.root().elements[0].display
    assert ask(context, "rowOf('x').children[6].textContent") == shown


def test_page_loads_nothing_and_runs_only_its_own_script() -> None:
    page = page_of(load(ROOT / "examples" / "scara" / "scara.ul"))
    _, script = parts(page)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    assert f'content="{policy}"' in page
    assert not re.search(r"""(?:src|href)=["']?(?:https?:)?//|@import|url\(""", page)


def test_command_writes_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = str(ROOT / "examples" / "scara" / "scara.ul")
    assert cli.main(["map", spec, "--out", str(tmp_path), "--no-open"]) == 0
    assert (tmp_path / "scara.html").read_text("utf-8") == page_of(load(spec))
    assert cli.main(["map", spec, "--out", str(tmp_path), "--no-open"]) == 0
    assert "already up to date" in capsys.readouterr().out
