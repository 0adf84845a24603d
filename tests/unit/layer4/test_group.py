# SPDX-License-Identifier: BSD-3-Clause
"""Groups: one write, one consistent snapshot, any number of links."""

from __future__ import annotations

import asyncio
from types import ModuleType
from typing import Any

import pytest

from unitylink.errors import DeviceMismatch, LinkTimeout, ValueRangeError
from unitylink.layer3_hardware import MemoryProxy, TosNetProxy
from unitylink.layer4_data import ReadValue, ValueGroup, WriteValue


def writes(hardware: Any) -> list[WriteValue]:
    return [WriteValue(f"j{n}.pos_sp", hardware, 0x8B + n, signed=True) for n in (1, 2, 3)]


def reads(hardware: Any, prefix: str = "j") -> list[ReadValue]:
    return [ReadValue(f"{prefix}{n}.cpos", hardware, 0x87 + n, signed=True) for n in (1, 2, 3)]


def test_a_group_is_one_commit(fake: ModuleType) -> None:
    model = fake.TosNetModel()
    group = ValueGroup(writes(TosNetProxy(fake.FakeLink(model))), "targets")
    group.write([1, -2, 3])
    group.write({"j2.pos_sp": 7})
    group.write(j1_pos_sp=5, j3_pos_sp=6)
    low = 0xFFFFFFFE
    assert model.history == [
        {0x8C: 1, 0x8D: low, 0x8E: 3},
        {0x8C: 1, 0x8D: 7, 0x8E: 3},
        {0x8C: 5, 0x8D: 7, 0x8E: 6},
    ]
    assert [value.latest for value in group] == [5, 7, 6]


def test_nothing_is_sent_where_one_value_is_wrong(fake: ModuleType) -> None:
    link = fake.FakeLink()
    group = ValueGroup(writes(MemoryProxy(link)), "targets")
    for wrong, text in (
        ([1, 2, 1 << 31], "j3.pos_sp: 2147483648 is not in"),
        ([1, 2], "2 values for 3 WRITEs"),
        ({"j9.pos_sp": 1}, "no WRITE 'j9.pos_sp'; there are j1.pos_sp"),
    ):
        with pytest.raises(ValueRangeError, match=text):
            group.write(wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueRangeError, match="pos_sp is more than one WRITE"):
        group.write(pos_sp=1)
    with pytest.raises(ValueRangeError, match="spd is not a WRITE"):
        group.write(spd=1)
    assert not link.log


def test_writing_nothing_is_a_mistake(fake: ModuleType) -> None:
    group = ValueGroup(writes(MemoryProxy(fake.FakeLink())), "targets")
    with pytest.raises(ValueRangeError, match=r"targets: nothing to write; there are j1.pos_sp, j2.pos_sp"):
        group.write()


def test_last_step_as_keyword(fake: ModuleType) -> None:
    memory = MemoryProxy(fake.FakeLink())
    group = ValueGroup([WriteValue("j1.pos_sp", memory, 1), WriteValue("j1.spd_sp", memory, 2)])
    group.write(pos_sp=4, spd_sp=5)
    assert memory.link.bus.words == {1: 4, 2: 5}  # type: ignore[attr-defined]


def test_a_snapshot_is_one_atomic_read(fake: ModuleType) -> None:
    link = fake.FakeLink()
    link.bus.words = {0x88: 1, 0x89: 0xFFFFFFFF, 0x8A: 3}
    memory = MemoryProxy(link)
    group = ValueGroup([*reads(memory), *writes(memory)])
    snapshot = group.snapshot()
    assert dict(snapshot) == {"j1.cpos": 1, "j2.cpos": -1, "j3.cpos": 3}
    assert link.log == [("RM", 0x88, 0x89, 0x8A)]
    assert snapshot.times_s == {"fake:": snapshot.time_s}
    assert dict(asyncio.run(group.snapshot_async())) == dict(snapshot)
    asyncio.run(group.write_async([1, 2, 3]))
    assert link.bus.words[0x8E] == 3


def test_too_many_for_one_read_is_said(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(read_many=2))
    group = ValueGroup(reads(MemoryProxy(link)), "pose")
    with pytest.raises(DeviceMismatch, match=r"pose: 3 values do not fit one atomic read of 2 words"):
        group.snapshot()
    assert dict(group.snapshot(consistent=False)) == {"j1.cpos": 0, "j2.cpos": 0, "j3.cpos": 0}


def test_several_links_at_once(fake: ModuleType) -> None:
    import threading

    left, right = fake.FakeLink(url="left:"), fake.FakeLink(url="right:")
    meet = threading.Barrier(2, timeout=10)  # passes only if both links are read at the same time
    for number, link in enumerate((left, right)):
        link.bus.words = {0x88: 10 * (number + 1)}
        plain = link.read_many
        link.read_many = lambda *a, plain=plain, **o: (meet.wait(), plain(*a, **o))[1]
    group = ValueGroup([*reads(MemoryProxy(left), "l"), *reads(MemoryProxy(right), "r")])
    snapshot = group.snapshot()
    assert (snapshot["l1.cpos"], snapshot["r1.cpos"]) == (10, 20)
    assert set(snapshot.times_s) == {"left:", "right:"}
    targets = ValueGroup(
        {"a": WriteValue("a", MemoryProxy(left), 1), "b": WriteValue("b", MemoryProxy(right), 1)}
    )
    targets.write(a=1, b=2)
    assert (left.bus.words[1], right.bus.words[1]) == (1, 2)


def test_links_with_the_same_url_stay_apart(fake: ModuleType) -> None:
    group = ValueGroup([*reads(MemoryProxy(fake.FakeLink()), "l"), *reads(MemoryProxy(fake.FakeLink()), "r")])
    assert set(group.snapshot().times_s) == {"fake:", "fake:#2"}


def test_errors_name_the_group(fake: ModuleType) -> None:
    link = fake.FakeLink()
    link.fail = {0x89: LinkTimeout("unanswered")}
    with pytest.raises(LinkTimeout, match="pose: unanswered"):
        ValueGroup(reads(MemoryProxy(link)), "pose").snapshot()


def test_keys_are_unique(fake: ModuleType) -> None:
    memory = MemoryProxy(fake.FakeLink())
    with pytest.raises(ValueRangeError, match=r"two values are called j1.cpos"):
        ValueGroup([*reads(memory), *reads(memory)])


def test_a_batch_collects_writes_to_its_link_and_others(fake: ModuleType) -> None:
    """Threads do the writes to several links. They must not wait for the batch of this link."""
    models = [fake.TosNetModel(), fake.TosNetModel()]
    first, second = (TosNetProxy(fake.FakeLink(model, url=f"link{n}")) for n, model in enumerate(models))
    group = ValueGroup({"a": WriteValue("a", first, 0x84), "b": WriteValue("b", second, 0x84)})
    with first.batch():
        group.write([1, 2])
        assert [model.history for model in models] == [[], [{0x84: 2}]]
    assert models[0].history == [{0x84: 1}]


def test_async_ends_all_links_before_it_raises(fake: ModuleType) -> None:
    dead, alive = fake.FakeLink(url="dead"), fake.FakeLink(url="alive")
    dead.fail = {1: LinkTimeout("no answer")}
    group = ValueGroup(
        {"a": WriteValue("a", MemoryProxy(dead), 1), "b": WriteValue("b", MemoryProxy(alive), 1)}
    )

    async def main() -> None:
        with pytest.raises(LinkTimeout, match="group"):
            await group.write_async([5, 6])
        assert alive.bus.words == {1: 6}

    asyncio.run(main())
