# SPDX-License-Identifier: BSD-3-Clause
"""What a user does with many words at once. The results are the same on the twin and on compiled gateware."""

from __future__ import annotations

import importlib.util
import sys
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from unitylink import connect
from unitylink.errors import DeviceMismatch, ValueRangeError
from unitylink.generate import generate_python
from unitylink.layer2_message import Link
from unitylink.spec import load

pytestmark = pytest.mark.xdist_group("rtl")

PATIENCE_S = 60

SPEC = """enum mode: u2 { idle = 0; run = 1; fault = 2; }
public rig() {
   @target = 0x10: i16 WRITE(UNIT="rad", SCALE=0.001, INITIAL=0, SAFE=0);
   @angle = 0x11: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(100 Hz));
   @steps = 0x12: READ(PUBLISH(100 Hz));
   @mode = 0x13: mode READWRITE(INITIAL=idle);
   @bank[12] = 0x20: READWRITE(INITIAL=0);
}
"""
BANK, SIZE = 0x20, 12

PLANT = '''"""The angle is the target, and a word tells the steps of 1 ms."""

class Plant:
    period_s = 0.001
    steps = 0

    def attach(self, spec, registers):
        self.registers = registers

    def step(self, time_s):
        self.steps += 1
        self.registers[0x12] = self.steps
        self.registers[0x11] = self.registers[0x10]
'''


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ModuleType]:
    """Return the spec with its plant, and the Python module generated for it."""
    folder = tmp_path_factory.mktemp("rig")
    (folder / "rig.ul").write_text(SPEC)
    (folder / "rig_plant.py").write_text(PLANT)
    ((name, text),) = generate_python(load(folder / "rig.ul")).items()
    (folder / name).write_text(text)
    found = importlib.util.spec_from_file_location("generated_rig", folder / name)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[module.__name__] = module
    found.loader.exec_module(module)
    return folder, module


def cycles(robot: Any) -> list[Any]:
    """A control loop. The plant may follow sooner or later, but a written value is there at once."""
    told = []
    with robot.cycle() as cycle:
        told.append((cycle.atomic, cycle.notice))
        for target in (0.5, -1.25, 32.767):
            state = cycle(target=target, mode="run")
            calls = 0
            while state["angle"] != target:
                calls += 1
                assert calls < 100_000
                state = cycle()
            told.append((state["angle"], state["mode"].name))
        values = {f"bank[{n}]": 1000 * n + 1 for n in range(SIZE)}
        state = cycle(values)
        told.append([state[name] for name in values])
        with pytest.raises(ValueRangeError) as refused:
            cycle(target=40)
        told.append(str(refused.value))
    return told


def lists(link: Link) -> list[Any]:
    """Batches: the operations run in order, each on the results of those before it.

    The bus may be held or not.
    """
    told: list[Any] = []
    for atomic in (False, True):
        link.write_many(range(BANK, BANK + SIZE), range(SIZE))
        requests = link.statistics().requests
        with link.batch(atomic=atomic) as batch:
            before = batch.read(BANK + 3)
            batch.write_masked(BANK + 3, mask=0xFF00, value=0xABCD)
            masked = batch.read(BANK + 3)
            batch.add(BANK + 3, 0x10)
            batch.add(BANK + 3, 0xFFFFFFFF)  # one less
            added = batch.read(BANK + 3)
            batch.write_many(range(BANK + 6, BANK + SIZE), [7 * n for n in range(6)])
            burst = batch.read_many(range(BANK + 4, BANK + SIZE))
        # a second list, so that each reply fits the memory that is kept for repeats
        with link.batch(atomic=atomic) as batch:
            batch.write_fifo(BANK + 4, [1, 2, 3])
            again = batch.read_fifo(BANK + 4, 3)
        told.append(link.statistics().requests - requests)
        told.append([word.value for word in (before, masked, added, *burst, *again)])
        told.append(link.read_many(range(BANK, BANK + SIZE), atomic=True).tolist())
    assert told[:3] == told[3:], "the bus held or not"
    words = link.exchange([BANK, BANK + 5, 0x10], writes=[(BANK, 11), (BANK + 5, 12)], atomic=True)
    told.append(words.tolist())
    with pytest.raises(DeviceMismatch), link.batch(atomic=True) as batch:  # all in one message, or not at all
        for _ in range(100):
            batch.write(BANK, 0xDEAD)
    told.append(link.read(BANK))
    return told


