# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink record --lerobot`: an episode of a data set for LeRobot."""

from __future__ import annotations

import re
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from unitylink.errors import LinkError, UnityLinkError

from .failure import Failure
from .link_option import Target
from .names import Item
from .output import print_json
from .sampling_options import sampled_items

if TYPE_CHECKING:
    from unitylink.recording.lerobot_layout import Layout
    from unitylink.simulate.plants.mujoco.looks import Looks

_GATHER_S, _HOLD_S = 0.02, 1.0  # as for a file
_NUMBERS = ("int", "uint", "fixed", "ufixed", "float", "bool")


def record_episode(
    target: Target,
    names: Sequence[str],
    folder: str,
    *,
    rate_hz: float,
    task: str,
    count: int | None,
    duration_s: float | None,
    as_json: bool,
    cameras: Sequence[str] = (),
) -> int:
    """Record until Ctrl-C, `count` samples or `duration_s`, and save the episode. Return the exit code."""
    from unitylink.recording.frames import Frames
    from unitylink.recording.lerobot_dataset import LerobotDataset

    from .sampler import Sampler

    if rate_hz != round(rate_hz):
        raise Failure(f"--rate {rate_hz:g}: the frames a second of a data set are a whole number", "round it")
    items = _numbers(sampled_items(target, names, "record", set_points=True))
    sizes = dict(_size(camera) for camera in cameras)
    looks = _looks(target, sizes) if sizes else None
    layout = replace(_layout(target, items, round(rate_hz)), cameras=tuple(sizes.items()))
    dataset = LerobotDataset(folder, layout, _origin(target, items))
    sampler = Sampler(target.link, items, rate_hz, gather_s=_GATHER_S, hold_s=_HOLD_S)
    frames = Frames(dataset, lambda: sampler.lost, looks.keep if looks is not None else None)
    began, ended_s, failed = time.monotonic(), 0.0, None

    def take(sample: Any) -> None:
        nonlocal ended_s
        ended_s, values, numbers = sample
        frames.take(ended_s, {value.path: number for value, number in zip(values, numbers, strict=True)})

    try:
        with sampler, suppress(KeyboardInterrupt):
            for sample in sampler.samples(count, duration_s):
                if sample is not None:
                    take(sample)
    except LinkError as error:
        failed = error  # raised after the episode has been saved
    for sample in sampler.rest():
        take(sample)
    frames.until(ended_s)
    if not len(dataset):
        raise failed or UnityLinkError(
            f"{folder}: no episode: nothing has come of {', '.join(frames.missing())}"
        )
    took_s = time.monotonic() - began
    episode = dataset.save_episode(task, lost=sampler.lost)
    if looks is not None:
        looks.close()
    result = {
        "dataset": folder,
        "episode": episode.number,
        "frames": episode.frames,
        "held": frames.held,
        "lost": episode.lost,
        "duration_s": took_s,
    }
    if as_json:
        print_json(result)
    else:
        click.echo(
            f"{folder}: episode {episode.number}, {episode.frames:,} frames in {took_s:.1f} s, "
            f"{frames.held} without a new value, {episode.lost} lost"
        )
    if failed is not None:
        raise failed
    return 1 if episode.lost else 0


def _size(camera: str) -> tuple[str, tuple[int, int]]:
    """Return the name of a camera, and height and width: "front", or "front:640x480"."""
    found = re.fullmatch(r"([^:/]+)(?::([1-9]\d{0,3})x([1-9]\d{0,3}))?", camera)
    if found is None:
        raise Failure(f"--camera {camera!r} is no camera", "write NAME, or NAME:WIDTHxHEIGHT")
    return found[1], (int(found[3] or 240), int(found[2] or 320))


def _looks(target: Target, sizes: dict[str, tuple[int, int]]) -> Looks:
    plant = getattr(getattr(target.link, "board", None), "plant", None)
    if plant is None or not hasattr(plant, "camera"):
        raise Failure(
            "--camera: the link leads to no model of MuJoCo",
            "record a virtual board with plant=mujoco:FILE.xml, or with LeRobot's own cameras",
        )
    from unitylink.simulate.plants.mujoco.looks import Looks

    return Looks(plant, sizes)


def _numbers(items: Sequence[Item]) -> list[Item]:
    others = [item.name for item in items if item.quantity.type.kind not in _NUMBERS]
    if others:
        click.echo(f"note: {', '.join(others)} left out: a frame has numbers only", err=True)
    return [item for item in items if item.name not in others]


def _layout(target: Target, items: Sequence[Item], fps: int) -> Layout:
    from unitylink.recording.lerobot_layout import Layout

    def written(item: Item) -> bool:
        return item.element is not None and item.element.access in ("WRITE", "READWRITE")

    state = tuple(item.name for item in items if not written(item))
    action = tuple(item.name for item in items if written(item))
    for what, paths, remedy in (
        ("is observed", state, "name values that the PC reads"),
        ("is commanded", action, "name set-points that the device allows to be read back"),
    ):
        if not paths:
            raise Failure(f"no number {what}, and a policy learns from both sides", remedy)
    spec = target.names.spec
    return Layout(fps, state, action, spec.name if spec is not None else "unitylink")


def _origin(target: Target, items: Sequence[Item]) -> dict[str, Any]:
    spec = target.names.spec
    return {
        "spec": spec.source if spec is not None else "",
        "spec_hash": spec.hash if spec is not None else "",
        "units": {item.name: item.unit for item in items if item.unit},
        "device_time": "ns since the first frame at which a value of observation.state was sampled",
    }
