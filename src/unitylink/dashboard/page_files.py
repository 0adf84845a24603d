# SPDX-License-Identifier: BSD-3-Clause
"""The files of the page, which `web/build.mjs` has made, and their compressed form."""

from __future__ import annotations

import gzip
import hashlib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from starlette.requests import Request
from starlette.responses import Response

KINDS = {
    "index.html": "text/html; charset=utf-8",
    "page.js": "text/javascript; charset=utf-8",
    "page.css": "text/css; charset=utf-8",
    "icon.svg": "image/svg+xml",
    "licences.txt": "text/plain; charset=utf-8",
}


@dataclass(frozen=True)
class PageFile:
    """A file, plain and compressed. `tag` changes with its contents."""

    kind: str
    plain: bytes
    small: bytes
    tag: str

    def response(self, request: Request) -> Response:
        """Return the file, or only that it has not changed."""
        headers = {"etag": self.tag, "cache-control": "no-cache", "vary": "accept-encoding"}
        if request.headers.get("if-none-match") == self.tag:
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(self.small, headers={**headers, "content-encoding": "gzip"}, media_type=self.kind)
        return Response(self.plain, headers=headers, media_type=self.kind)


@cache
def page_files() -> dict[str, PageFile]:
    """Return all files of the page by name."""
    found = {}
    for name, kind in KINDS.items():
        plain = (files("unitylink.dashboard") / "page" / name).read_bytes()
        small = gzip.compress(plain, 9, mtime=0)
        found[name] = PageFile(kind, plain, small, f'"{hashlib.sha256(plain).hexdigest()[:16]}"')
    return found
