# SPDX-License-Identifier: BSD-3-Clause
"""Whether things belong together: a generated file with library and spec, a tree of values with its links."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from unitylink.errors import BindingError
from unitylink.layer3_hardware import (
    DoubleBufferProxy,
    FifoProxy,
    HardwareProxy,
    MemoryProxy,
    TosNetProxy,
)

from .names import BINDING_VERSION
from .publishing import Publisher

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


def check(file: str, *, source: str, spec_hash: str, binding_version: int) -> None:
    """Refuse a generated file if it is foreign (of another library) or stale (its spec has changed since).

    Generated modules call it with their own `__file__` when they are imported. The spec is looked for beside
    the file. Without it, only the library is checked.
    """
    spec_file = Path(file).parent / source
    beside = spec_file.is_file()
    remedy = f"run: unitylink generate {spec_file if beside else source} --out {Path(file).parent}"
    if binding_version != BINDING_VERSION:
        raise BindingError(
            f"{file} was generated for binding version {binding_version}, this library has "
            f"{BINDING_VERSION}; {remedy}"
        )
    if not beside:
        return
    # imported here, because most generated files have no spec beside them
    from unitylink.spec import compile_file

    spec = compile_file(spec_file).spec
    if spec is None:
        raise BindingError(
            f"{file} belongs to {spec_file}, which has errors; "
            f"run: unitylink check {spec_file}, then {remedy}"
        )
    if spec.hash != spec_hash:
        raise BindingError(
            f"{file} is stale: it was made from {source} with hash {spec_hash}, "
            f"which is now {spec.hash}; {remedy}"
        )


class Tree:
    """What the nodes of one tree share: links by name, addresses, display names, classes, publisher.

    `links` has the links other than `link`, by the name of a COMM or CTRL parameter or of a declared link.
    `classes` has the Python classes of enumerations and packed values. `source` is the name of the spec.
    `gateware` has the possible wire hashes of the gateware behind each link in use, by the link's name (""
    for `link`). Another hash raises DeviceMismatch, see `Link.check_spec`.
    """

    def __init__(
        self,
        link: Link,
        links: Mapping[str, Link | None] | None = None,
        *,
        source: str = "",
        gateware: Mapping[str, Sequence[int]] | None = None,
        addresses: Mapping[str, int],
        names: Mapping[str, str] | None = None,
        classes: Mapping[str, type[Any]] | None = None,
    ) -> None:
        self.link = link
        self.links = dict(links or {})
        self.addresses = addresses
        self.names = names or {}
        self.classes = classes or {}
        self.publisher = Publisher()
        for name, hashes in (gateware or {}).items():
            self.link_of(name).check_spec(source, hashes)

    def hardware(
        self,
        kind: str,
        *,
        base: int = 0,
        ctrl: str | None = None,
        comm: str | None = None,
        size: int = 0,
        link: str = "",
    ) -> HardwareProxy:
        """Return the proxy of a link binding. `comm` carries the data, `ctrl` controls the module."""
        return hardware_for(kind, self.link_of(comm, link), base, self.link_of(ctrl, link), size)

    def link_of(self, parameter: str | None, declared: str = "") -> Link:
        """Return the link of a COMM or CTRL parameter, or of the name of a declared link."""
        for name in (parameter, declared):
            chosen = self.links.get(name) if name else None
            if chosen is not None:
                return chosen
        return self.link


# A module has one shadow of its outputs, even if several trees use it. So existing proxies are shared.
_lock = threading.Lock()
_shared: WeakValueDictionary[tuple[str, int, int, int, int], HardwareProxy] = WeakValueDictionary()
KINDS = ("memory", "tosnet", "double_buffer", "fifo")


def hardware_for(
    kind: str, link: Link, base: int = 0, control: Link | None = None, size: int = 0
) -> HardwareProxy:
    """Return the only proxy of a module. `kind` is one of KINDS, `size` the words of a double buffer."""
    control = control if control is not None else link
    key = (
        kind,
        id(link),
        base,
        id(control),
        size,
    )  # a proxy in use keeps its links alive, so no other object gets their ids
    with _lock:
        proxy = _shared.get(key)
        if proxy is None:
            if kind == "tosnet":
                proxy = TosNetProxy(link, base, control=control)
            elif kind == "memory":
                proxy = MemoryProxy(link, base)
            elif kind == "double_buffer":
                proxy = DoubleBufferProxy(link, base, size=size)
            elif kind == "fifo":
                proxy = FifoProxy(link, base)
            else:
                raise BindingError(f"no hardware proxy is called {kind!r}; there are {', '.join(KINDS)}")
            _shared[key] = proxy
        return proxy
