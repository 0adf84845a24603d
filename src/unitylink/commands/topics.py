# SPDX-License-Identifier: BSD-3-Clause
"""The topics of a recording. Each has the values that are sampled together, at one rate or event."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from unitylink.spec.model import Publish

if TYPE_CHECKING:
    from unitylink.layer4_data.publication import PublishReport

    from .names import Item

_OTHER = re.compile(r"[^A-Za-z0-9_/]+")


def topics_of(
    robot: str, items: Iterable[Item], reports: Iterable[PublishReport]
) -> Mapping[tuple[str, ...], str]:
    """Return a topic for each publish by its paths: `/arm/100_hz`, `/arm/on_change`, `/arm/read_10_hz`.

    Several may have the same rate because the gateware's groups are full. Then the writer numbers them.
    """
    published = {item.name: item.element.publish for item in items if item.element is not None}
    return {
        report.paths: _OTHER.sub("_", f"/{robot}/{_when(published.get(report.paths[0]), report)}")
        for report in reports
    }


def _when(publish: Publish | None, report: PublishReport) -> str:
    if publish is None:
        return f"read {report.rate_hz:g} hz"
    if publish.group:
        return publish.group
    return f"on {publish.event or 'change'}" if publish.trigger != "rate" else f"{report.rate_hz:g} hz"
