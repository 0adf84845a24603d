# SPDX-License-Identifier: BSD-3-Clause
"""One word: sign, range, names in errors."""

from __future__ import annotations

import asyncio
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.errors import BindingError, LinkTimeout, ValueRangeError
from unitylink.layer3_hardware import MemoryProxy
from unitylink.layer4_data import ReadValue, WriteValue


def pair(fake: ModuleType, bits: int, signed: bool) -> tuple[Any, ReadValue, WriteValue]:
    link = fake.FakeLink(configuration=fake.Configuration(data_bytes=bits // 8))
    memory = MemoryProxy(link, 0x10)
    read = ReadValue("a.in", memory, 0x20, signed=signed)
    return link, read, WriteValue("a.out", memory, 0x20, signed=signed)


@given(data=st.data(), bits=st.sampled_from([8, 16, 24, 32]), signed=st.booleans())
def test_what_is_written_is_read(fake: ModuleType, data: st.DataObject, bits: int, signed: bool) -> None:
    _, read, write = pair(fake, bits, signed)
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    number = data.draw(st.integers(low, high))
    write.write(number)
    assert read.read() == number == read.latest == write.latest
    assert (write.minimum, write.maximum) == (low, high)


@given(bits=st.sampled_from([8, 16, 24, 32]), signed=st.booleans(), number=st.integers())
def test_what_does_not_fit_is_never_sent(fake: ModuleType, bits: int, signed: bool, number: int) -> None:
    link, _, write = pair(fake, bits, signed)
    if write.minimum <= number <= write.maximum:
        number += 1 << bits
    with pytest.raises(ValueRangeError, match=rf"a.out: {number} is not in .*; nothing was sent"):
        write.write(number)
    assert not link.log and write.latest is None


def test_only_integers(fake: ModuleType) -> None:
    link, _, write = pair(fake, 32, True)
    write.write(np.int64(-5))
    assert link.bus.words == {0x20: 0xFFFFFFFB}
    with pytest.raises(ValueRangeError, match=r"a.out: 1.5 is not an integer; round it"):
        write.write(1.5)  # type: ignore[arg-type]


def test_errors_name_the_item(fake: ModuleType) -> None:
    link, read, write = pair(fake, 32, True)
    link.fail = {0x20: LinkTimeout("read of 0x0020 unanswered", address=0x20, attempts=3, elapsed_s=0.3)}
    with pytest.raises(LinkTimeout, match=r"a.in: read of 0x0020 unanswered") as caught:
        read.read()
    assert (caught.value.item, caught.value.address, caught.value.attempts) == ("a.in", 0x20, 3)
    link.fail = {0x20: LinkTimeout("unanswered")}
    with pytest.raises(LinkTimeout, match=r"a.out: unanswered"):
        asyncio.run(write.write_async(1))


def test_async(fake: ModuleType) -> None:
    _, read, write = pair(fake, 16, True)

    async def main() -> int:
        await write.write_async(-2)
        return await read.read_async()

    assert asyncio.run(main()) == -2


def test_crc_asks_for_checked_messages(fake: ModuleType) -> None:
    seen: list[Any] = []
    link = fake.FakeLink()
    link.read = lambda address, **options: seen.append(options["checked"]) or 0
    ReadValue("a", MemoryProxy(link), 1, checked=True).read()
    ReadValue("b", MemoryProxy(link), 1).read()
    assert seen == [True, None]


def test_a_board_with_too_few_address_bits_is_refused(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(address_bytes=1))
    with pytest.raises(BindingError, match=r"j1.cpos lies at 0x0188"):
        ReadValue("j1.cpos", MemoryProxy(link), 0x188)
