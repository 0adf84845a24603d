# SPDX-License-Identifier: BSD-3-Clause
"""The notebooks of the examples: executed by a real kernel, and stored without outputs."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "examples").rglob("*.ipynb"))
VIEW = "application/vnd.jupyter.widget-view+json"


@pytest.fixture
def apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing of this user is read or written."""
    for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")


def shown(cell: Any) -> str:
    """Return all that a cell shows, as text."""
    parts = [text for output in cell.outputs for text in output.get("data", {}).values()]
    return "\n".join([*map(str, parts), *(output.get("text", "") for output in cell.outputs)])


def test_there_is_one() -> None:
    assert NOTEBOOKS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_stored_without_outputs(path: Path) -> None:
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "clear its outputs"
    assert set(book.metadata) == {"kernelspec", "language_info"}


def test_the_scara(apart: None) -> None:
    path = ROOT / "examples" / "notebook" / "arm.ipynb"
    book = nbformat.read(path, as_version=4)
    client = NotebookClient(book, resources={"metadata": {"path": str(path.parent)}}, timeout=60)
    names: dict[str, list[str]] = {}

    async def run() -> None:
        async with client.async_setup_kernel():
            assert client.kc is not None
            for number, cell in enumerate(book.cells):
                await client.async_execute_cell(cell, number)
                if number == 1:
                    for text in ("robot.j1.", 'robot["j1.', "robot.j1.pos_sp.wri"):
                        reply = await client.kc.complete(text, reply=True, timeout=30)
                        names[text] = reply["content"]["matches"]

    with ThreadPoolExecutor(1) as apart_from_other_loops:  # a browser of the tests keeps one in this thread
        apart_from_other_loops.submit(lambda: asyncio.run(run())).result()
    robot, part, chart, moved, refused, snapshot, link, _ = (
        shown(cell) for cell in book.cells if cell.cell_type == "code"
    )
    assert "<td" in robot and "j4.cpos" in robot and "-150 to 150" in robot and "deg/s" in robot
    assert "j1.spd_sp" in part and "j2" not in part
    assert VIEW in book.cells[5].outputs[0].data, chart
    assert "deg" in moved and "READ" in moved
    assert "j1.pos_sp" in refused and "150" in refused
    assert abs(float(snapshot) - 45) <= 0.2
    assert "framed" in link and "requests" in link
    assert any(name.endswith("cpos") for name in names["robot.j1."])
    assert any("j1.cpos" in name for name in names['robot["j1.'])
    assert any(name.endswith("write") for name in names["robot.j1.pos_sp.wri"])
