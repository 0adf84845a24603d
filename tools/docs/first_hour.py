# SPDX-License-Identifier: BSD-3-Clause
"""Run the commands of the first hour with a wheel in an empty folder, and write docs/first-hour.md:

    make wheel && python tools/docs/first_hour.py build/wheels/*.whl [--out FILE]

Every command is one that a user types, in one bash. If a command fails, or does not print the expected text,
the run ends with exit code 1. Parts that differ from run to run (times, sizes, folders) become dots.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from page_format import formatted

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "first-hour.md"
PATIENCE_S = 300.0  # for one command; pip may wait for its index
ATTEMPTS = 3


@dataclass(frozen=True)
class Command:
    """The text to type, the required output, the exit code, and a file to wait for afterwards."""

    text: str
    says: str = ""
    code: int = 0
    makes: str = ""


HEAD = """# The first hour

This page shows a terminal, from an empty folder on. You install, see a robot move, write a spec of your own
with a test, use a board in another process, and see what you are told when it does not answer. You need no
FPGA and no compiler. `tools/docs/first_hour.py` runs all commands with a real wheel and writes this page. A
test runs them too, so that the page stays true. Dots stand for what differs from run to run.
"""

SECTIONS: list[tuple[str, list[Command]]] = [
    (
        "## 1. Install\n\n`WHEEL` is what `make wheel` leaves in `build/wheels/` ([installing](install.md)).",
        [
            Command("python3 -m venv venv && . venv/bin/activate"),
            Command('pip install -qq "$WHEEL"'),
            Command("unitylink --version", "unitylink"),
        ],
    ),
    (
        "## 2. A robot moves\n\nTosNet is the network of FPGAs to which this robot is attached.",
        [Command("unitylink demo", "0 lost")],
    ),
    (
        "## 3. A spec of your own, and its test\n\nPictures, recordings and pytest are extras.",
        [
            Command('pip install -qq "$WHEEL[plot,record]" pytest'),
            Command("unitylink new arm", "wrote arm/arm.ul"),
            Command("cd arm"),
            Command("python -m pytest -q", "1 passed"),
            Command("python run.py | tail -n 3", "x.position is now 300"),
            Command("unitylink list --spec arm.ul", "x.position"),
            Command("unitylink budget arm.ul --baud 3000000", "3,000,000"),
        ],
    ),
    (
        "## 4. A mistake\n\nThis spec has REED in place of READ:",
        [
            Command("sed 's/@speed: signed READ/@speed: signed REED/' arm.ul > wrong.ul"),
            Command("unitylink check wrong.ul", "REED", code=1),
            Command("unitylink check arm.ul", "no mistakes"),
        ],
    ),
    (
        "## 5. A board in another process\n\nIt is on a pseudo-terminal, in place of a serial port.",
        [
            Command(
                "unitylink simulate arm.ul --plant loopback --pty ./arm.tty > board.log 2>&1 &",
                makes="arm.tty",
            ),
            Command("unitylink info serial:./arm.tty --spec arm.ul", "told by the device"),
            Command("unitylink write serial:./arm.tty --spec arm.ul x.target=100 y.target=-50", "-50"),
            Command("unitylink read serial:./arm.tty --spec arm.ul '*.position'", "100"),
            Command("unitylink watch serial:./arm.tty --spec arm.ul x.position --count 4", "x.position=100"),
        ],
    ),
    (
        "## 6. Record it",
        [
            Command(
                "unitylink record serial:./arm.tty --spec arm.ul --out arm.mcap --count 100", "100 samples"
            ),
            Command("unitylink plot arm.mcap '*.position' --out arm.svg", "arm.svg"),
        ],
    ),
    (
        "## 7. See the wire",
        [
            Command(
                "unitylink read 'serial:./arm.tty?trace=arm.pcapng' --spec arm.ul x.position y.position",
                "100",
            ),
            Command(
                "unitylink decode arm.pcapng --spec arm.ul --match position",
                "read x.position, y.position",
            ),
        ],
    ),
    (
        "## 8. Find a fault\n\nFirst the board is there, then its plug is pulled.",
        [
            Command("unitylink doctor serial:./arm.tty --spec arm.ul", "without a fault"),
            Command("kill %1; wait"),
            Command("unitylink read serial:./arm.tty --spec arm.ul x.position", "error", code=1),
            Command("unitylink doctor serial:./arm.tty --spec arm.ul", "no-port", code=1),
        ],
    ),
]

# These parts differ from run to run, so their numbers are not shown.
VOLATILE = (
    r"cpython \d+\.\d+",
    r"/python\d+\.\d+/",
    r"robot time \d+\.\d+ s",
    r"real time \d+\.\d+ s",
    r"jitter \d+\.\d+ ms",
    r"\d+ received at \d+\.\d+ Hz",
    r"passed in \d+\.\d+s",
    r"samples in \d+\.\d+ s, [\d,]+ bytes",
    r"[\d.]+, +[\d.]+ (deg|mm)$",
    r"\([\d,]+ clocks",
    r"[\d,]+ values of",
    r"^ *\d+\.\d+ s  (?= x|[a-z])",
)

TAIL = """
[Troubleshooting](troubleshooting.md) says what to do about each finding. With a real board only the LINK
changes: [your own board](own-board.md). To model your own robot behind the registers, read [your own
plant](own-plant.md).
"""


class Terminal:
    """One bash that gets command after command."""

    def __init__(self, folder: Path, wheel: Path) -> None:
        kept = (
            "PATH",
            "HOME",
            "LANG",
            "PIP_INDEX_URL",
            "PIP_EXTRA_INDEX_URL",
            "PIP_CONFIG_FILE",
            "PIP_CACHE_DIR",
        )
        environment = {name: os.environ[name] for name in kept if name in os.environ}
        environment |= {"WHEEL": str(wheel), "COLUMNS": "100", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
        environment |= dict.fromkeys(("CC", "CXX", "CMAKE"), "/bin/false")  # so that nothing can compile
        self._folder = folder
        self._log = folder / "said"
        self._bash = subprocess.Popen(
            ["bash", "--norc", "--noprofile"],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            text=True,
            cwd=folder,
            env=environment,
        )

    def run(self, command: Command) -> str:
        """Return what a command prints on both its outputs. Raises SystemExit if it is not as expected.

        A virtual board on a busy machine may be silent for too long. Then the command is tried again.
        """
        for attempt in range(ATTEMPTS):
            code, said = self._try(command)
            if code == command.code and command.says in said:
                break
            if attempt == ATTEMPTS - 1 or "the device has never answered" not in said:
                expected = f"exit code {code}, expected {command.code} and {command.says!r}"
                raise SystemExit(f"$ {command.text}\n{said}\n{expected}")
        if command.makes:
            self._wait(self._folder / "arm" / command.makes, command)
        return said

    def _try(self, command: Command) -> tuple[int, str]:
        """Return the exit code of a command, and what it prints on both its outputs."""
        done = self._folder / "done"
        done.unlink(missing_ok=True)
        assert self._bash.stdin is not None
        end = f"echo $? > '{done}.new'; mv '{done}.new' '{done}'"
        self._bash.stdin.write(f"{{ {command.text}\n}} > '{self._log}' 2>&1 < /dev/null\n{end}\n")
        self._bash.stdin.flush()
        self._wait(done, command)
        return int(done.read_text()), self._log.read_text("utf-8")

    def _wait(self, file: Path, command: Command) -> None:
        end = time.monotonic() + PATIENCE_S
        while not file.exists():
            if time.monotonic() > end or self._bash.poll() is not None:
                raise SystemExit(f"$ {command.text}\ndid not end, or did not make {file.name}")
            time.sleep(0.02)

    def close(self) -> None:
        """End the bash and everything that still runs in it."""
        assert self._bash.stdin is not None
        self._bash.stdin.write("kill $(jobs -p) 2> /dev/null\nexit\n")
        self._bash.stdin.close()
        self._bash.wait(timeout=PATIENCE_S)


def transcript(wheel: Path) -> tuple[str, dict[str, float]]:
    """Play all sections in an empty folder. Return the page, and how many seconds each command took."""
    parts, took_s = [HEAD], {}
    with tempfile.TemporaryDirectory() as folder:
        terminal = Terminal(Path(folder), wheel)
        try:
            for heading, commands in SECTIONS:
                lines = []
                for command in commands:
                    began = time.monotonic()
                    said = terminal.run(command)
                    took_s[command.text] = time.monotonic() - began
                    lines.append(f"$ {command.text}\n{stable(said, folder)}")
                parts.append(f"{heading}\n\n```console\n{''.join(lines)}```\n")
        finally:
            terminal.close()
    return "\n".join([*parts, TAIL.lstrip()]), took_s


def stable(said: str, folder: str) -> str:
    """Return a command's output without the parts that differ from run to run."""
    said = said.replace(str(Path(folder).resolve()), "/home/you").replace(folder, "/home/you")
    for volatile in VOLATILE:
        said = re.sub(volatile, lambda found: re.sub(r"\d+([.,]\d+)*", "…", found.group()), said, flags=re.M)
    # times of watch and decode, and the width of their column
    said = re.sub(r"(?m)^( +)\d+\.\d{6}", r"\1…       ", said)
    said = re.sub(r"(ports on this machine:) .*", r"\1 …", said)
    said = re.sub(r"(?m)(\(what is not shown is 0\)\n)(  .*\n)+", r"\1  …\n", said)  # counters
    said = re.sub(r"(?m)^\[\d+\]\s.*\n", "", said)  # what bash prints about jobs
    return "".join(f"{line.rstrip()}\n" for line in said.splitlines())


def main() -> int:
    """Write the page, and print how long it took until the joints moved."""
    parser = argparse.ArgumentParser(description="Play the first hour with a wheel, and write it down.")
    parser.add_argument("wheel", type=Path, help="the wheel, of `make wheel`")
    parser.add_argument(
        "--out", type=Path, default=PAGE, help="where to write it; docs/first-hour.md without"
    )
    given = parser.parse_args()
    if not given.wheel.is_file():
        raise SystemExit(f"there is no wheel {given.wheel}; `make wheel` makes one")
    page, took_s = transcript(given.wheel.resolve())
    given.out.write_text(formatted(page), "utf-8")
    install_s, demo_s = (
        next(s for c, s in took_s.items() if c.startswith(w)) for w in ("pip", "unitylink demo")
    )
    print(f"{given.out}: pip install took {install_s:.1f} s, the demo {demo_s:.1f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
