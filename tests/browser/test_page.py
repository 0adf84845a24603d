# SPDX-License-Identifier: BSD-3-Clause
"""What a person sees and does at the page, in Chromium."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect
from unit.dashboard.robot import Robot
from unit.modules import module_of

from unitylink.simulate import Board, BoardConfiguration, load_plant
from unitylink.spec import load

Open = Callable[..., Page]
ROOT = Path(__file__).resolve().parents[2]
ARM = ROOT / "examples" / "dashboard" / "arm.ul"
Shoot = Callable[[Page, str], None]
TARGET, SPEED = 0x8C, 0x94  # of the first joint


def box(page: Page, path: str) -> Any:
    return page.get_by_label(f"new value of {path},")


def take_control(page: Page) -> None:
    page.get_by_role("button", name="take control").click()
    expect(page.get_by_role("status", name="who controls what")).to_contain_text("the whole robot: you")


def value_of(page: Page, part: str, name: str) -> Any:
    """Return the cell with the value of an item."""
    rows = page.get_by_role("table", name=f"values of {part}").get_by_role("row")
    return rows.filter(has=page.get_by_role("rowheader", name=name, exact=True)).locator(".value")


def test_values_come_and_a_write_moves_the_joint(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    page = open_page()
    assert "token" not in page.url
    assert page.title() == "Unity-Link: arm"
    expect(value_of(page, "j1", "cpos")).to_have_text("0.00 deg")
    expect(box(page, "j1.pos_sp")).to_be_disabled()
    take_control(page)
    box(page, "j1.spd_sp").fill("300")
    box(page, "j1.spd_sp").press("Enter")
    expect(value_of(page, "j1", "spd_sp")).to_have_text("300.00 deg/s")
    box(page, "j1.pos_sp").fill("45")
    box(page, "j1.pos_sp").press("Enter")
    expect(value_of(page, "j1", "cpos")).to_have_text("45.00 deg")
    assert arm.board.registers[TARGET] == 4500
    box(page, "j1.pos_sp").fill("151")
    box(page, "j1.pos_sp").press("Enter")
    expect(page.get_by_role("alert").filter(has_text="151")).to_contain_text("is not in -150 to 150 deg")
    assert arm.board.registers[TARGET] == 4500


def test_a_slider_by_keyboard_and_values_written_together(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    page = open_page()
    take_control(page)
    slider = page.get_by_role("slider", name="set j3.pos_sp")
    slider.focus()
    for _ in range(3):
        page.keyboard.press("PageUp")
    expect(value_of(page, "j3", "pos_sp")).not_to_have_text("0.00 mm")
    for joint, speed in (("j1", "100"), ("j2", "150"), ("j3", "80")):
        box(page, f"{joint}.spd_sp").fill(speed)
    region = page.get_by_role("region", name="values to be written together")
    expect(region).to_contain_text("j1.spd_sp = 100, j2.spd_sp = 150, j3.spd_sp = 80")
    shoot(page, "dashboard-together")
    region.get_by_role("button", name="write 3 together").click()
    expect(region).to_be_hidden()
    assert [arm.board.registers[SPEED + joint] for joint in range(3)] == [10000, 15000, 8000]
    arm.log.until("write", values={"j1.spd_sp": 100, "j2.spd_sp": 150, "j3.spd_sp": 80})


def test_a_question_where_the_spec_says_so(open_page: Open, arm: Robot) -> None:
    page = open_page()
    take_control(page)
    page.get_by_label("set grip").select_option("hold")
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("Open or close the gripper?")
    dialog.get_by_role("button", name="no").click()
    assert arm.board.registers[0x99] == 0
    page.get_by_label("set grip").select_option("hold")
    dialog.get_by_role("button", name="yes").click()
    expect(page.get_by_role("rowheader", name="grip").locator("xpath=../td[1]")).to_have_text("hold")
    assert arm.board.registers[0x99] == 1
    page.get_by_role("switch", name="lamp").click()
    expect(page.get_by_role("switch", name="lamp")).to_be_checked()


def test_stop_by_button_and_by_key(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    page, other = open_page(), open_page("ben")
    take_control(page)
    box(page, "j1.spd_sp").fill("20")
    box(page, "j1.spd_sp").press("Enter")
    box(page, "j1.pos_sp").fill("120")
    box(page, "j1.pos_sp").press("Enter")
    expect(value_of(page, "j1", "spd")).to_have_text("20.00 deg/s")
    other.get_by_role("button", name="STOP").click()  # who may only look may stop, too
    expect(page.get_by_role("status").filter(has_text="stopped by")).to_contain_text("stopped by ben")
    expect(value_of(page, "j1", "spd")).to_have_text("0.00 deg/s")
    assert arm.board.registers[SPEED] == 0
    expect(box(page, "j1.pos_sp")).to_be_disabled()
    shoot(page, "dashboard-stopped")
    page.get_by_role("button", name="go on").click()
    expect(page.locator(".stop p")).not_to_contain_text("stopped by")
    take_control(page)
    box(page, "j1.spd_sp").fill("20")
    box(page, "j1.spd_sp").press("Enter")
    expect(value_of(page, "j1", "spd")).to_have_text("20.00 deg/s")
    page.keyboard.press("Escape")
    page.keyboard.press("Escape")
    expect(value_of(page, "j1", "spd")).to_have_text("0.00 deg/s")
    assert arm.board.registers[SPEED] == 0


def test_the_stop_works_while_the_socket_is_stuck(open_page: Open, arm: Robot) -> None:
    page = open_page()
    take_control(page)
    box(page, "j1.spd_sp").fill("20")
    box(page, "j1.spd_sp").press("Enter")
    expect(value_of(page, "j1", "spd_sp")).to_have_text("20.00 deg/s")
    for viewer in list(arm.page.station.viewers):  # it takes no request any more, and sends nothing
        viewer._do.clear()  # type: ignore[attr-defined]
        viewer._send = None  # type: ignore[attr-defined]
        viewer.wake = lambda: None  # type: ignore[method-assign]
    page.get_by_role("button", name="STOP").click()
    expect(page.locator(".stop p")).to_contain_text("SAFE values written")
    assert arm.board.registers[SPEED] == 0


def test_control_goes_from_one_person_to_another(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    cem, owner = open_page("cem"), open_page("owner")
    take_control(cem)
    box(cem, "j1.spd_sp").fill("30")
    box(cem, "j1.spd_sp").press("Enter")
    expect(value_of(cem, "j1", "spd_sp")).to_have_text("30.00 deg/s")
    who = owner.get_by_role("status", name="who controls what")
    expect(who).to_contain_text("the whole robot: cem")
    owner.get_by_role("button", name="take control").click()
    expect(owner.get_by_role("alert").filter(has_text="cem")).to_contain_text("cem holds the write lease")
    owner.get_by_role("button", name="ask for it").click()
    holds = cem.get_by_role("status", name="who controls what")
    expect(holds).to_contain_text("the whole robot: you (owner wants it)")
    owner.get_by_role("button", name="take away").click()
    owner.get_by_role("dialog").get_by_role("button", name="yes").click()
    expect(who).to_have_text("")
    assert arm.board.registers[SPEED] == 0, "the outputs are safe before anybody else has them"
    expect(box(cem, "j1.spd_sp")).to_be_disabled()
    take_control(owner)
    expect(cem.get_by_role("status", name="who controls what")).to_contain_text("owner")
    owner.close()  # and a page that is gone loses control
    expect(cem.get_by_role("status", name="who controls what")).to_have_text("")


def test_a_program_and_two_people_share_the_robot(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    """What `make demo-serve` shows: the robot moves by itself, and people look, take over and give back."""
    demo = module_of(ROOT / "examples" / "dashboard" / "run.py")
    demo.POLITE_S = 0.2
    waits = threading.Event()  # the program, for as long as a person needs to take control

    class Patient(demo.Mover):  # type: ignore[misc]
        def step(self) -> float:
            return demo.POLITE_S if waits.is_set() and not self._holds() else super().step()

    demo.Mover = Patient
    layout = "charts=j1.cpos,j1.pos_sp,j2.cpos/10;j3.cpos/10"
    page, other = open_page("owner", layout), open_page("ben", "charts=j2.spd/5")
    stop = threading.Event()
    mover = threading.Thread(target=demo.move, args=(arm.page.station.desk, "cem", stop))
    mover.start()
    try:
        for one in (page, other):
            expect(one.get_by_role("status", name="who controls what")).to_contain_text("robot: cem")
        expect(value_of(other, "j2", "spd")).not_to_have_text("0.00 deg/s")
        page.wait_for_timeout(6000 if os.environ.get("UPDATE_SCREENS") else 0)
        shoot(page, "dashboard")
        waits.set()
        page.get_by_role("button", name="take away").click()
        page.get_by_role("dialog").get_by_role("button", name="yes").click()
        take_control(page)
        waits.clear()  # from now on the program asks again and again, and is refused
        expect(value_of(page, "j1", "spd")).to_have_text("0.00 deg/s")
        page.get_by_role("button", name="give back").click()
        who = page.get_by_role("status", name="who controls what")
        expect(who).to_contain_text("robot: cem", timeout=15_000)
        expect(value_of(page, "j2", "spd")).not_to_have_text("0.00 deg/s")
        other.get_by_role("button", name="STOP").click()
        expect(value_of(page, "j2", "spd")).to_have_text("0.00 deg/s")
    finally:
        stop.set()
        mover.join()


def test_charts_are_drawn_frozen_zoomed_and_kept_in_the_url(
    open_page: Open, arm: Robot, shoot: Shoot
) -> None:
    page = open_page("owner", "charts=j1.cpos,j2.cpos/5;j1.spd/2")
    charts = page.get_by_role("region", name=re.compile("^chart of"))
    expect(charts).to_have_count(2)
    take_control(page)
    for joint in ("j1", "j2"):
        box(page, f"{joint}.spd_sp").fill("90")
        box(page, f"{joint}.spd_sp").press("Enter")
        box(page, f"{joint}.pos_sp").fill("70")
        box(page, f"{joint}.pos_sp").press("Enter")
    expect(value_of(page, "j2", "cpos")).to_have_text("70.00 deg")
    for _ in range(100):  # a busy machine draws late
        if painted(page, 0) > 500:
            break
        page.wait_for_timeout(100)
    else:
        raise AssertionError("no lines are drawn")
    shoot(page, "dashboard-charts")
    first = charts.nth(0)
    first.get_by_role("button", name="freeze").click()
    before = first.locator("canvas").screenshot()
    page.wait_for_timeout(400)
    assert first.locator("canvas").screenshot() == before, "it stands still"
    first.locator("div.plot").focus()
    page.keyboard.press("+")
    page.wait_for_timeout(300)
    assert first.locator("canvas").screenshot() != before, "it is zoomed"
    assert painted(page, 0) > 100
    first.get_by_role("button", name="table").click()
    expect(first.get_by_role("row", name=re.compile(r"^j1\.cpos"))).to_contain_text("deg")
    with page.expect_download() as saved:
        first.get_by_role("button", name="CSV").click()
    assert saved.value.suggested_filename == "values.csv"
    first.get_by_role("button", name="live").click()
    page.get_by_role("button", name="plot j3.cpos").click()
    assert "charts=j1.cpos,j2.cpos,j3.cpos/5;j1.spd/2" in page.url
    first.get_by_role("button", name="remove the chart").click()
    expect(charts).to_have_count(1)
    page.reload()
    expect(charts).to_have_count(1)
    assert "charts=j1.spd/2" in page.url


def painted(page: Page, chart: int) -> int:
    """Return how many pixels of a chart have a colour that text and grid do not have."""
    count: int = page.evaluate(
        """(chart) => {
            const canvas = document.querySelectorAll(".chart canvas")[chart];
            const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
            let count = 0;
            for (let at = 0; at < data.length; at += 4) {
              const [red, green, blue, alpha] = data.slice(at, at + 4);
              if (alpha > 200 && Math.max(red, green, blue) - Math.min(red, green, blue) > 60) count++;
            }
            return count;
        }""",
        chart,
    )
    return count


@pytest.mark.long
def test_a_value_is_dragged_into_a_chart(open_page: Open) -> None:
    page = open_page("owner", "charts=j1.cpos/5")
    chart = page.get_by_role("region", name="chart of j1.cpos")
    source = page.get_by_role("table", name="values of j2").get_by_role("rowheader", name="cpos", exact=True)
    source.drag_to(chart)
    expect(page.get_by_role("region", name="chart of j1.cpos, j2.cpos")).to_be_visible()


def test_the_link_is_cut_and_comes_back(open_page: Open, wired: Robot, shoot: Shoot) -> None:
    page = open_page()
    expect(page.locator(".pulse")).to_have_text("● live")
    spec, port = load(ARM), wired.board.url.rpartition(":")[2]
    wired.board.close()
    expect(page.locator(".pulse")).to_have_text("⚠ link down")
    expect(page.get_by_role("table", name="values of j1").locator(".old").first).to_contain_text("s old")
    shoot(page, "dashboard-cut")
    plant = load_plant("scara", spec)
    with Board(spec, configuration=BoardConfiguration.for_spec(spec), plant=plant, endpoint=f"tcp:{port}"):
        expect(page.locator(".pulse")).to_have_text("● live")
        expect(page.get_by_label("events, the newest first")).to_contain_text("back")
        wired.link.close()


def test_the_server_goes_and_the_page_says_so(open_page: Open, arm: Robot) -> None:
    page = open_page()
    expect(page.locator(".pulse")).to_contain_text("live")
    arm.page.close()
    expect(page.get_by_role("alert").filter(has_text="no connection")).to_contain_text("All values are old")
    expect(page.locator(".pulse")).to_contain_text("are old")
    page.get_by_role("button", name="STOP").click()
    expect(page.locator(".stop .bad")).to_contain_text("NOT STOPPED: the server does not answer")


def test_a_phone(open_page: Open, arm: Robot, shoot: Shoot) -> None:
    page = open_page(viewport={"width": 412, "height": 839}, has_touch=True, is_mobile=True)
    take_control(page)
    box(page, "j1.spd_sp").fill("50")
    page.keyboard.press("Enter")
    expect(value_of(page, "j1", "spd_sp")).to_have_text("50.00 deg/s")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (
        "nothing is cut off at the side"
    )
    page.evaluate("scrollTo(0, 0)")
    shoot(page, "dashboard-phone")
    page.get_by_role("button", name="STOP").tap()  # in reach wherever the page has been scrolled to
    expect(page.locator(".stop p")).to_contain_text("stopped")
    small = page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, summary")].filter((one) => {
            const { width, height } = one.getBoundingClientRect();
            return width > 0 && (height < 24 || width < 24);
        }).map((one) => one.outerHTML.slice(0, 80))"""
    )
    assert small == []


