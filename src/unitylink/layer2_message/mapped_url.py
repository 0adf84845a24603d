# SPDX-License-Identifier: BSD-3-Clause
"""`mmap:` URLs: a window of a device or file."""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import parse_qsl

from unitylink.errors import LinkError, LinkNotFound, UrlError
from unitylink.protocol import BASE_HZ_DEFAULT

WORD_BYTES = 4
_OPTIONS = ("offset", "size", "address_bytes", "base_hz")
_UIO = re.compile(r"/dev/(uio\d+)")


@dataclass(frozen=True)
class MappedUrl:
    """A window of `size` bytes from `offset` on. `base_hz` is the frequency that divisors divide."""

    path: str
    offset: int
    size: int
    address_bytes: int
    base_hz: int


def parse_mapped_url(url: str) -> MappedUrl:
    """Return the parts of `mmap:PATH?offset=&size=&address_bytes=&base_hz=`.

    Without `size` the window goes to the end of the file (a BAR in sysfs has one) or of the UIO device's map.
    Raises UrlError, LinkNotFound.
    """
    path, _, query = url.removeprefix("mmap:").partition("?")
    if not path:
        raise UrlError(f"{url!r}: names no device; write mmap:/dev/uio0?size=4096")
    try:
        given = dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
    except ValueError as error:
        raise UrlError(f"{url!r}: {error}; options are option=value, with & between them") from error
    if unknown := [name for name in given if name not in _OPTIONS]:
        raise UrlError(
            f"{url!r}: {unknown[0]} means nothing to mapped memory, which has no protocol; "
            f"there are: {', '.join(_OPTIONS)}"
        )
    numbers = {name: _number(url, name, text) for name, text in given.items()}
    offset = numbers.get("offset", 0)
    size = numbers["size"] if "size" in numbers else _size_of(url, path, offset)
    for name, value in (("offset", offset), ("size", size)):
        if value % WORD_BYTES:
            raise UrlError(f"{url!r}: {name} {value} is no multiple of {WORD_BYTES}: words are 32 bits")
    if not 0 < size <= WORD_BYTES << 32:
        raise UrlError(f"{url!r}: size is {size} bytes; a window has 4 bytes to 16 GiB")
    _within(url, path, offset + size)
    needed = max(1, -(-(size // WORD_BYTES - 1).bit_length() // 8))
    address_bytes = numbers.get("address_bytes", needed)
    if not 1 <= address_bytes <= 4:
        raise UrlError(f"{url!r}: address_bytes is {address_bytes}; choose 1 to 4")
    base_hz = numbers.get("base_hz", BASE_HZ_DEFAULT)
    if base_hz < 1:
        raise UrlError(f"{url!r}: base_hz is {base_hz}; choose 1 or more")
    return MappedUrl(path, offset, size, address_bytes, base_hz)


def _number(url: str, name: str, text: str) -> int:
    try:
        number = int(text, 0)
    except ValueError:
        number = -1
    if number < 0:
        raise UrlError(f"{url!r}: {name}={text} is not a whole number from 0 on")
    return number


def _size_of(url: str, path: str, offset: int) -> int:
    """Return the number of bytes from `offset` on, if the system knows it."""
    size = _file_bytes(path)
    found = _UIO.fullmatch(path)
    if found is not None:  # offset n pages chooses map n of a UIO device
        number = offset // os.sysconf("SC_PAGESIZE")
        try:
            text = Path(f"/sys/class/uio/{found[1]}/maps/map{number}/size").read_text(encoding="ascii")
            return int(text, 0)
        except (OSError, ValueError) as error:
            raise UrlError(f"{url!r}: {path} does not tell the size of map {number}: say size=") from error
    if size is None:
        raise UrlError(f"{url!r}: {path} does not report its size: add size= in bytes")
    if size <= offset:
        raise UrlError(f"{url!r}: {path} has {size} bytes, and offset is {offset}")
    return size - offset


def _within(url: str, path: str, end: int) -> None:
    """Refuse a window beyond the end of a file: an access there would end the program."""
    size = _file_bytes(path)
    if size is not None and end > size:
        raise UrlError(f"{url!r}: the window ends at byte {end}, and {path} has {size}")


def _file_bytes(path: str) -> int | None:
    """Return the size of a regular file, None for a device."""
    try:
        status = os.stat(path)
    except FileNotFoundError as error:
        raise LinkNotFound(f"{path}: there is no such device or file") from error
    except OSError as error:
        raise LinkError(f"{path}: {error.strerror or error}") from error
    return status.st_size if stat.S_ISREG(status.st_mode) else None
