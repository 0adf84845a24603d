# SPDX-License-Identifier: BSD-3-Clause
"""A real ROS 1 for the tests: an environment, a workspace built with catkin, a master."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from unitylink.generate import write
from unitylink.simulate import Board
from unitylink.simulate.plant import AnyPlant, load_plant
from unitylink.spec import load
from unitylink_lab.bench.ros import LOOPBACK, free_domain

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
SPECS = {
    "scara": ROOT / "examples" / "scara" / "scara.ul",
    "walker18": ROOT / "examples" / "walker18" / "walker18_si.ul",
    "rig": HERE / "rig.ul",
}
PATIENCE_S = 120.0


@dataclass
class Workspace:
    """A catkin workspace, and the environment in which its programs run."""

    folder: Path
    python: Path
    environment: dict[str, str] = field(default_factory=dict)

    def source(self) -> dict[str, str]:
        """Return the environment after `source devel/setup.bash`."""
        shown = subprocess.run(
            ["bash", "-c", ". devel/setup.bash && env -0"],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            check=True,
        ).stdout.decode()
        return dict(line.split("=", 1) for line in shown.split("\0") if "=" in line)


@pytest.fixture(scope="session")
def workspace(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """The packages of the specs. Environment and build follow their README.

    The walker's is built for `make long` only: the rig has all of its forms.
    """
    assert shutil.which("catkin_make"), "ROS 1 is missing: tools/setup.sh system"
    folder = tmp_path_factory.mktemp("catkin")
    made_by = [sys.executable, ROOT / "tools" / "ros_environment.py", folder / "env"]
    python = Path(subprocess.run(made_by, check=True, capture_output=True, text=True).stdout.strip())
    prefix = folder / "unitylink"
    cmake = Path(sys.executable).with_name("cmake")
    install = [cmake, "--install", ROOT / "build" / "native", "--prefix", prefix]
    subprocess.run(install, check=True, capture_output=True)  # for find_package(unitylink)
    short = request.config.getoption("-m") == "not long"
    for name, path in SPECS.items():
        if not (short and name == "walker18"):
            write(load(path), folder / "src", "ros1")
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("ROS", "CATKIN", "PYTHON", "CMAKE_P"))}
    environment = clean | {
        "PATH": f"{python.parent}:{clean['PATH']}",
        "ROS_HOME": str(folder / "home"),
        "ROS_LOG_DIR": str(folder / "log"),
        "ROS_IP": "127.0.0.1",
        "PYTHONUNBUFFERED": "1",
        "CMAKE_POLICY_VERSION_MINIMUM": "3.5",  # catkin is older than CMake 4
        "ROS_LANG_DISABLE": "geneus:genlisp:gennodejs",  # messages in C++ and Python are enough here
    }
    done = subprocess.run(
        [
            "catkin_make",
            "-C",
            str(folder),
            "-j2",
            f"-DPYTHON_EXECUTABLE={python}",
            f"-DCMAKE_PREFIX_PATH={prefix}",
        ],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    made = Workspace(folder, python, environment)
    made.environment = made.source()
    return made


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@dataclass
class Ros:
    """A running master, with functions that run ROS's own programs on it."""

    environment: dict[str, str]
    folder: Path
    _running: list[subprocess.Popen[str]] = field(default_factory=list)

    def run(self, *command: str, timeout: float = PATIENCE_S) -> str:
        """Run a program to its end and return its output."""
        with subprocess.Popen(
            command,
            env=self.environment,
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        ) as process:
            try:
                out, err = process.communicate(timeout=timeout)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)  # the processes that it started hold the pipes, too
                out, err = process.communicate()
        assert process.returncode == 0, f"{' '.join(command)}: {out}{err}\n{self.logs()}"
        return out

    def logs(self) -> str:
        """Return the output of the programs that were started."""
        return "\n".join(f"{log.name}:\n{log.read_text()}" for log in self.folder.glob("*.log"))

    def start(self, *command: str) -> subprocess.Popen[str]:
        """Start a program in a process group of its own. It is interrupted at the end of the test."""
        with (self.folder / f"{Path(command[0]).name}.log").open("w") as log:
            # A background job of a shell ignores interrupts, and so would a program that it starts.
            heeding = ("env", "--default-signal=INT", *command)
            process = subprocess.Popen(
                heeding,
                env=self.environment,
                cwd=self.folder,
                stdout=log,
                stderr=log,
                text=True,
                start_new_session=True,
            )
        self._running.append(process)
        return process

    def interrupt(self, process: subprocess.Popen[str]) -> None:
        """Interrupt a program as Ctrl-C in its terminal does, which reaches its whole group.

        Wait for its end.
        """
        os.killpg(process.pid, signal.SIGINT)
        try:
            process.wait(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{process.args} goes on after Ctrl-C\n{self.logs()}") from None

    def publish(self, topic: str, kind: str, text: str) -> None:
        """Let rostopic publish a message that stays latched until the test ends."""
        self.start("rostopic", "pub", topic, kind, text)

    def python(self, code: str, *arguments: str) -> str:
        """Run Python in the environment of the workspace."""
        return self.run("python3", "-c", code, *arguments)

    def until(self, holds: Callable[[], bool]) -> None:
        """Ask again and again until the condition holds."""
        deadline = time.monotonic() + PATIENCE_S
        while not holds():
            assert time.monotonic() < deadline, f"waited in vain\n{self.logs()}"
            time.sleep(0.02)

    def stop(self) -> None:
        for process in reversed(self._running):
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in reversed(self._running):
            try:
                process.wait(timeout=PATIENCE_S)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


@pytest.fixture
def ros(workspace: Workspace, tmp_path: Path) -> Iterator[Ros]:
    port = free_port()
    environment = workspace.environment | {
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_HOME": str(tmp_path / "home"),
        "ROS_LOG_DIR": str(tmp_path / "log"),
    }
    made = Ros(environment, tmp_path)
    master = made.start("rosmaster", "--core", "-p", str(port))
    try:
        made.until(lambda: master.poll() is not None or _listens(port))
        assert master.poll() is None, made.logs()
        yield made
    finally:
        made.stop()


def _listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> int:
    """A DDS domain for this test alone, on the loopback interface."""
    monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
    return free_domain()


class Still:
    """A plant that leaves the registers alone."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None: ...
    def step(self, time_s: float) -> None: ...


@pytest.fixture
def board() -> Iterator[Callable[..., Board]]:
    """Serve the twin of a spec on TCP: `board("scara", "scara")`."""
    boards: list[Board] = []

    def make(name: str, plant: str, endpoint: str = "tcp") -> Board:
        spec = load(SPECS[name])
        moved: AnyPlant = Still() if plant == "still" else load_plant(plant, spec)
        boards.append(Board(spec, plant=moved, endpoint=endpoint))
        return boards[-1]

    yield make
    for made in boards:
        made.close()
