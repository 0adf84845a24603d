# SPDX-License-Identifier: BSD-3-Clause
"""Histories keep every peak, whatever part of them is asked for and how coarsely."""

from __future__ import annotations

import numpy as np
import pytest

from unitylink.dashboard.history import CAPACITY, FACTOR, LEVELS, History


def recorded(times: np.ndarray, values: np.ndarray, rng: np.random.Generator) -> History:
    """Return a history to which the samples came in portions of any size."""
    history, at = History(), 0
    while at < len(times):
        size = int(rng.choice([1, 7, 40, 1000, CAPACITY]))
        history.add(times[at : at + size], values[at : at + size])
        at += size
    return history


@pytest.mark.parametrize("seed", range(2))
def test_buckets_are_those_of_all_samples(seed: int) -> None:
    """Compared with the plain way, on all samples, as long as none is overwritten."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0, 0.002, CAPACITY - 1)) + 3
    values = rng.normal(size=len(times))
    history = recorded(times, values, rng)
    for _ in range(6):
        begin, end = sorted(rng.uniform(2, times[-1] + 1, 2))
        step = float(10 ** rng.uniform(-3, -2))  # too fine for the coarser levels
        got = history.buckets(begin, end, step)
        inside = (times >= begin) & (times < end)
        numbers = np.floor(times[inside] / step)
        wanted = np.unique(numbers)
        assert got.numbers.tolist() == wanted.tolist()
        for bucket, least, greatest in zip(*got, strict=True):
            mine = values[inside][numbers == bucket]
            assert (least, greatest) == (mine.min(), mine.max())


def test_no_peak_is_lost_in_minutes_of_a_fast_signal() -> None:
    """One sample of 1 kHz in ten minutes is a peak. Each chart that covers it shows it."""
    rng = np.random.default_rng(1)
    times = np.arange(600_000) / 1000
    values = np.sin(times)
    peaks = rng.choice(len(times) - 5000, 50, replace=False)
    values[peaks] = 100 + np.arange(50)
    history = recorded(times, values, rng)
    for step in (0.1, 0.5, 2.0, 10.0):
        got = history.buckets(0.0, 600.0, step)
        for peak in peaks:
            near = np.abs((got.numbers + 0.5) * step - times[peak]) <= step + 0.512  # the coarsest entry
            assert got.greatest[near].max() >= values[peak]


def test_the_newest_samples_are_in_the_coarse_buckets_too() -> None:
    """An entry of a coarse level is made when its last sample comes. The chart does not wait for that."""
    times = np.arange(100_003) / 1000
    values = np.zeros(len(times))
    values[-1] = 9.0
    history = recorded(times, values, np.random.default_rng(2))
    assert history.buckets(0.0, 200.0, 10.0).greatest[-1] == 9.0
    assert history.newest() == (times[-1], 9.0)


def test_memory_has_a_limit_and_old_samples_stay_as_extremes() -> None:
    history = History()
    chunk = np.arange(CAPACITY) / 1000.0
    for number in range(40):
        history.add(chunk + number * CAPACITY / 1000.0, np.full(CAPACITY, float(number)))
    assert len(history._levels) == LEVELS and all(
        level.rows.shape == (3, CAPACITY) for level in history._levels
    )
    got = history.buckets(0.0, 1000.0, 16.384)
    assert got.least[0] == 0.0 and got.greatest[-1] == 39.0 and len(got.numbers) == 40
    fine = history.samples(0.0, 1e9)
    assert fine.shape[1] <= 2 * CAPACITY and fine[0, -1] > chunk[-1] + 39 * CAPACITY / 1000.0 - 0.512
    assert CAPACITY * FACTOR ** (LEVELS - 1) / 1000 > 2 * 3600  # two hours of 1 kHz


def test_times_that_go_back_and_values_that_are_no_numbers() -> None:
    history = History()
    history.add(np.array([1.0, 0.5, 2.0]), np.array([1.0, np.nan, 3.0]))
    history.add(np.array([1.5]), np.array([5.0]))
    assert history.samples(0.0, 10.0)[0].tolist() == [1.0, 1.0, 2.0, 2.0]
    assert history.buckets(0.0, 10.0, 10.0).greatest.tolist() == [5.0]
    assert not len(history.buckets(5.0, 4.0, 1.0).numbers) and not len(History().buckets(0, 1, 1).numbers)
