# SPDX-License-Identifier: BSD-3-Clause
"""The live chart of notebooks, drawn by a real browser."""

from __future__ import annotations

import base64
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

import unitylink.jupyter

SCRIPT = "chart.js"
START = """async (source) => {
  const chart = await import('data:text/javascript;base64,' + source);
  const listeners = {};
  const angle = { name: 'j1.cpos', unit: 'deg', members: {} };
  const grip = { name: 'grip', unit: '', members: { 1: 'hold' } };
  const facts = { series: [angle, grip], window_s: 10, ended: '' };
  window.model = { get: (name) => facts[name], on: (name, call) => { listeners[name] = call; },
                   off: (name) => { delete listeners[name]; } };
  window.facts = facts;
  window.listeners = listeners;
  window.send = (numbers) => {
    const whole = new Uint8Array(8 + 8 * numbers.length);  // the message does not begin where its buffer does
    whole.set(new Uint8Array(new Float64Array(numbers).buffer), 8);
    listeners['msg:custom']({}, [new DataView(whole.buffer, 8)]);
  };
  window.ink = (band) => {
    const canvas = document.querySelector('canvas');
    const ratio = devicePixelRatio;
    const place = [200, band * 64, 500, 64].map((pixels) => pixels * ratio);
    const data = canvas.getContext('2d').getImageData(...place).data;
    const found = [];
    for (let i = 0; i < data.length / 4; i++)
      if (data[4 * i + 3] > 100) found.push([data[4 * i], Math.floor(i / place[2] / ratio)]);
    return found;
  };
  window.end = chart.default.render({ model, el: document.querySelector('#el') });
}"""


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    context = browser.new_context(device_scale_factor=2)
    made = context.new_page()
    wrong: list[str] = []
    made.on("pageerror", lambda error: wrong.append(str(error)))
    made.set_content('<div id="el" style="width: 700px; color: rgb(255, 0, 0)"></div>')
    folder = unitylink.jupyter.__path__[0]
    with open(f"{folder}/{SCRIPT}", "rb") as file:
        made.evaluate(START, base64.b64encode(file.read()).decode())
    yield made
    context.close()
    assert not wrong


def test_each_value_has_a_band_in_the_colour_of_the_page(page: Page) -> None:
    assert page.evaluate("ink(0).length") == 0
    page.evaluate("send([0, 3, 1, 5, 9, 0, 30, 0, 1, 1, 9, 1])")
    page.wait_for_function("ink(0).length > 0 && ink(1).length > 0")
    ink = page.evaluate("ink(0)")
    assert {red for red, _ in ink} == {255}
    assert min(line for _, line in ink) <= 7 and max(line for _, line in ink) >= 56, "from 30 down to 0"
    page.wait_for_function("document.querySelector('canvas').ariaLabel === 'j1.cpos: 0 deg, grip: hold'")


def test_its_end_is_said_and_nothing_is_left(page: Page) -> None:
    page.evaluate("facts.ended = 'the link has ended'; listeners['change:ended']()")
    page.get_by_text("the link has ended").wait_for()
    page.evaluate("end()")
    assert page.evaluate("Object.keys(listeners)") == []
