# SPDX-License-Identifier: BSD-3-Clause
"""What belongs together: a generated file with this library and its spec, a tree of values with its links."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from unitylink.errors import BindingError
from unitylink.layer3_hardware import HardwareProxy, MemoryProxy, TosNetProxy

from .publishing import Publisher

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

BINDING_VERSION = 1  # what generated code expects of this layer; raised when that changes


def check(file: str, *, source: str, spec_hash: str, binding_version: int) -> None:
    """Refuse a generated file that is foreign (other library) or stale (its spec has changed since).

    Generated modules call it when they are imported, with their own `__file__`. The spec is looked for beside
    the file; where it is not there, only the library can be checked.
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
    from unitylink.spec import compile_file  # only here: most generated files do not lie beside their spec

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
    """What the nodes of one tree share: links by parameter name, addresses, display names, publisher."""

    def __init__(
        self,
        link: Link,
        links: Mapping[str, Link | None] | None = None,
        *,
        addresses: Mapping[str, int],
        names: Mapping[str, str] | None = None,
    ) -> None:
        self.link = link
        self.links = dict(links or {})
        self.addresses = addresses
        self.names = names or {}
        self.publisher = Publisher()

    def hardware(
        self, kind: str, *, base: int = 0, ctrl: str | None = None, comm: str | None = None
    ) -> HardwareProxy:
        """Return the proxy of a link binding; `comm` carries the data, `ctrl` what controls the module."""
        return hardware_for(kind, self._named(comm), base, self._named(ctrl))

    def _named(self, parameter: str | None) -> Link:
        chosen = self.links.get(parameter) if parameter is not None else None
        return chosen if chosen is not None else self.link


# A TosNet module has one shadow of its outputs, however many trees reach it: living proxies are shared.
_lock = threading.Lock()
_shared: WeakValueDictionary[tuple[str, int, int, int], HardwareProxy] = WeakValueDictionary()


def hardware_for(kind: str, link: Link, base: int = 0, control: Link | None = None) -> HardwareProxy:
    """Return the one proxy for a module: `kind` is "memory" or "tosnet"."""
    control = control if control is not None else link
    key = (kind, id(link), base, id(control))  # a living proxy keeps its links, so their ids stay theirs
    with _lock:
        proxy = _shared.get(key)
        if proxy is None:
            if kind == "tosnet":
                proxy = TosNetProxy(link, base, control=control)
            elif kind == "memory":
                proxy = MemoryProxy(link, base)
            else:
                raise BindingError(f"no hardware proxy is called {kind!r}; there are memory and tosnet")
            _shared[key] = proxy
        return proxy
