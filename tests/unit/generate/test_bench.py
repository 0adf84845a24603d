# SPDX-License-Identifier: BSD-3-Clause
"""The bench of a spec's design: what is generated, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest

from unitylink.errors import BindingError
from unitylink.generate import generate
from unitylink.spec import Spec, compile_text


def spec_of(text: str) -> Spec:
    result = compile_text(text, "rig.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def test_each_name_has_what_its_access_allows() -> None:
    values = "@a = 0x0: READ(PUBLISH(10 Hz)); @b = 0x1: WRITE(); @c = 0x2: READWRITE(); @d = 0x3: PULSE();"
    spec = spec_of(f"public rig() {{ {values} }}")
    package = generate(spec, "bench")["bench/rig_host_pkg.vhd"]
    for procedure in ("read_a", "write_b", "read_c", "write_c", "write_d", "subscribe_n10_hz"):
        assert f"procedure {procedure} (" in package
    for procedure in ("write_a", "read_b", "read_d"):
        assert f"procedure {procedure} (" not in package


def test_names_of_any_kind_become_legal_ones() -> None:
    spec = spec_of("public signal() { @Led = 0x0: WRITE(); @led = 0x1: READ(); @_ = 0x2: READ(); }")
    files = generate(spec, "bench")
    assert sorted(files) == ["bench/rig_bench.vhd", "bench/rig_host_pkg.vhd"]
    package = files["bench/rig_host_pkg.vhd"]
    for procedure in ("write_led (", "read_led_2 (", "read_n ("):
        assert f"procedure {procedure}" in package


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"protocol": "classic"}, "speaks classic alone, and its bench speaks frames"),
        (
            {"physical": "spi"},
            "a bench speaks over a UART, and rig has spi; generate both with --physical uart",
        ),
    ],
)
def test_what_a_bench_cannot_speak_to_is_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(BindingError, match=message):
        generate(spec_of("public rig() { @a = 0x0: READ(); }"), "bench", settings)