def groups(link: Link) -> list[Any]:
    """An exchange group: each word has its own number of bytes.

    An output that is also an input reads as it was written.
    """
    told: list[Any] = []
    with link.exchange_group(writes=[BANK, (BANK + 1, 2)], reads=[(BANK, 3), BANK + 1, BANK + 2]) as group:
        told.append(group.atomic)
        told += [group.exchange([0xA1B2C3D4 + n, n]).tolist() for n in range(3)]
    return told


def posts(link: Link) -> list[Any]:
    """A stream of posts, 32 in a message. The last one to each word stays."""
    told: list[Any] = []
    for turn in range(3):
        link.post_many([BANK + n % SIZE for n in range(500)], [1000 * turn + n for n in range(500)])
        link.post(BANK + 7, turn)
        link.sync()
        told.append(link.read_many(range(BANK, BANK + SIZE)).tolist())
    health = link.health()
    told.append(health.posts)
    told.append((health.post_errors, health.bus_errors, health.bus_timeouts, health.refused))
    told.append((health.discarded_check, health.discarded_kind, health.discarded_long))
    return told


def publishes(robot: Any) -> list[Any]:
    """Between two publishes there are ten ticks of 1 ms, by the word that counts them.

    No time stamp goes back.
    """
    with robot.links[0].subscribe([0x12, 0x11], divisor=10) as subscription:
        times: list[float] = []
        steps: list[int] = []
        while len(steps) < 10:
            assert subscription.wait(PATIENCE_S)
            stamps, words = subscription.drain()
            times += stamps.tolist()
            steps += words[:, 0].tolist()
        assert all(earlier < later for earlier, later in pairwise(times))
        between = {later - earlier for earlier, later in pairwise(steps)}
        return [between, subscription.missing, subscription.lost]


def everything(module: ModuleType, link: Link) -> dict[str, list[Any]]:
    """Do all of it. Return the results, except those that depend on time."""
    assert link.protocol == "framed"
    robot = module.Rig(link)
    return {
        "cycles": cycles(robot),
        "lists": lists(link),
        "groups": groups(link),
        "posts": posts(link),
        "publishes": publishes(robot),
    }


@pytest.fixture(scope="module")
def told(rig: tuple[Path, ModuleType]) -> dict[str, dict[str, list[Any]]]:
    """Return what each of the two did."""
    folder, module = rig
    results = {}
    for scheme in ("sim", "rtl"):
        with connect(f"{scheme}:{folder / 'rig.ul'}?plant={folder / 'rig_plant.py'}&timeout=10") as link:
            results[scheme] = everything(module, link)
    return results


@pytest.mark.parametrize("scheme", ["sim", "rtl"])
def test_each_does_what_the_pages_say(told: dict[str, dict[str, list[Any]]], scheme: str) -> None:
    did = told[scheme]
    assert did["cycles"] == [
        (True, ""),
        *((target, "run") for target in (0.5, -1.25, 32.767)),
        [1000 * n + 1 for n in range(SIZE)],
        "target: 40 rad is not in -32.768 to 32.767 rad; nothing was sent",
    ]
    bank = [*range(3), 0xAB12, 3, 5, *(7 * n for n in range(6))]
    assert did["lists"][:3] == [2, [3, 0xAB03, 0xAB12, 4, *bank[5:], 3, 3, 3], bank]
    assert did["lists"][6:] == [[11, 12, 32767], 11]
    assert did["groups"] == [True, *([0xB2C3D4 + n, n, 2] for n in range(3))]
    last = [[1000 * turn + (n if n < 500 else n - SIZE) for n in range(492, 504)] for turn in range(3)]
    assert did["posts"][:3] == [[*row[:7], turn, *row[8:]] for turn, row in enumerate(last)]
    assert did["posts"][3:] == [3 * (16 + 1), (0,) * 4, (0,) * 3]
    assert did["publishes"] == [{10}, 0, 0]


def test_twin_and_gateware_do_the_same(told: dict[str, dict[str, list[Any]]]) -> None:
    assert told["rtl"] == told["sim"]
