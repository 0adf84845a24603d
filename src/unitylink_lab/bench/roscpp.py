# SPDX-License-Identifier: BSD-3-Clause
"""The generated node in C++, against a bare publisher of roscpp, with the same subscriber."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from statistics import median

from unitylink.generate import write
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec.model import Spec

from .figure import BenchError, Figure, Run
from .programs import Process, alone, made
from .ros import compared, folder_of, plane
from .ros_worker import WORDS, spec_of

OFFERED_HZ = 200_000  # offered to both sides; more than roscpp can take
TOPIC = "/bench/out"


def _make(*command: str | Path) -> None:
    cleared = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "CATKIN", "CMAKE_P"))}
    settings = {
        "CMAKE_POLICY_VERSION_MINIMUM": "3.5",  # catkin is older than CMake 4
        "ROS_LANG_DISABLE": "geneus:genlisp:gennodejs",
    }
    made(command, cleared | settings)


def _build(run: Run, spec: Spec, python: str) -> tuple[Path, Path]:
    """Compile the generated node and the bare peer, and return their paths.

    Existing files are not made again.
    """
    folder = folder_of(run) / "workspace"
    prefix, peer = folder / "unitylink", folder / "ros_peer"
    with alone(folder):
        _make(
            Path(sys.executable).with_name("cmake"),
            "--install",
            run.checkout / "build" / "native",
            "--prefix",
            prefix,
        )
        write(spec, folder / "src", "ros1")
        _make(
            "catkin_make",
            "-C",
            folder,
            f"-DPYTHON_EXECUTABLE={python}",
            f"-DCMAKE_PREFIX_PATH={prefix}",
            "-DCMAKE_BUILD_TYPE=Release",
        )
        asked = ["pkg-config", "--cflags", "--libs", "roscpp", "std_msgs"]
        flags = shlex.split(made(asked))
        source = run.checkout / "bench" / "ros" / "ros_peer.cpp"
        _make("c++", "-std=c++17", "-O2", source, "-o", peer, *flags)
    return folder / "devel" / "lib" / "bench_unitylink" / "node", peer


def _arriving(run: Run, peer: Path) -> float:
    """Return the messages a second that arrive at a bare subscriber."""
    with Process([peer, "sub", TOPIC]) as taking:
        taking.line()
        for _ in range(100):
            if int(taking.ask("0.1").split()[0]) > 10:
                windows = [taking.ask("1").split() for _ in range(run.rounds(3))]
                return median(int(count) / float(wall) for count, wall, _ in windows)
    raise BenchError(f"nothing comes on {TOPIC}")


def measure_out(run: Run) -> Figure:
    """Measure FPGA -> roscpp, a single integer."""
    spec = spec_of(WORDS)
    ceilings, reached = [], []
    with ExitStack() as stack:
        command = stack.enter_context(plane(run, "ros1"))
        node, peer = _build(run, spec, command[0])
        settings = BoardConfiguration.for_spec(spec, base_hz=OFFERED_HZ, baud_hz=50_000_000)
        for _ in range(run.rounds(3)):
            with Process([peer, "pub", TOPIC, str(OFFERED_HZ)]) as bare:
                bare.line()
                ceilings.append(_arriving(run, peer))
            with Board(spec, configuration=settings, endpoint="tcp") as board:
                ours = subprocess.Popen(
                    [node, "__ns:=/bench", f"_link:={board.url}"], stdout=subprocess.DEVNULL
                )
                try:
                    reached.append(_arriving(run, peer))
                finally:
                    ours.terminate()
                    ours.wait()
    title = "FPGA -> roscpp topic of an integer, over a bare publisher"
    return compared("roscpp-out", title, 0.7, reached, ceilings)
