# SPDX-License-Identifier: BSD-3-Clause
"""A bridge that loses its processor: is a set-point executed that is older than its time to live?

    python bench/stopped.py
    python bench/stopped.py --stops 300 --ttl 0.05
    python bench/stopped.py --stops 300 --deadman 0.03

Set-points go to a bridge all the time. It is stopped (SIGSTOP) again and again, wherever it is, and
goes on when what it had is too old. The board is a process of its own, where an oracle notes each
set-point that it sees, and when. With `--deadman`, the board's dead-man trips in each stop that is
longer, and the robot is armed again after it.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import signal
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from partition import BEFORE_S, SPEC, judge, oracle
from processes import Processes, end_on_signals, free_port
from writers import Writers

from unitylink import connect
from unitylink.errors import LinkError

PERIOD_S = 0.001
KEY = "bench/r1"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--stops", type=int, default=200)
    parser.add_argument("--ttl", type=float, default=0.05, metavar="S", help="time to live of a set-point")
    parser.add_argument(
        "--deadman", type=float, default=0.0, metavar="S", help="of the board; 0: it has none"
    )
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    end_on_signals()
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folder = Path(name)
        (folder / "arm.ul").write_text(SPEC)
        (folder / "oracle.py").write_text(oracle())
        stack.callback(os.chdir, os.getcwd())
        os.chdir(folder)
        programs = Processes(stack)
        board = ("-m", "unitylink", "simulate", "arm.ul", "--plant", "oracle.py", "--tcp", "0", "--json")
        _, told = programs.start(*board)
        router = f"tcp/127.0.0.1:{free_port()}"
        url = json.loads(told)["url"] + (f"?deadman={options.deadman}" if options.deadman else "")
        bridge = ("-m", "unitylink", "bridge", "zenoh", url, "arm.ul", "--key", KEY)
        pid = programs.start(*bridge, "--listen", router)[0].pid
        writers = Writers(stack, [KEY], router, options.ttl, period_s=PERIOD_S)
        time.sleep(BEFORE_S)
        link = stack.enter_context(connect(f"zenoh:{KEY}?connect={router}"))
        for _ in range(options.stops):
            time.sleep(chance.uniform(0.02, 0.06))
            os.kill(pid, signal.SIGSTOP)
            time.sleep(options.ttl * chance.uniform(1.2, 4))
            os.kill(pid, signal.SIGCONT)
            if options.deadman:
                time.sleep(options.ttl)
                with contextlib.suppress(LinkError):
                    link.arm()
        time.sleep(0.5)
        writers.end()
        print(f"the bridge was stopped {options.stops} times, for up to {4e3 * options.ttl:.0f} ms")
        judge(folder, writers, options.ttl)


if __name__ == "__main__":
    main()