@pytest.mark.usefixtures("shape")
@pytest.mark.parametrize(
    ("scheme", "width"), [("light", 1280), pytest.param("dark", 1280, marks=pytest.mark.long), ("dark", 412)]
)
def test_accessibility(open_page: Open, arm: Robot, shoot: Shoot, scheme: Any, width: int) -> None:
    """The rules of axe-core for WCAG 2.2 AA, on the page with everything open."""
    page = open_page(
        "owner",
        "charts=j1.cpos,j2.cpos/5&favourites=grip,j1.cpos",
        viewport={"width": width, "height": 900},
        color_scheme=scheme,
    )
    arm.page.station.records.begin(next(iter(arm.page.station.viewers)).client, ".csv")
    take_control(page)
    page.locator("details.recordings summary").click()
    page.get_by_text("joints and tips in numbers").click()
    expect(page.locator("details.recordings").get_by_role("status")).to_contain_text("owner records")
    page.get_by_role("button", name="table").click()
    for joint in ("j1", "j2"):
        box(page, f"{joint}.pos_sp").fill("12")
    page.wait_for_timeout(500)
    shoot(page, f"dashboard-{scheme}-{width}")
    page.evaluate((ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js").read_text("utf-8"))
    tags = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
    found = page.evaluate("(tags) => axe.run({ runOnly: tags })", tags)
    wrong = [(one["id"], [node["html"][:120] for node in one["nodes"]]) for one in found["violations"]]
    assert wrong == []
    assert len(found["passes"]) > 15


@pytest.mark.long
@pytest.mark.usefixtures("shape")
def test_everything_can_be_reached_by_tab(open_page: Open) -> None:
    page = open_page("owner", "charts=j1.cpos/5")
    take_control(page)
    reached = set()
    for _ in range(160):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "document.activeElement.getAttribute('aria-label') ?? document.activeElement.innerText"
            )
        )
    wanted = {
        "STOP",
        "set j1.pos_sp",
        "plot j4.spd",
        "favourite j1.cpos",
        "turn left",
        "save layout",
        "set grip",
        "lamp",
        "give back",
        "freeze",
        "CSV",
    }
    assert wanted <= {str(one).strip() for one in reached}
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid", "it shows where"


