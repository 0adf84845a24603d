# SPDX-License-Identifier: BSD-3-Clause
"""A board on its endpoints: one client at a time, then the next. No error of a plant is swallowed."""

from __future__ import annotations

import os
import pty
import select
import socket
import sys
import threading
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest

from unitylink.errors import LinkNotFound, UnityLinkError, ValueRangeError
from unitylink.layer2_message import Link
from unitylink.simulate import Board, BoardConfiguration, Registers
from unitylink.spec import Spec

PUBLISHING = BoardConfiguration(base_hz=1000)
ENDPOINTS = ("fd", "pty", "tcp", "udp")


def place(board: Board) -> tuple[str, int]:
    host, _, port = board.url.partition("//")[2].rpartition(":")
    return host, int(port)


def dial(board: Board) -> socket.socket:
    client = socket.create_connection(place(board), timeout=5)
    client.settimeout(5)
    return client


def line(client: socket.socket) -> bytes:
    data = b""
    while not data.endswith(b"\n") and (byte := client.recv(1)):
        data += byte
    return data


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_a_link_reads_writes_leaves_and_comes_back(endpoint: str) -> None:
    with Board(endpoint=endpoint) as board:
        board.registers[0x21] = -2
        for value in (0xDEADBEEF, 7):
            with Link(f"{board.url}?timeout=10") as link:
                link.write(0x20, value)
                assert link.read(0x20) == value
                assert link.read(0x21) == 0xFFFFFFFE
            assert board.registers[0x20] == value
        assert board.registers.signed(0x21) == -2
        assert board.statistics.overruns == 0


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_publishes_reach_the_link(endpoint: str) -> None:
    with Board(configuration=PUBLISHING, endpoint=endpoint) as board, Link(f"{board.url}?timeout=10") as link:
        board.registers[5] = 1234
        subscription = link.subscribe([5, 6], divisor=2)
        seen = 0
        while seen < 10:
            assert subscription.wait(5.0)
            seen += len(subscription.drain()[0])
        assert subscription.lost == 0


def test_tcp_second_client_gets_busy_and_the_next_one_is_accepted() -> None:
    with Board(endpoint="tcp") as board:
        first = dial(board)
        first.sendall(b"$RLC*9B\n")
        assert line(first).startswith(b"$CNF:")
        with dial(board) as second:
            assert line(second) == b"?busy\n"
            assert second.recv(1) == b""
        first.sendall(b"#R:10\n")
        assert line(first) == b"#S_R:00000000\n"
        first.close()
        with dial(board) as third:
            third.sendall(b"#R:10\n")
            assert line(third) == b"#S_R:00000000\n"


def test_tcp_client_that_has_stopped_sending_still_gets_its_answers() -> None:
    """As with `printf '#R:12\\n' | nc -N`, also on a slow line."""
    for configuration in (BoardConfiguration(), BoardConfiguration(baud_hz=3_000_000)):
        with Board(configuration=configuration, endpoint="tcp") as board:
            client = dial(board)
            client.sendall(b"#R:12\n" * 500)
            client.shutdown(socket.SHUT_WR)
            answers = b""
            while data := client.recv(65536):
                answers += data
            assert answers == b"#S_R:00000000\n" * 500, "and then the board lets it go"
            client.close()


def test_clients_that_call_in_a_loop_do_not_stop_the_board() -> None:
    with Board(endpoint="tcp") as board, Link(f"{board.url}?timeout=10") as link:
        done = threading.Event()

        def hammer() -> None:
            while not done.is_set():
                board.registers[5] = board.registers[6]
                assert board.url

        threads = [threading.Thread(target=hammer) for _ in range(3)]
        for thread in threads:
            thread.start()
        try:
            assert [link.read(7) for _ in range(50)] == [0] * 50
        finally:
            done.set()
            for thread in threads:
                thread.join()
        assert link.statistics().timeouts == 0


def test_udp_second_client_gets_busy_until_the_first_one_closes() -> None:
    with Board(endpoint="udp") as board:
        first, second = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        with first, second:
            for client in (first, second):
                client.settimeout(5)
                client.connect(place(board))
            first.send(b"#R:10\n")
            assert first.recv(100) == b"#S_R:00000000\n"
            second.send(b"#R:10\n")
            assert second.recv(100) == b"?busy\n"
            assert first.recv(100) == b"\n"  # the board asked whether the client is still there
            first.send(b"")
            second.send(b"#R:10\n")
            assert second.recv(100) == b"#S_R:00000000\n"


def test_udp_client_that_died_is_replaced() -> None:
    with Board(endpoint="udp") as board:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as dead:
            dead.settimeout(5)
            dead.sendto(b"#R:10\n", place(board))
            assert dead.recv(100) == b"#S_R:00000000\n"
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as alive:
            alive.settimeout(5)
            alive.sendto(b"#R:10\n", place(board))
            assert alive.recv(100) == b"#S_R:00000000\n"


