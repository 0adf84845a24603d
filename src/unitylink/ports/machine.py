# SPDX-License-Identifier: BSD-3-Clause
"""What this machine knows about its serial ports, read from /sys, /dev, /proc and /run/udev.

The sources are Documentation/ABI/testing/sysfs-bus-usb and sysfs-tty of the Linux kernel. latency_timer is an
attribute of the kernel's ftdi_sio driver.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

_CHANNELS = "ABCD"
_PORT_NAMES = ("ttyUSB", "ttyACM", "ttyS", "ttyAMA", "ttyXR", "ttyO", "ttyTHS")


@dataclass(frozen=True)
class Holder:
    """A process that has a port open."""

    pid: int
    command: str


@dataclass(frozen=True)
class SerialPort:
    """A serial port.

    A field is empty or None if the operating system does not report it. This is so for ports that are not
    USB.

    `latency_timer_ms` is how long an FTDI chip waits before it sends a USB packet that is not full.
    """

    device: str
    vendor_id: int | None = None
    product_id: int | None = None
    manufacturer: str = ""
    product: str = ""
    serial_number: str = ""
    channel: str = ""
    driver: str = ""
    latency_timer_ms: int | None = None

    @property
    def identity(self) -> str:
        """`0403:6010 Dual RS232-HS (FTDI) serial FT1234 channel A`, as far as it is known."""
        parts = []
        if self.vendor_id is not None and self.product_id is not None:
            parts.append(f"{self.vendor_id:04x}:{self.product_id:04x}")
        if self.product:
            parts.append(self.product)
        if self.manufacturer:
            parts.append(f"({self.manufacturer})")
        if self.serial_number:
            parts.append(f"serial {self.serial_number}")
        if self.channel:
            parts.append(f"channel {self.channel}")
        return " ".join(parts)


class Machine:
    """The machine whose files are below `root`, as the user `uid` with the groups `gids` sees it."""

    def __init__(
        self, root: str | Path = "/", *, uid: int | None = None, gids: Collection[int] | None = None
    ) -> None:
        self.root = Path(root)
        self._is_this_user = uid is None and gids is None
        self.uid = os.getuid() if uid is None else uid
        self.gids = frozenset((*os.getgroups(), os.getgid()) if gids is None else gids)

    def path(self, name: str) -> Path:
        """Return the path of the file `name` below the root.

        Without a leading slash, it is relative to the working folder.
        """
        return self.root / os.path.abspath(name).lstrip("/")

    # ---- the ports of this machine

    def serial_ports(self) -> list[SerialPort]:
        """Return the ports with hardware behind them, by name.

        A port that disappears meanwhile is left out.
        """
        found = []
        for entry in entries(self.path("/sys/class/tty")):
            hardware = entry / "device"
            if entry.name.startswith(_PORT_NAMES) and hardware.exists() and _is_real(entry):
                found.append(self._port(f"/dev/{entry.name}", hardware.resolve()))
        return sorted(found, key=lambda port: (len(port.device), port.device))

    def spi_ports(self) -> list[str]:
        """Return the device files of the kernel's spidev, one for each chip select."""
        return [f"/dev/{entry.name}" for entry in entries(self.path("/sys/class/spidev"))]

    def serial_port(self, device: str) -> SerialPort:
        """Return what is known of one device file. Links such as /dev/serial/by-id/... are followed."""
        name = os.path.basename(os.path.realpath(self.path(device)))
        hardware = self.path(f"/sys/class/tty/{name}/device")
        return self._port(device, hardware.resolve()) if hardware.exists() else SerialPort(device)

    def _port(self, device: str, hardware: Path) -> SerialPort:
        usb = next(
            (folder for folder in (hardware, *hardware.parents) if (folder / "idVendor").is_file()), None
        )
        interface = next(
            (f for f in (hardware, *hardware.parents) if (f / "bInterfaceNumber").is_file()), None
        )
        driver = hardware / "driver"
        latency = text(hardware / "latency_timer")
        vendor = text(usb / "idVendor") if usb else ""
        product_id = text(usb / "idProduct") if usb else ""
        number = hexadecimal(text(interface / "bInterfaceNumber")) if interface else None
        several = usb is not None and (hexadecimal(text(usb / "bNumInterfaces")) or 1) > 1
        return SerialPort(
            device=device,
            vendor_id=hexadecimal(vendor),
            product_id=hexadecimal(product_id),
            manufacturer=text(usb / "manufacturer") if usb else "",
            product=text(usb / "product") if usb else "",
            serial_number=text(usb / "serial") if usb else "",
            channel=_CHANNELS[number] if several and number is not None and number < len(_CHANNELS) else "",
            driver=driver.resolve().name if driver.exists() else "",
            latency_timer_ms=int(latency) if latency.isdigit() else None,
        )

    # ---- who may open a port, and who has it open

    def exists(self, device: str) -> bool:
        return self.path(device).exists()

    def is_serial(self, device: str) -> bool:
        """Tell whether an existing file can be a serial port. /dev/null cannot."""
        real = Path(os.path.realpath(self.path(device)))
        known = self.path(f"/sys/class/tty/{real.name}").exists()
        return known or real.name.startswith("tty") or real.parent.name == "pts"

    def may_open(self, device: str) -> bool:
        """Tell whether the user may read and write the device file.

        For this user, the operating system decides. It knows the rights of an access list, such as that of
        `uaccess`. For another user, the mode of the file decides.
        """
        if self._is_this_user:
            return os.access(self.path(device), os.R_OK | os.W_OK)
        if self.uid == 0:
            return True
        try:
            status = self.path(device).stat()
        except OSError:
            return False
        shift = 6 if status.st_uid == self.uid else 3 if status.st_gid in self.gids else 0
        return status.st_mode >> shift & 0o6 == 0o6

    def group_of(self, device: str) -> str:
        """Return the name of the group that owns the device file, or its number if it has no name."""
        import grp

        gid = self.path(device).stat().st_gid
        try:
            return grp.getgrgid(gid).gr_name
        except KeyError:
            return str(gid)

    def holders(self, device: str) -> list[Holder]:
        """Return the other processes that have the device open. Only root can see those of other users."""
        target = os.path.realpath(self.path(device))
        found = []
        for process in entries(self.path("/proc")):
            if not process.name.isdigit() or int(process.name) == os.getpid():
                continue
            if any(self._leads_to(descriptor, target) for descriptor in entries(process / "fd")):
                found.append(Holder(int(process.name), text(process / "comm") or "?"))
        return found

    def _leads_to(self, descriptor: Path, target: str) -> bool:
        try:
            link = os.readlink(descriptor)
        except OSError:
            return False
        return os.path.realpath(self.path(link) if link.startswith("/") else link) == target

    def runs(self, command: str) -> bool:
        """Tell whether a process of this name runs."""
        return any(
            process.name.isdigit() and text(process / "comm") == command
            for process in entries(self.path("/proc"))
        )

    def modem_manager_probes(self, device: str) -> bool:
        """Tell whether ModemManager runs and has not been told to leave the device alone."""
        return self.runs("ModemManager") and "E:ID_MM_DEVICE_IGNORE=1" not in self._udev_properties(device)

    def _udev_properties(self, device: str) -> set[str]:
        name = os.path.basename(os.path.realpath(self.path(device)))
        numbers = text(self.path(f"/sys/class/tty/{name}/dev"))
        return set(text(self.path(f"/run/udev/data/c{numbers}")).splitlines()) if numbers else set()


def _is_real(entry: Path) -> bool:
    """Leave out the ports that a PC's serial driver offers without hardware (type 0)."""
    kind = text(entry / "type")
    return kind != "0"


def entries(folder: Path) -> Iterator[Path]:
    try:
        yield from sorted(folder.iterdir())
    except OSError:  # it belongs to another user, or is already gone
        return


def text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        return ""


def hexadecimal(text: str) -> int | None:
    try:
        return int(text, 16)
    except ValueError:
        return None
