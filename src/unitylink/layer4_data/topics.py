# SPDX-License-Identifier: BSD-3-Clause
"""Names for publishes. Each has the values that are sampled together, at one rate or event."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from unitylink.spec.model import Publish

from .publication import PublishReport

_OTHER = re.compile(r"[^A-Za-z0-9_/]+")


def topics_of(
    robot: str, publishes: Mapping[str, Publish | None], reports: Iterable[PublishReport]
) -> dict[tuple[str, ...], str]:
    """Return a topic for each publish by its paths: `/arm/100_hz`, `/arm/on_change`, `/arm/read_10_hz`.

    `publishes` says by path what the spec says. Several may have the same name, because the gateware's groups
    are full. Who uses the names then numbers them.
    """
    return {
        report.paths: _OTHER.sub("_", f"/{robot}/{_when(publishes.get(report.paths[0]), report)}")
        for report in reports
    }


def _when(publish: Publish | None, report: PublishReport) -> str:
    if publish is None:
        return f"read {report.rate_hz:g} hz"
    if publish.group:
        return publish.group
    return f"on {publish.event or 'change'}" if publish.trigger != "rate" else f"{report.rate_hz:g} hz"