def test_pty_at_a_path_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "board.tty"
    with Board(endpoint=f"pty:{path}") as board:
        assert board.url == f"serial:{path}"
        assert path.is_symlink()
        with Link(f"{board.url}?timeout=10") as link:
            assert link.read(0) == 0
    assert not path.is_symlink()
    path.write_text("mine")
    with pytest.raises(LinkNotFound, match="exists"):
        Board(endpoint=f"pty:{path}")
    assert path.read_text() == "mine"


def gone(path: Path, _: ExitStack) -> None:
    """The state after a board was killed: no terminal has its number, or the next board gets it."""
    for descriptor in linked(path):
        os.close(descriptor)


def linked(path: Path) -> tuple[int, int]:
    master, slave = pty.openpty()
    path.symlink_to(os.ttyname(slave))
    return master, slave


def of_another(path: Path, stack: ExitStack) -> None:
    """By now, another terminal has its number."""
    gone(path, stack)
    while not path.exists() or path.stat().st_ctime_ns <= path.lstat().st_ctime_ns:
        if path.exists():  # both were made within the same tick of the clock
            stack.close()
        for descriptor in pty.openpty():
            stack.callback(os.close, descriptor)


def dangling(path: Path, _: ExitStack) -> None:
    path.symlink_to("gone")


@pytest.mark.parametrize("leave", [dangling, gone, of_another])
def test_the_symbolic_link_of_a_killed_board_is_replaced(
    leave: Callable[[Path, ExitStack], None], tmp_path: Path
) -> None:
    path = tmp_path / "board.tty"
    with ExitStack() as stack:
        leave(path, stack)
        with Board(endpoint=f"pty:{path}") as board, Link(f"{board.url}?timeout=10") as link:
            assert link.read(0) == 0


def test_the_symbolic_link_of_a_running_board_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "board.tty"
    with Board(endpoint=f"pty:{path}") as board, Link(f"{board.url}?timeout=10") as link:
        with pytest.raises(LinkNotFound, match="a link to what is in use; choose another name"):
            Board(endpoint=f"pty:{path}")
        assert link.read(0) == 0
    path.symlink_to(tmp_path)
    with pytest.raises(LinkNotFound, match="in use"):
        Board(endpoint=f"pty:{path}")


def test_a_client_that_does_not_read_stops_the_board_and_loses_nothing() -> None:
    # the replies are longer than all buffers on the way
    request, count = b"#RM:20" + b"00" * 32 + b"\n", 4000
    reply = b"#S_RM:" + b"0" * 256 + b"\n"
    with Board(configuration=BoardConfiguration(read_many=32, clock_hz=500_000_000), endpoint="tcp") as board:
        with dial(board) as client:
            sender = threading.Thread(target=client.sendall, args=(request * count,))
            sender.start()
            sender.join(0.05)  # it sends as much as it can while nobody reads
            received = b""
            while len(received) < len(reply) * count:
                assert select.select([client], [], [], 10)[0]
                received += client.recv(1 << 20)
            sender.join()
        assert received == reply * count


def test_published_into_the_void_while_nobody_listens() -> None:
    with Board(configuration=PUBLISHING, endpoint="tcp") as board:
        with dial(board) as client:
            client.sendall(b"#WSA:000105\n#WSR:000001\n#EPS\n")
            while line(client) != b"#S_EPS\n":
                pass
        stepped = threading.Event()
        for _ in range(1000):
            if board.statistics.bytes_dropped > 0:
                break
            stepped.wait(0.005)
        assert board.statistics.bytes_dropped > 0
        with Link(f"{board.url}?timeout=10") as link:  # a link also works on a board that already publishes
            assert link.read(5) == 0


def test_event_publishes_once() -> None:
    with Board(endpoint="tcp") as board, dial(board) as client:
        client.sendall(b"#WSA:030105\n#WIC:0008\n#EPS\n")
        while line(client) != b"#S_EPS\n":
            pass
        board.event(3)
        assert line(client) == b"%PUB:030100000000\n"
        client.sendall(b"#R:05\n")
        assert line(client) == b"#S_R:00000000\n"
        with pytest.raises(ValueRangeError, match="groups 0 to 15"):
            board.event(16)


def test_physical_errors_are_told() -> None:
    with Board(endpoint="tcp") as board, dial(board) as client:
        client.sendall(b"#R:05\n")
        line(client)
        board.receive_error(1)
        assert line(client) == b"?f6\n"


def test_closing_the_board_ends_the_link() -> None:
    board = Board(endpoint="tcp")
    with dial(board) as client:
        client.sendall(b"#R:05\n")
        line(client)
        board.close()
        board.close()
        assert client.recv(1) == b""
    assert board.closed
    with pytest.raises(UnityLinkError, match="closed"):
        assert board.url


