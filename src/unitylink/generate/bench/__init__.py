# SPDX-License-Identifier: BSD-3-Clause
"""A bench of a generated design, and procedures by name for benches of the user's own logic."""

from __future__ import annotations

from pathlib import Path

from unitylink.errors import BindingError

from ..spec_plan import SpecPlan
from ..templates import environment
from ..vhdl import plan_designs
from .plan import plan_bench

__all__ = ["bench_files"]

FOLDER = "bench"
_HERE = Path(__file__).parent
_PARTS = ("host_pkg.vhd", "bench.vhd")


def bench_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of the procedures and the bench of each design of a spec.

    Raises BindingError for a design without frames or behind another physical layer than a UART.
    """
    files = {}
    for spec, design in zip(plan.spec.boards, plan.part(plan_designs), strict=True):
        configuration = design.configuration
        if configuration.protocol == "classic":
            raise BindingError(f"bench: {design.name} speaks classic alone, and its bench speaks frames")
        if configuration.physical != "uart":
            raise BindingError(
                f"bench: a bench speaks over a UART, and {design.name} has {configuration.physical}; "
                "generate both with --physical uart: your logic is the same"
            )
        bench = plan_bench(spec, design)
        for part in _PARTS:
            template = environment(_HERE).get_template(f"{part}.jinja")
            files[f"{FOLDER}/{design.name}_{part}"] = template.render(plan=design, bench=bench)
    return files
