# SPDX-License-Identifier: BSD-3-Clause
"""Topics of ROS 1, and of ROS 2 on DDS, against a bare publisher or subscriber in the same run."""

from __future__ import annotations

import os
import random
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median

from .figure import BenchError, Figure, Run
from .programs import Process, alone

WORKER = "unitylink_lab.bench.ros_worker"
LOOPBACK = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<Peers><Peer address="localhost"/></Peers></Discovery></Domain></CycloneDDS>'
)


def free_domain() -> int:
    """Return a DDS domain that no other program on this machine uses.

    A participant listens on UDP port 7410 + 250 * domain, or on the next even one: RTPS 2.5, 9.6.2.3. In the
    domains from 102 on, Linux may have given that port to another program.
    """
    for domain in random.sample(range(1, 102), 101):
        with ExitStack() as stack:
            try:
                for participant in range(8):
                    probe = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                    probe.bind(("127.0.0.1", 7410 + 250 * domain + 2 * participant))
            except OSError:
                continue
            return domain
    raise BenchError("there are participants in every DDS domain")


def folder_of(run: Run) -> Path:
    """Return the folder for files of the ROS benches."""
    return run.checkout / "build" / "ros-bench"


def _environment(run: Run) -> str:
    """Return the Python interpreter that has rospy and this checkout. Install it the first time."""
    with alone(folder_of(run)) as folder:
        python = folder / "env" / "bin" / "python3"
        stamp = folder / "env" / ".made"
        if not stamp.exists():
            maker = run.checkout / "tools" / "ros_environment.py"
            made = subprocess.run([sys.executable, maker, folder / "env"], capture_output=True, check=False)
            if made.returncode:
                raise BenchError("ROS 1 is not here: tools/setup.sh ros installs it on Debian")
            stamp.touch()
        return str(python)


@contextmanager
def plane(run: Run, name: str) -> Iterator[list[str]]:
    """Start what a plane (`ros1` or `dds`) needs around it.

    Yield the first words of the workers' command.
    """
    if name == "dds":
        os.environ |= {"CYCLONEDDS_URI": LOOPBACK, "ROS_DOMAIN_ID": str(free_domain())}
        yield [sys.executable, "-m", WORKER, name]
        return
    python = _environment(run)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    os.environ |= {"ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1"}
    logs = str(folder_of(run) / "log")
    os.environ |= {"ROS_LOG_DIR": logs, "ROS_HOME": logs}
    master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL)
    try:
        yield [python, "-m", WORKER, name]
    finally:
        master.kill()  # there is nothing that it must save
        master.wait()


def rate(
    run: Run, command: list[str], giver: str, taker: str, other: Process | None = None
) -> tuple[list[float], float]:
    """Return the messages a second that the taker counted, and its share of a core.

    `other` is counted right after.
    """
    window_s = 0.3 if run.quick else 1.0
    with ExitStack() as stack:
        counting = stack.enter_context(Process([*command, taker]))
        counting.line()
        giving = stack.enter_context(Process([*command, giver]))
        giving.line()
        for _ in range(100):  # until publisher and subscriber have found each other
            if int(counting.ask("0.1").split()[0]) > 10:
                break
        else:
            raise BenchError(f"nothing came from {giver} to {taker}")
        windows = [
            [float(part) for part in counting.ask(str(window_s)).split()] for _ in range(run.rounds(3))
        ]
        rates = [median(n / s for n, s, _ in windows)]
        if other is not None:
            count, wall_s, _ = (float(part) for part in other.ask(str(window_s)).split())
            rates.append(count / wall_s)
        return rates, median(c / s for _, s, c in windows)


def compared(name: str, title: str, limit: float, reached: list[float], ceilings: list[float]) -> Figure:
    """Return the figure of a node's rates against the bare ones."""
    ratios = sorted(one / other for one, other in zip(reached, ceilings, strict=True))
    details = {
        "node messages/s": median(reached),
        "bare messages/s": median(ceilings),
        "lowest": ratios[0],
        "highest": ratios[-1],
    }
    return Figure(name, title, limit, False, median(ratios), "x", details)


