# SPDX-License-Identifier: BSD-3-Clause
"""Recordings and their replay, alarms, groups, favourites, layouts as files, and the robot, in Chromium."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from unit.dashboard.robot import Robot, robot

from unitylink.recording import samples
from unitylink.server.rate_limit import RateLimit
from unitylink.spec import compile_text

Open = Callable[..., Page]
Shoot = Callable[[Page, str], None]
SPEC = """
public arm() {
   @heat = 0x10: i16 READ(UNIT="degC", MIN=-20, MAX=80, PUBLISH(50 Hz));
   @left = 0x20: i16 WRITE(UNIT="mm", MIN=0, MAX=100, SAFE=0);
   @right = 0x21: i16 WRITE(UNIT="mm", MIN=0, MAX=100, SAFE=0);
   pair = left, right;
}
"""


@pytest.fixture
def oven() -> Iterator[Robot]:
    result = compile_text(SPEC, "arm.ul")
    assert result.spec is not None, result.diagnostics
    with robot(spec=result.spec) as served:
        served.page.app.logins = RateLimit(1000, 1000)
        yield served


def test_a_recording_is_made_replayed_and_saved(
    open_page: Open, arm: Robot, shoot: Shoot, tmp_path: Path
) -> None:
    page = open_page("owner", "charts=j1.cpos,j1.spd/5")
    arm.page.station.desk.robot["j1.spd_sp"].write(90)  # type: ignore[union-attr]
    arm.page.station.desk.robot["j1.pos_sp"].write(60)  # type: ignore[union-attr]
    card = page.locator("details.recordings")
    card.locator("summary").click()
    card.get_by_role("button", name="record").click()
    expect(card.get_by_role("status")).to_contain_text(
        re.compile(r"owner records: [1-9]\d* s, \d{2,} samples")
    )
    card.get_by_role("button", name="end the recording").click()
    (kept,) = arm.page.station.records.shelf.all()
    with page.expect_download() as saved:
        card.get_by_role("link", name=f"save {kept.name}").click()
    saved.value.save_as(tmp_path / kept.name)
    found = list(samples(tmp_path / kept.name))
    assert "j1.cpos" in found[0].values or "j1.cpos" in found[1].values
    card.get_by_role("button", name=f"replay {kept.name}").click()
    player = page.get_by_role("region", name="replay", exact=True)
    expect(player).to_contain_text("REPLAY, not live")
    player.get_by_role("button", name="pause").click()
    place = player.get_by_role("slider", name="place in the replay")
    place.focus()
    page.keyboard.press("End")
    chart = page.get_by_role("region", name=re.compile("^chart of"))
    expect(chart.locator(".legend")).to_contain_text("REPLAY")
    last = [sample.values["j1.cpos"] for sample in found if "j1.cpos" in sample.values][-1]
    expect(chart.locator(".legend b").first).to_have_text(f"{last:.2f}")
    expect(chart.get_by_role("button", name="CSV")).to_be_disabled()
    shoot(page, "dashboard-replay")
    player.get_by_role("button", name="back to live").click()
    expect(player).to_be_hidden()
    expect(chart.locator(".legend")).not_to_contain_text("REPLAY")
    card.get_by_role("button", name=f"delete {kept.name}").click()
    page.get_by_role("dialog").get_by_role("button", name="yes").click()
    expect(card.get_by_role("button", name="replay")).to_have_count(0)


def test_an_alarm_is_shown_and_acknowledged(open_page: Open, oven: Robot, shoot: Shoot) -> None:
    page = open_page("cem")
    oven.board.registers[0x10] = 95
    alarms = page.get_by_role("region", name="alarms")
    expect(alarms).to_contain_text("heat is above 80 degC, up to 95 degC")
    expect(page.get_by_role("alert").filter(has_text="alarm: heat")).to_be_visible()
    oven.board.registers[0x10] = 20
    expect(alarms).to_contain_text("heat was above 80")
    shoot(page, "dashboard-alarm")
    alarms.get_by_role("button", name="acknowledge the alarm of heat").click()
    expect(alarms).to_be_hidden()
    page.get_by_label("kind of events").select_option("alarm")
    expect(page.get_by_label("events, the newest first").get_by_role("listitem")).to_have_count(1)
    page.get_by_label("search the events").fill("nothing like it")
    expect(page.get_by_label("events, the newest first").get_by_role("listitem")).to_have_count(0)


def test_a_group_is_written_at_once(open_page: Open, oven: Robot) -> None:
    page = open_page("cem")
    page.get_by_role("button", name="take control").click()
    group = page.locator("details.group")
    expect(group).to_contain_text("mm")
    group.get_by_label("left in the group").fill("30")
    group.get_by_label("right in the group").fill("40")
    group.get_by_role("button", name="write pair").click()
    expect(group.get_by_label("left in the group")).to_have_value("")
    assert (oven.board.registers[0x20], oven.board.registers[0x21]) == (30, 40)
    assert len(oven.log.until("write", values={"left": 30, "right": 40})) == 1


def test_favourites_and_the_layout_as_a_file(open_page: Open, arm: Robot, tmp_path: Path) -> None:
    page = open_page("owner", "charts=j1.cpos/5")
    page.get_by_role("button", name="favourite grip").click()
    expect(
        page.get_by_role("region", name="favourites").get_by_role("row", name=re.compile("grip"))
    ).to_be_visible()
    assert "favourites=grip" in page.url
    with page.expect_download() as saved:
        page.get_by_role("button", name="save layout").click()
    assert saved.value.suggested_filename == "arm-layout.json"
    file = tmp_path / "layout.json"
    saved.value.save_as(file)
    other = open_page("ben", "charts=j4.spd/2")
    take = other.get_by_label("file with a layout")
    take.set_input_files(file)
    expect(other.get_by_role("region", name="chart of j1.cpos")).to_be_visible()
    assert "charts=j1.cpos/5&favourites=grip" in other.url
    for text in ("no json", "[]", '{"unitylink_layout": 2}', '{"unitylink_layout": 1, "charts": 5}'):
        file.write_text(text)
        take.set_input_files(file)
        expect(other.get_by_role("alert").filter(has_text="the file is no layout").first).to_be_visible()
    file.write_text('{"unitylink_layout": 1, "charts": [null, {"paths": [5, "j2.cpos"], "window_s": "x"}]}')
    take.set_input_files(file)
    expect(other.get_by_role("region", name="chart of j2.cpos")).to_be_visible()


def ink(page: Page) -> list[int]:
    """Return how many pixels of the robot have the colour of its paint, and their sum of columns."""
    image = page.locator("canvas.robot").screenshot()
    found: list[int] = page.evaluate(
        """async (text) => {
            const bytes = Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
            const image = await createImageBitmap(new Blob([bytes]));
            const canvas = new OffscreenCanvas(image.width, image.height);
            const context = canvas.getContext("2d");
            context.drawImage(image, 0, 0);
            const { data } = context.getImageData(0, 0, image.width, image.height);
            let [count, columns] = [0, 0];
            for (let at = 0; at < data.length; at += 4)
              if (data[at + 1] - data[at] > 25) {
                count++;
                columns += (at / 4) % image.width;
              }
            return [count, columns];
        }""",
        base64.b64encode(image).decode(),
    )
    return found


@pytest.mark.usefixtures("shape")
def test_the_robot_moves_and_is_told_in_words(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    page = open_page("owner", "charts=j1.cpos/5")
    view = page.get_by_role("img", name=re.compile("^arm: arrows turn"))
    expect(view).to_be_visible()
    page.get_by_text("joints and tips in numbers").click()
    table = page.get_by_role("region", name="joints and tips")
    expect(table.get_by_role("row", name=re.compile("^shoulder"))).to_contain_text("0.0°")
    expect(table.get_by_role("row", name=re.compile("^tip"))).to_contain_text("at 0.450, 0.000, 0.170 m")
    assert ink(page)[0] > 500
    arm.page.station.desk.robot["j1.spd_sp"].write(400)  # type: ignore[union-attr]
    arm.page.station.desk.robot["j1.pos_sp"].write(90)  # type: ignore[union-attr]
    expect(table.get_by_role("row", name=re.compile("^shoulder"))).to_contain_text("90.0°")
    expect(table.get_by_role("row", name=re.compile("^tip"))).to_contain_text("at 0.000, 0.450, 0.170 m")
    turned = ink(page)
    view.focus()
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    page.wait_for_timeout(200)
    assert ink(page) != turned, "it is seen from elsewhere"
    page.keyboard.press("Home")
    page.wait_for_timeout(200)
    assert ink(page) == turned
    shoot(page, "dashboard-robot")


@pytest.mark.usefixtures("shape")
def test_without_webgl_the_words_are_there(browser: Browser, arm: Robot) -> None:
    context = browser.new_context()
    try:
        page = context.new_page()
        page.add_init_script(
            "HTMLCanvasElement.prototype.getContext = ((before) => function (kind, ...all) {"
            " return kind === 'webgl2' ? null : before.call(this, kind, ...all); })"
            "(HTMLCanvasElement.prototype.getContext)"
        )
        page.goto(f"{arm.page.url}/#token=owner")
        expect(page.get_by_text("this browser has no WebGL 2; the table has the joints")).to_be_visible()
        page.get_by_text("joints and tips in numbers").click()
        expect(page.get_by_role("region", name="joints and tips")).to_contain_text("shoulder")
    finally:
        context.close()
