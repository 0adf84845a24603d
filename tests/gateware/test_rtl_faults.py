# SPDX-License-Identifier: BSD-3-Clause
"""The compiled gateware with faulty transfers: every operation ends in its time, as with the twin.

The long form is `python tests/gateware/fuzz_rtl_faults.py --messages 100000`: both engines, and all profiles.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink import _native
from unitylink.simulate.rtl import RtlModel, build_model, design_of, rtl_configuration
from unitylink.spec import load

CLIENTS, MESSAGES = 2, 60
SPEC = """public lied_about() {
   @one[8] = 0x10: READWRITE(INITIAL=0);
   @two[8] = 0x20: READWRITE(INITIAL=0);
}
"""
PROFILES = ["quiet", "restarts", "dead", "half-dead", "closing", "renewing", "refusing"]


def compiled(folder: Path, engine: str = "fast") -> tuple[RtlModel, object]:
    """Return the gateware with the words of two clients, and its configuration."""
    file = folder / "lied_about.ul"
    file.write_text(SPEC)
    spec = load(file)
    configuration = rtl_configuration(spec, engine=engine, protocol="framed" if engine == "small" else "both")
    return build_model(design_of(spec, configuration)), configuration


@pytest.fixture(scope="module")
def gateware(tmp_path_factory: pytest.TempPathFactory) -> tuple[RtlModel, object]:
    return compiled(tmp_path_factory.mktemp("lied_about"))


@pytest.mark.parametrize("protocol", ["framed", "classic"])
@pytest.mark.parametrize("profile", PROFILES)
def test_every_operation_ends(gateware: tuple[RtlModel, object], profile: str, protocol: str) -> None:
    model, configuration = gateware
    report = _native.run_faults(7, MESSAGES, profile, protocol == "framed", CLIENTS, 8, configuration, model)
    assert report["violations"] == []
    assert report["messages"] >= MESSAGES
    assert report["good"] > 0
    assert (report["faults"] > 0) == (profile != "quiet")
    assert profile != "quiet" or report["bus_writes"] > 10


def test_the_same_seed_gives_the_same_history(gateware: tuple[RtlModel, object]) -> None:
    model, configuration = gateware
    digests = [
        _native.run_faults(seed, MESSAGES, "restarts", True, CLIENTS, 8, configuration, model)["digest"]
        for seed in (3, 3, 4)
    ]
    assert digests[0] == digests[1] != digests[2]
