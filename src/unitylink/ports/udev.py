# SPDX-License-Identifier: BSD-3-Clause
"""The udev rule with which a local user can talk to a board, fast and undisturbed.

The keys are from udev(7), and from ModemManager's documentation of ID_MM_DEVICE_IGNORE.
"""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from unitylink.errors import UnityLinkError

from .machine import Machine, SerialPort

RULES_FILE = "/etc/udev/rules.d/70-unitylink.rules"
RELOAD = "sudo udevadm control --reload && sudo udevadm trigger    # or plug the board in anew"


def rules(port: SerialPort) -> str:
    """Return the lines for the kind of USB device behind `port`."""
    match = f'ATTRS{{idVendor}}=="{port.vendor_id:04x}", ATTRS{{idProduct}}=="{port.product_id:04x}"'
    return (
        f"# {port.identity}: for the user at the machine, not for ModemManager, no waiting in the chip\n"
        # set on the USB device too, because ModemManager looks there
        f'{match}, ENV{{ID_MM_DEVICE_IGNORE}}="1"\n'
        f'SUBSYSTEM=="tty", {match}, TAG+="uaccess"\n'
        f'SUBSYSTEM=="usb", ATTR{{idVendor}}=="{port.vendor_id:04x}", '
        f'ATTR{{idProduct}}=="{port.product_id:04x}", TAG+="uaccess"\n'  # for ftdi: links
        f'SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", {match}, ATTR{{latency_timer}}="1"\n'
    )


def program() -> str:
    """Return the full path of this `unitylink`.

    It is typed after sudo, which knows no virtual environment.
    """
    script = Path(sys.executable).with_name("unitylink")
    return shlex.join([str(script)] if script.exists() else [sys.executable, "-m", "unitylink"])


def install(machine: Machine, port: SerialPort) -> str:
    """Add the rules for `port` to RULES_FILE, but only once. Return the file's name.

    Raises UnityLinkError for a port that is not USB, or if the file cannot be written.
    """
    if port.vendor_id is None or port.product_id is None:
        raise UnityLinkError(f"{port.device} is not a USB port: no udev rule can tell it from others")
    path = machine.path(RULES_FILE)
    try:
        present = path.read_text(encoding="utf-8") if path.exists() else ""
        wanted = rules(port)
        if wanted.partition("\n")[2] not in present:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(present + wanted, encoding="utf-8")
    except OSError as error:
        raise UnityLinkError(
            f"{path}: {error.strerror or error}; run it as root: sudo {program()} doctor LINK --install"
        ) from error
    return str(path)
