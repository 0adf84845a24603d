# SPDX-License-Identifier: BSD-3-Clause
"""Measure the figures that Unity-Link has to reach.

>>> from unitylink_lab.bench import run
>>> report = run(only=["version"], quick=True, say=lambda message: None)
>>> report.figures[0].name
'version'
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module

from unitylink.errors import UnityLinkError

from .figure import BenchError, Figure, Run
from .programs import find_checkout
from .report import Report, say
from .stolen import ProcessorTime

# name -> (module, function), in the order of measurement and display
FIGURES: dict[str, tuple[str, str]] = {
    "sync-read": ("sync_read", "measure"),
    "sync-framed": ("sync_read", "measure_framed"),
    "serve": ("server", "measure"),
    "serve-litex-read": ("server", "measure_litex_read"),
    "serve-litex-write": ("server", "measure_litex_write"),
    "exchange": ("exchange", "measure"),
    "cycle": ("exchange", "measure_cycle"),
    "cpp-read": ("objects", "measure_read"),
    "cpp-cycle": ("objects", "measure_cycle"),
    "rust-read": ("objects", "measure_rust_read"),
    "litex-single": ("litex", "measure_single"),
    "litex-single-framed": ("litex", "measure_single_framed"),
    "litex-block": ("litex", "measure_block"),
    "litex-block-framed": ("litex", "measure_block_framed"),
    "mmap": ("mapped", "measure"),
    "in-flight": ("in_flight", "measure"),
    "in-flight-framed": ("in_flight", "measure_framed"),
    "posts": ("posts", "measure"),
    "goodput": ("goodput", "measure"),
    "posts-loss": ("goodput", "measure_posts"),
    "publish": ("publish", "measure_stream"),
    "publish-framed": ("publish", "measure_frames"),
    "callbacks": ("publish", "measure_callbacks"),
    "trace": ("trace", "measure"),
    "record": ("record", "measure"),
    "check": ("start_up", "measure_check"),
    "generate-1k": ("generators", "measure_thousand"),
    "generate-10k": ("generators", "measure_ten_thousand"),
    "generate-memory": ("generators", "measure_memory"),
    "components-compile": ("components", "measure_compile"),
    "components-paced": ("components", "measure_paced"),
    "language-server": ("language_server", "measure"),
    "ros1-out": ("ros", "measure_ros1_out"),
    "ros1-in": ("ros", "measure_ros1_in"),
    "dds-out": ("ros", "measure_dds_out"),
    "dds-in": ("ros", "measure_dds_in"),
    "roscpp-out": ("roscpp", "measure_out"),
    "ros1-delay": ("ros", "measure_ros1_delay"),
    "dds-delay": ("ros", "measure_dds_delay"),
    "ros-joints": ("ros", "measure_joints"),
    "rtl": ("rtl", "measure"),
    "rtl-ring": ("rtl", "measure_ring"),
    "lockstep": ("lockstep", "measure_twin"),
    "lockstep-rtl": ("lockstep", "measure_rtl"),
    "lockstep-64": ("lockstep", "measure_vector"),
    "walker": ("walker", "measure"),
    "walker-paced": ("walker", "measure_paced"),
    "import": ("start_up", "measure_import"),
    "version": ("start_up", "measure_version"),
}


def run(*, only: Sequence[str] = (), quick: bool = False, say: Callable[[str], None] = say) -> Report:
    """Measure the figures named in `only`, or all if it is empty, and return the report.

    `quick` takes seconds instead of a minute and gives rough numbers. `say` gets a line of progress before
    each figure. A figure may be impossible to measure, because a program is not built or LiteX cannot be
    installed. The others are measured all the same, and the report's `failures` give the reason. Raises
    BenchError if a name is unknown or there is no source checkout.
    """
    unknown = [name for name in only if name not in FIGURES]
    if unknown:
        raise BenchError(f"no figure {', '.join(unknown)}; there are: {', '.join(FIGURES)}")
    context = Run(quick, find_checkout(), say)
    figures: list[Figure] = []
    failures: dict[str, str] = {}
    names = [name for name in FIGURES if not only or name in only]
    for index, name in enumerate(names, 1):
        say(f"[{index}/{len(names)}] {name} ...")
        module, function = FIGURES[name]
        before = ProcessorTime.read()
        try:
            figure = getattr(import_module(f".{module}", __name__), function)(context)
        except UnityLinkError as error:
            failures[name] = str(error)
            say(f"  {error}")
            continue
        assert isinstance(figure, Figure)
        after = ProcessorTime.read()
        if before and after:  # a figure means little if the host ran other machines at the same time
            figure = replace(
                figure, details={**figure.details, "stolen by the host %": after.stolen_percent(since=before)}
            )
        figures.append(figure)
    report = Report(tuple(figures), failures, quick)
    if not only and not quick:
        report.write(context.checkout / "build" / "bench.json")
    return report


__all__ = ["FIGURES", "BenchError", "Figure", "Report", "run"]
