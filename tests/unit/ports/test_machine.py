# SPDX-License-Identifier: BSD-3-Clause
"""What the operating system knows about ports, read from a copy of its files."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from unitylink.errors import UnityLinkError
from unitylink.ports import Holder, Machine
from unitylink.ports.ftdi import chosen, ftdi_channels
from unitylink.ports.udev import RULES_FILE, install, rules

from .conftest import FakeMachine


def test_a_port_has_the_identity_of_its_usb_device(fake: FakeMachine) -> None:
    fake.usb_port("ttyUSB1", channel=1, latency_ms=16)
    (port,) = fake.machine().serial_ports()
    assert port.identity == "0403:6010 Dual RS232-HS (FTDI) serial FT1234 channel B"
    assert (port.device, port.driver, port.latency_timer_ms) == ("/dev/ttyUSB1", "ftdi_sio", 16)


def test_ports_without_hardware_are_no_ports(fake: FakeMachine) -> None:
    (fake.root / "sys/class/tty/tty0").mkdir()
    (fake.root / "sys/class/tty/ttyS3/device").mkdir(parents=True)
    fake.write("sys/class/tty/ttyS3/type", "0")
    assert fake.machine().serial_ports() == []


def test_a_link_to_the_device_is_the_device(fake: FakeMachine) -> None:
    fake.usb_port()
    (fake.root / "dev/robot").symlink_to(fake.root / "dev/ttyUSB0")
    assert fake.machine().serial_port("/dev/robot").serial_number == "FT1234"


def test_a_port_may_be_named_from_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm.tty").touch()
    monkeypatch.chdir(tmp_path)
    machine = Machine()
    assert machine.exists("./arm.tty") and machine.exists("arm.tty")
    assert not machine.exists("./leg.tty")


@pytest.mark.parametrize(
    ("mode", "uid", "gids", "may"),
    [
        (0o660, 1000, (1000,), False),
        (0o666, 1000, (1000,), True),
        (0o600, 0, (), True),
        (0o440, 1000, (), False),
    ],
)
def test_the_mode_says_who_may(
    fake: FakeMachine, mode: int, uid: int, gids: tuple[int, ...], may: bool
) -> None:
    device = fake.usb_port(mode=mode)
    assert fake.machine(uid=uid, gids=gids).may_open(device) is may


def test_what_an_access_list_grants_counts(fake: FakeMachine, monkeypatch: pytest.MonkeyPatch) -> None:
    device = fake.usb_port(mode=0o660)  # the user is not in its group, but udev's `uaccess` allows the access
    for granted in (True, False):
        monkeypatch.setattr(os, "access", lambda path, mode, granted=granted: granted)
        assert Machine(fake.root).may_open(device) is granted


def test_the_group_of_the_device_may(fake: FakeMachine) -> None:
    device = fake.usb_port(mode=0o660)
    gid = (fake.root / "dev/ttyUSB0").stat().st_gid
    assert fake.machine(uid=4242, gids=(gid,)).may_open(device)
    assert fake.machine().group_of(device)


def test_holders_are_found_by_their_open_files(fake: FakeMachine) -> None:
    device = fake.usb_port()
    fake.process(7, "minicom", holds=device)
    fake.process(8, "bash", holds="/dev/null")
    fake.process(os.getpid(), "pytest", holds=device)  # this program itself does not count
    assert fake.machine().holders(device) == [Holder(7, "minicom")]


def test_modem_manager_counts_unless_told_to_leave_the_port(fake: FakeMachine) -> None:
    device = fake.usb_port()
    assert not fake.machine().modem_manager_probes(device)
    fake.process(9, "ModemManager")
    assert fake.machine().modem_manager_probes(device)
    fake.write("run/udev/data/c188:0", "E:ID_MM_DEVICE_IGNORE=1")
    assert not fake.machine().modem_manager_probes(device)


def test_the_udev_rule_is_written_once(fake: FakeMachine) -> None:
    machine = fake.machine()
    port = machine.serial_port(fake.usb_port())
    install(machine, port)
    install(machine, port)
    text = machine.path(RULES_FILE).read_text()
    assert text == rules(port)
    assert 'ATTRS{idVendor}=="0403", ATTRS{idProduct}=="6010"' in text and 'ATTR{latency_timer}="1"' in text


def test_a_rule_needs_a_usb_device(fake: FakeMachine) -> None:
    with pytest.raises(UnityLinkError, match="not a USB port"):
        install(fake.machine(), fake.machine().serial_port("/dev/ttyS0"))


def test_the_real_machine_can_be_listed() -> None:
    for port in Machine().serial_ports():
        assert port.device.startswith("/dev/")


def test_ftdi_chips_are_there_with_and_without_a_serial_port(fake: FakeMachine) -> None:
    assert ftdi_channels(fake.machine()) == []
    fake.usb_port("ttyUSB1", channel=1)
    channels = ftdi_channels(fake.machine())
    assert [(one.url, one.port.device, one.node) for one in channels] == [
        ("ftdi:FT1234?channel=A", "", "/dev/bus/usb/001/007"),
        ("ftdi:FT1234?channel=B", "/dev/ttyUSB1", "/dev/bus/usb/001/007"),
    ]
    assert channels[1].port.identity == fake.machine().serial_port("/dev/ttyUSB1").identity
    assert chosen(channels, "", "B") == chosen(channels, "FT1234", "B") == channels[1]
    assert chosen(channels, "FT1", "B") is None
    (fake.root / "sys/devices/pci0/usb1/1-1/idProduct").write_text("ffff\n")
    assert ftdi_channels(fake.machine()) == []


def test_the_rule_opens_the_usb_device_too(fake: FakeMachine) -> None:
    fake.usb_port()
    lines = rules(ftdi_channels(fake.machine())[0].port).splitlines()
    assert 'SUBSYSTEM=="usb", ATTR{idVendor}=="0403", ATTR{idProduct}=="6010", TAG+="uaccess"' in lines
