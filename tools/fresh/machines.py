# SPDX-License-Identifier: BSD-3-Clause
"""The machine on which a target is tried: this one with an empty home, or a bare Debian in a folder."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

# What a command may know about this machine: its programs, its language, its network, its compiler.
KEPT = re.compile(
    r"PATH|LANG|LC_\w+|TERM|TZ|CC|CXX|\w+_proxy|SSL_CERT_\w+|REQUESTS_CA_BUNDLE|PIP_\w+|CMAKE_\w+_LAUNCHER|CCACHE_\w+",
    re.IGNORECASE,
)
# What README.md asks for, and what apt-get and pip need to reach a server.
ASKED = ("git", "make", "python3", "python3-venv", "python3-dev", "g++", "ca-certificates")
# times to look for running processes; while a process starts another program, its environment is empty
LOOKS = 5
RELEASE, ARCHIVE = "bookworm", "http://deb.debian.org/debian"


class Absent(Exception):
    """The requested machine cannot be made here."""


@dataclass(frozen=True)
class Here:
    """This machine.

    This machine with an empty home. Its Debian packages stay, so this does not test whether a target installs
    those.

    `downloads` is a folder that keeps what pip has fetched. Without it, each target fetches everything again.
    """

    downloads: Path | None = None

    def run(self, folder: Path, command: list[str], log: int) -> subprocess.Popen[bytes]:
        """Start `command` in the clone folder/checkout, with folder/home as its empty home."""
        home = folder / "home"
        home.mkdir()
        return subprocess.Popen(
            command,
            cwd=folder / "checkout",
            env=self.environment(home, os.environ),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    def end_all(self, folder: Path) -> None:
        """End every process that still runs with this home.

        Ninja starts each compiler in a process group of its own.
        """
        mark = f"HOME={folder / 'home'}".encode()
        unseen = 0
        while unseen < LOOKS:
            pids = [name for name in os.listdir("/proc") if name.isdigit() and mark in _started_with(name)]
            for pid in pids:
                with suppress(ProcessLookupError):
                    os.kill(int(pid), signal.SIGKILL)
            unseen = 0 if pids else unseen + 1
            time.sleep(0.01)

    def environment(self, home: Path, mine: Mapping[str, str]) -> dict[str, str]:
        """Return the environment of a new user of this machine."""
        kept = {name: value for name, value in mine.items() if KEPT.fullmatch(name)}
        kept.pop("PIP_CACHE_DIR", None)
        # an active virtual environment does not belong to the machine
        virtual = Path(mine.get("VIRTUAL_ENV") or "/nowhere")
        places = [
            place for place in mine.get("PATH", os.defpath).split(":") if Path(place) != virtual / "bin"
        ]
        caches = {"PIP_CACHE_DIR": str(self.downloads / "pip")} if self.downloads else {}
        return kept | {"HOME": str(home), "PATH": ":".join(places)} | caches


def _started_with(pid: str) -> list[bytes]:
    """Return the environment with which a process was started. It is empty if the process has ended."""
    try:
        return Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return []


@dataclass(frozen=True)
class Debian:
    """A bare Debian in `base`. Each target sees only its own changes to it. It needs root and debootstrap.

    `downloads` keeps what pip and apt-get have fetched.
    """

    base: Path
    downloads: Path | None = None

    def make(self) -> None:
        """Make the base if it is not there. It has only what README.md asks for."""
        if os.geteuid() != 0 or not shutil.which("debootstrap"):
            raise Absent("a bare Debian needs root and debootstrap: apt-get install debootstrap")
        if (self.base / ".made").exists():
            return
        shutil.rmtree(self.base, ignore_errors=True)
        self.base.mkdir(parents=True)
        options = ["--variant=minbase", f"--include={','.join(ASKED)}"]
        with (self.base.parent / "debootstrap.log").open("wb") as log:
            made = subprocess.run(
                ["debootstrap", *options, RELEASE, self.base, ARCHIVE],
                stdout=log,
                stderr=log,
                check=False,
            )
        if made.returncode:
            raise Absent(f"debootstrap made no Debian: {log.name}")
        # the files that are needed to reach the servers
        for file in ("/etc/resolv.conf", "/etc/ssl/certs/ca-certificates.crt"):
            shutil.copyfile(file, f"{self.base}{file}")
        services = self.base / "usr/sbin/policy-rc.d"
        services.write_text("#!/bin/sh\nexit 101\n")  # packages must not start services here
        services.chmod(0o755)
        (self.base / ".made").touch()

    def run(self, folder: Path, command: list[str], log: int) -> subprocess.Popen[bytes]:
        """Start `command` in the clone folder/checkout. Its changes to the system are in folder/changes."""
        for name in ("changes", "work", "system"):
            (folder / name).mkdir()
        words = ["env", "-i", f"HOME={_HOME}", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LANG=C.UTF-8"]
        network = ("PIP_CERT", "PIP_DEFAULT_TIMEOUT")
        words += [f"{name}={os.environ[name]}" for name in network if name in os.environ]
        inside = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "bash", "-euc", _ENTER, "enter"]
        return subprocess.Popen(
            [*inside, str(self.base), str(folder), str(self.downloads or ""), *words, *command],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    def end_all(self, folder: Path) -> None:
        """Do nothing. When the first process of a process namespace ends, all others end with it."""


_HOME = "/home/new"  # the home of the user in that Debian
# enter BASE FOLDER DOWNLOADS COMMAND...: it puts a layer above the base, and the clone into the new home
_ENTER = f"""
base=$1 folder=$2 downloads=$3 system=$2/system
home=$system{_HOME}
shift 3
mount -t overlay overlay -o "lowerdir=$base,upperdir=$folder/changes,workdir=$folder/work" "$system"
mount -t proc proc "$system/proc"
mount --rbind /dev "$system/dev"
mount --rbind /sys "$system/sys"
mkdir -p "$home/checkout"
mount --bind "$folder/checkout" "$home/checkout"
if [ -n "$downloads" ]; then
  mkdir -p "$downloads/apt/partial" "$downloads/pip" "$home/.cache/pip"
  mount --bind "$downloads/apt" "$system/var/cache/apt/archives"
  mount --bind "$downloads/pip" "$home/.cache/pip"
fi
exec chroot "$system" bash -c 'cd {_HOME}/checkout && exec "$@"' make "$@"
"""