def test_a_foreign_page_cannot_use_the_server(browser: Browser, arm: Robot) -> None:
    """A page of evil.test, whose name points to this machine."""
    port = arm.host.rpartition(":")[2]
    context = browser.new_context()
    try:
        page = context.new_page()
        answer = page.goto(f"http://evil.test:{port}/")
        assert answer is not None and answer.status == 403
        closed = page.evaluate(
            """(port) => new Promise((done) => {
                const socket = new WebSocket(`ws://127.0.0.1:${port}/socket`);
                socket.onopen = () => done("open");
                socket.onerror = () => done("refused");
            })""",
            port,
        )
        assert closed == "refused"
    finally:
        context.close()


def test_a_wrong_token_and_then_the_right_one(browser: Browser, arm: Robot) -> None:
    context = browser.new_context()
    try:
        page = context.new_page()
        page.goto(f"{arm.page.url}/#token=guess")
        expect(page.get_by_role("alert")).to_contain_text("does not know this token")
        page.get_by_label("Token").fill("ana")
        page.get_by_role("button", name="log in").click()
        expect(page.get_by_role("heading", name="arm")).to_be_visible()
        page.get_by_role("button", name="log out").click()
        expect(page.get_by_label("Token")).to_be_visible()
        assert context.cookies() == []
    finally:
        context.close()