def _compare(
    run: Run, name: str, *, title: str, which: str, bare: tuple[str, str], ours: tuple[str, str]
) -> Figure:
    """Measure both sides in turns, so that other work of the machine slows down both.

    The order changes from round to round.
    """
    rates: dict[tuple[str, str], list[float]] = {bare: [], ours: []}
    with plane(run, which) as command:
        for number in range(run.rounds(5)):
            for pair in (ours, bare) if number % 2 else (bare, ours):
                rates[pair] += rate(run, command, *pair)[0]
    ceilings, reached = rates[bare], rates[ours]
    return compared(name, title, 0.9, reached, ceilings)


def measure_ros1_out(run: Run) -> Figure:
    """Measure FPGA -> ROS 1, a single integer."""
    title = "FPGA -> rospy topic of an integer, over a bare publisher"
    return _compare(
        run, "ros1-out", title=title, which="ros1", bare=("bare-out", "sink"), ours=("node-out", "sink")
    )


def measure_ros1_in(run: Run) -> Figure:
    """Measure ROS 1 -> FPGA: the writes that the board has answered.

    Each value differs from the one before.
    """
    title = "rospy topic of an integer -> FPGA, over a bare subscriber"
    return _compare(
        run, "ros1-in", title=title, which="ros1", bare=("source", "bare-in"), ours=("source", "node-in")
    )


def measure_dds_out(run: Run) -> Figure:
    """Measure FPGA -> ROS 2 on DDS."""
    title = "FPGA -> DDS topic of an integer, over a bare writer"
    return _compare(
        run, "dds-out", title=title, which="dds", bare=("bare-out", "sink"), ours=("node-out", "sink")
    )


def measure_dds_in(run: Run) -> Figure:
    """Measure ROS 2 on DDS -> FPGA: the writes that the board has answered."""
    title = "DDS topic of an integer -> FPGA, over a bare reader"
    return _compare(
        run, "dds-in", title=title, which="dds", bare=("source", "bare-in"), ours=("source", "node-in")
    )


def delay_us(run: Run, command: list[str], giver: str) -> float:
    """Return the median time from a publish of the giver to its arrival."""
    with Process([*command, "pong"]) as taking, Process([*command, giver]) as giving:
        taking.line()
        giving.line()
        for _ in range(100):  # until publisher and subscriber have found each other
            count, *_ = taking.ask("0.1").split()
            if int(count) > 20:
                return float(taking.ask("0.3" if run.quick else "1.5").split()[3])
    raise BenchError(f"nothing came from {giver}")


def _added(run: Run, name: str, title: str, which: str) -> Figure:
    with plane(run, which) as command:
        pairs = [
            (delay_us(run, command, "bare-ping"), delay_us(run, command, "node-ping"))
            for _ in range(run.rounds(3))
        ]
    added = sorted(ours - bare for bare, ours in pairs)
    bare, ours = (median(column) for column in zip(*pairs, strict=True))
    details = {"node us": ours, "bare us": bare, "lowest us": added[0], "highest us": added[-1]}
    return Figure(name, title, 100, True, median(added), "us", details, difference=True)


def measure_ros1_delay(run: Run) -> Figure:
    """Measure how much later an event of the FPGA arrives than a message of a bare publisher."""
    return _added(run, "ros1-delay", "FPGA -> rospy, later than from a bare publisher, median", "ros1")


def measure_dds_delay(run: Run) -> Figure:
    """Measure the same on DDS."""
    return _added(run, "dds-delay", "FPGA -> DDS, later than from a bare writer, median", "dds")


def measure_joints(run: Run) -> Figure:
    """Measure 18 joints at 1 kHz both ways on DDS: the share of a core that the node takes, with its twin."""
    with plane(run, "dds") as command, Process([*command, "joints-sink"]) as sink:
        sink.line()
        commands, share = rate(run, command, "joints-source", "joints", sink)
    told = {"commands/s": commands[0], "joint_states/s": commands[1]}
    complaint = "" if min(told.values()) > 950 else "not all of 1000 a second came through"
    title = "18 joints at 1 kHz both ways on DDS"
    return Figure("ros-joints", title, 100, True, 100 * share, "% of a core", told, complaint)
