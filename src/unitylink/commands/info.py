# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink info`: the configuration of a device, and the statistics of the link."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from unitylink.connection.schemes import SCHEMES
from unitylink.errors import DeviceMismatch

from .link_option import Target, link_argument, open_target, spec_option
from .output import json_option, print_fields, print_json
from .ring_output import ring_fields

if TYPE_CHECKING:
    from unitylink.layer2_message import Configuration
    from unitylink.spec.model import Spec

_WIDTH = max(len(scheme.form) for scheme in SCHEMES.values())
_HELP = """Show the configuration of a device, the state of its network, and the statistics of the link.

\b
LINK is one of
{forms}
Options follow a `?`, divided by `&`: timeout= (s) attempts= fifo= (bytes) crc=0|1 window=
gateware=auto|2012|corrected.

\b
Examples:
  unitylink info "serial:/dev/ttyUSB0?baud=3000000"
  unitylink info tcp://127.0.0.1:5555 --spec arm.ul
  unitylink info sim:arm.ul --json
""".format(forms="\n".join(f"  {scheme.form:{_WIDTH}}  {scheme.what}" for scheme in SCHEMES.values()))
_PUBLISHING = {0: "none", 1: "after requests", 2: "before requests"}


@click.command(help=_HELP)
@link_argument
@spec_option
@json_option("all of it")
def command(link: str, spec_file: str | None, as_json: bool) -> None:
    """The help text is in `help` above."""
    from unitylink.spec.isochrony.ring import ring_budget
    from unitylink.spec.ring import ring_at

    with open_target(link, spec_file, check=False) as target:
        configuration = target.link.configuration
        bases = _tosnet_bases(target.spec)
        networks = {f"0x{base:04X}": _network(target, base) for base in bases}
        rings = [ring_budget(ring_at(target.spec, base)) for base in bases if target.spec]
        report: dict[str, Any] = {
            "link": target.link.url,
            "configuration": {**asdict(configuration), "usable_group_size": configuration.usable_group_size},
            "spec": _spec(target),
            "protocol": target.link.protocol,
            "notice": target.link.notice,
            "device": asdict(target.link.description) if target.link.description else None,
            "health": asdict(health) if (health := target.link.health()) else None,
            "binding": _binding(target),
            "networks": {
                base: {**network, "budget": asdict(ring)}
                for (base, network), ring in zip(networks.items(), rings, strict=True)
            },
            "statistics": asdict(target.link.statistics()),
        }
    if as_json:
        print_json(report)
        return
    protocol = report["protocol"] + (f": {report['notice']}" if report["notice"] else "")
    print_fields([("protocol", protocol), *_configuration_fields(configuration)], title=target.link.url)
    if report["health"]:
        print_fields(
            _statistics_fields(report["health"]), title="the device has counted (what is not shown is 0)"
        )
    verdict = "verified" if report["binding"]["verified"] else f"not verified: {report['binding']['reason']}"
    if report["spec"]:
        print_fields(_spec_fields(report["spec"], verdict), title=f"spec {target.names.source}")
    else:
        print_fields([("binding", verdict)], title="spec: none given")
    for (base, network), ring in zip(networks.items(), rings, strict=True):
        print_fields([*_network_fields(network), *ring_fields(ring)], title=f"TosNet at {base}")
    print_fields(_statistics_fields(report["statistics"]), title="statistics (what is not shown is 0)")


def _tosnet_bases(spec: Spec | None) -> list[int]:
    bindings = [element.link for _, element in spec.walk()] if spec else []
    return sorted({binding.base for binding in bindings if binding.kind == "tosnet"})


def _network(target: Target, base: int) -> dict[str, Any]:
    """Ask the TosNet slave at `base` for its status, its counters and the nodes of its ring."""
    from unitylink.layer3_hardware import TosNetProxy

    proxy = TosNetProxy(target.link, base)
    status, counters = proxy.status(), proxy.counters()
    return {
        "status": str(status),
        "online": status.online,
        "nodes": [asdict(node) for node in proxy.nodes()],
        **asdict(counters),
    }


def _spec(target: Target) -> dict[str, Any] | None:
    """Print what the spec needs and the device cannot do, as far as its configuration tells."""
    spec, configuration = target.spec, target.link.configuration
    if spec is None:
        return None
    items = target.names.all()
    beyond = [item.name for item in items if item.address >> configuration.address_bits]
    hardware = [i for i in items if i.element and i.element.publish and i.element.publish.mode == 1]
    rate_max = (1 << 8 * configuration.rate_bytes) - 1
    slow = [
        i.name for i in hardware if i.element and i.element.publish and i.element.publish.divisor > rate_max
    ]
    silent = bool(hardware) and configuration.publish_mode == 0
    return {
        "name": spec.name,
        "hash": spec.hash,
        "items": len(items),
        "unreachable": beyond,
        "rate_too_slow": slow,
        "publishing_missing": silent,
    }


def _binding(target: Target) -> dict[str, Any]:
    """Tell whether the gateware was built from this spec."""
    link = target.link
    if target.spec is not None:
        try:
            target.names.on(link)
        except DeviceMismatch as error:
            return {"verified": False, "reason": error.message}
        return {"verified": not link.unverified, "reason": link.unverified}
    told = link.description.spec_hash if link.description else 0
    kind = "this" if link.description else "classic"
    known = (
        f"the spec of the gateware has the wire hash {told:016x}"
        if told
        else f"{kind} gateware cannot report its spec"
    )
    return {"verified": False, "reason": f"no spec is given; {known}"}


def _configuration_fields(c: Configuration) -> list[tuple[str, str]]:
    rate = f"base {c.base_hz:,} Hz, divisor up to {(1 << 8 * c.rate_bytes) - 1:,}"
    publishing = _PUBLISHING.get(c.publish_mode, f"mode {c.publish_mode}")
    return [
        (
            "configuration",
            "told by the device" if c.discovered else "from the URL; the device does not tell its own",
        ),
        ("address", f"{c.address_bits} bits"),
        ("data", f"{c.data_bits} bits"),
        ("read-many", f"up to {c.read_many} words" if c.read_many else "not supported"),
        ("publishing", f"{publishing}; {rate}" if c.publish_mode else "not supported"),
        (
            "groups",
            f"{c.groups} of {c.group_size} addresses, {c.usable_group_size} of them usable"
            if c.groups
            else "none",
        ),
    ]


def _spec_fields(report: dict[str, Any], binding: str) -> list[tuple[str, str]]:
    fields = [
        ("name", report["name"]),
        ("hash", report["hash"]),
        ("items", f"{report['items']:,}"),
        ("binding", binding),
    ]
    if report["unreachable"]:
        fields.append(("beyond the address bus", ", ".join(report["unreachable"])))
    if report["rate_too_slow"]:
        fields.append(("divisor too large", ", ".join(report["rate_too_slow"])))
    if report["publishing_missing"]:
        fields.append(("publishing", "the spec asks for it and the device has none"))
    return fields


def _network_fields(network: dict[str, Any]) -> list[tuple[str, str]]:
    nodes = [
        f"{n['node_id']} (registers {', '.join(map(str, n['registers'])) or 'none'})"
        for n in network["nodes"]
    ]
    counts = f"{network['packets']:,} packets, {network['resets']:,} resets, {network['errors']:,} errors"
    return [("status", network["status"]), ("nodes", "; ".join(nodes) or "none"), ("counters", counts)]


def _statistics_fields(counters: dict[str, int]) -> list[tuple[str, str]]:
    return [(name.replace("_", " "), f"{count:,}") for name, count in counters.items() if count]