@pytest.mark.parametrize(
    ("endpoint", "words"),
    [
        ("carrier pigeon", "is not known"),
        ("tcp:http", "not a port"),
        ("tcp:70000", "not a port"),
        ("pty:/nowhere/board.tty", "No such file"),
    ],
)
def test_endpoints_that_cannot_be(endpoint: str, words: str) -> None:
    with pytest.raises(LinkNotFound, match=words):
        Board(endpoint=endpoint)


def test_port_in_use_and_foreign_address() -> None:
    with Board(endpoint="tcp") as board, pytest.raises(LinkNotFound, match="another program has this port"):
        Board(endpoint=f"tcp:{place(board)[1]}")
    with pytest.raises(LinkNotFound, match="give an address of this machine"):
        Board(endpoint="tcp", bind="no such host")


class Counting:
    period_s = 0.001

    def __init__(self, fail_at: int = 0) -> None:
        self.steps = 0
        self.fail_at = fail_at
        self.times: list[float] = []
        self.enough = threading.Event()

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.registers = registers

    def step(self, time_s: float) -> None:
        self.steps += 1
        self.times.append(time_s)
        self.registers[1] = self.steps
        if self.steps == self.fail_at:
            self.enough.set()
            raise ZeroDivisionError("the mechanics broke")
        if self.steps >= 20:
            self.enough.set()


def test_a_plant_is_stepped_on_the_device_clock() -> None:
    plant = Counting()
    with Board(plant=plant) as board:
        assert plant.enough.wait(10)
    assert plant.times[:20] == pytest.approx([i * 0.001 for i in range(20)])
    assert board.error is None


def test_a_plant_that_fails_is_reported_and_the_board_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    plant = Counting(fail_at=3)
    with Board(plant=plant) as board:
        assert plant.enough.wait(10)
        with Link(f"{board.url}?timeout=10") as link:
            assert link.read(1) == 3
        while board.error is None:
            os.sched_yield()
        assert "the mechanics broke" in str(board.error)
        assert isinstance(board.error.__cause__, ZeroDivisionError)
    assert plant.steps == 3
    assert "Counting" in caplog.text


def test_plants_that_cannot_be_attached_or_leave_the_program_are_reported() -> None:
    class Lost(Counting):
        def attach(self, spec: Spec | None, registers: Registers) -> None:
            raise KeyError("j1")

    class Leaving(Counting):
        def step(self, time_s: float) -> None:
            self.enough.set()
            sys.exit(3)

    with pytest.raises(UnityLinkError, match=r"Lost.attach\(\): KeyError: 'j1'"):
        Board(plant=Lost())
    plant = Leaving()
    with Board(plant=plant) as board:
        assert plant.enough.wait(10)
        while board.error is None:
            os.sched_yield()
        assert "SystemExit: 3" in str(board.error)


def test_a_plant_may_end_its_own_board() -> None:
    class Ending(Counting):
        def step(self, time_s: float) -> None:
            if made.is_set():
                board.close()
                self.enough.set()

    made = threading.Event()
    plant = Ending()
    board = Board(plant=plant, endpoint="tcp")
    client = dial(board)
    client.sendall(b"#R:02\n")
    assert line(client) == b"#S_R:00000000\n"
    made.set()
    assert plant.enough.wait(10)
    assert client.recv(1) == b"", "its client sees it go"
    board.close()
    assert board.closed
    client.close()


def test_registers_are_read_and_set_many_at_once() -> None:
    with Board() as board:
        registers = board.registers
        registers.write_many([3, 1, 2], [30, -1, 0xFFFFFFFF])
        assert registers.read_many([1, 2, 3]) == [0xFFFFFFFF, 0xFFFFFFFF, 30]
        assert registers.read_many([]) == []
        with pytest.raises(ValueRangeError, match="0x0005 has 32 bits; 4294967296 does not fit"):
            registers.write_many([4, 5], [1, 1 << 32])
        with pytest.raises(ValueRangeError, match="0x0100 cannot be read"):
            registers.read_many([1, 0x100, 2])
        with pytest.raises(ValueRangeError, match="0x0100 cannot be set"):
            registers.write_many([1, 0x100], [7, 8])
        assert registers[1] == 7


def test_registers_refuse_what_does_not_fit() -> None:
    with Board() as board:
        for value in (1 << 32, -(1 << 31) - 1):
            with pytest.raises(ValueRangeError, match="does not fit"):
                board.registers[0] = value
        with pytest.raises(ValueRangeError, match="nothing is there"):
            assert board.registers[0x100]
        with pytest.raises(ValueRangeError, match="cannot be set"):
            board.registers[0x100] = 1
