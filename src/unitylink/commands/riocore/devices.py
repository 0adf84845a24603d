# SPDX-License-Identifier: BSD-3-Clause
"""What plugins of devices become: sensors, LEDs, and outputs of pulses. Each kind has a function."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from .part import PartList, chunks
from .plugins import Plugin

PDM_CHANNELS_MOST, PDM_BITS_MOST, PDM_HZ = 8, 16, 1_000_000
TIMEOUT_MS_LEAST, TIMEOUT_MS_MOST = 20, 500  # of a pulse_counter with its frequency
LEDS_MOST = 4094
HX711_INPUT = "CHA_128"  # what riocore's mode is by default, and our component too


def _sonars(parts: PartList, plugins: list[Plugin]) -> None:
    for one in plugins:
        if _has_pins(parts, one, "trigger", "echo"):
            pins = {role: [parts.plain(one, role)] for role in ("trigger", "echo")}
            line = "sonar(scale=0.01715 cm, rate=10 Hz)"
            parts.add(parts.new_name(one.name), line, [f"{one.name}: in cm, as in riocore"], pins)


def _load_cells(parts: PartList, plugins: list[Plugin]) -> None:
    for one in plugins:
        if not _has_pins(parts, one, "miso", "sclk"):
            continue
        for key, default in (("zero", 0), ("scale", 1)):
            number = one.node.number(key, default)
            if number != default:
                parts.notes.append(
                    f"{one.node.place}.{key} = {number:g}: hx711 has counts of 24 bits, riocore of 21: "
                    "weigh something known, and say its scale in the spec"
                )
        if (mode := one.node.text("mode", HX711_INPUT)) != HX711_INPUT:
            parts.notes.append(
                f"{one.node.place}.mode = {mode}: hx711 begins with a_128; write the input to `control`"
            )
        pins = {"dout": [parts.plain(one, "miso")], "sck": [parts.plain(one, "sclk")]}
        parts.add(parts.new_name(one.name), "hx711(rate=10 Hz)", [f"{one.name}: in counts of 24 bits"], pins)


def _thermometers(parts: PartList, plugins: list[Plugin]) -> None:
    for one in plugins:
        if _has_pins(parts, one, "one_wire"):
            pins = {"line": [parts.plain(one, "one_wire")]}
            parts.add(parts.new_name(one.name), "one_wire(rate=1 Hz)", [], pins)


def _leds(parts: PartList, plugins: list[Plugin]) -> None:
    for one in plugins:
        if not _has_pins(parts, one, "data"):
            continue
        leds = parts.whole(one, "leds", 1, 1, LEDS_MOST)
        if (level := one.node.number("level")) is not None:
            parts.notes.append(f"{one.node.place}.level = {level:g}: a colour has its brightness; write both")
        parts.add(parts.new_name(one.name), f"ws2812(leds={leds})", [], {"data": [parts.plain(one, "data")]})


def _densities(parts: PartList, plugins: list[Plugin]) -> None:
    most = max(1, min(PDM_CHANNELS_MOST, ((parts.clock_hz - 1) // PDM_HZ + 1) // 2))  # what its @limit says
    same_bits: dict[int, list[Plugin]] = {}
    for one in plugins:
        if _has_pins(parts, one, "pdm"):
            bits = parts.whole(one, "resolution", 8, 8, 32)
            if bits > PDM_BITS_MOST:
                parts.notes.append(f"{one.node.place}.resolution = {bits}: pdm has {PDM_BITS_MOST} at most")
            same_bits.setdefault(min(bits, PDM_BITS_MOST), []).append(one)
    for bits, same in same_bits.items():
        for channels in chunks(same, most):
            comments = [f"channel {i} is {one.name}" for i, one in enumerate(channels)]
            comments.append("from 0 to 1: the share of the time for which the pin is high")
            name = parts.new_name(channels[0].name if len(channels) == 1 else "densities")
            pins = {"pins": [parts.plain(one, "pdm") for one in channels]}
            parts.add(name, f"pdm(channels={len(channels)}, bits={bits})", comments, pins)
            for one in channels:
                parts.output(one, "en", f"{one.name}_enable")


def _generators(parts: PartList, plugins: list[Plugin]) -> None:
    for one in plugins:
        if _has_pins(parts, one, "freq"):
            level = ", active_level=0" if one.pins["freq"].inverted else ""
            line = f"pulse_generator(maximum_hz=1000000{level})"
            comments = [f"{one.name}: a count/s is a Hz"]
            parts.add(parts.new_name(one.name), line, comments, {"line": [one.pins["freq"]]})


def _counters(parts: PartList, plugins: list[Plugin]) -> None:
    for one in plugins:
        if not _has_pins(parts, one, "freq"):
            continue
        least = parts.whole(one, "freq_min", 10, 1, 10_000)
        wait = math.ceil(1000 / least)
        if wait > TIMEOUT_MS_MOST:
            parts.notes.append(
                f"{one.node.place}.freq_min = {least}: pulse_counter waits {TIMEOUT_MS_MOST} ms at most"
            )
        wait = min(max(wait, TIMEOUT_MS_LEAST), TIMEOUT_MS_MOST)
        line = f"pulse_counter(timeout_ms={wait}, with_frequency=1, rate=10 Hz)"
        comments = [f"{one.name}: a count/s is a Hz, and 0 is none"]
        parts.add(parts.new_name(one.name), line, comments, {"line": [parts.plain(one, "freq")]})


def _has_pins(parts: PartList, one: Plugin, *roles: str) -> bool:
    missing = [role for role in roles if role not in one.pins]
    if missing:
        parts.leave_out(one, f"it has no pin {' and '.join(missing)}")
    return not missing


# kind of plugin -> what makes the parts of all plugins of the kind
DEVICES: Mapping[str, Callable[[PartList, list[Plugin]], None]] = {
    "sonar": _sonars,
    "hx711": _load_cells,
    "ds18b20": _thermometers,
    "wled": _leds,
    "ws2812b": _leds,
    "pdmout": _densities,
    "freqout": _generators,
    "freqin": _counters,
}
