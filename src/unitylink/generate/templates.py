# SPDX-License-Identifier: BSD-3-Clause
"""How the templates of all generators are read."""

from __future__ import annotations

import os
from contextlib import suppress
from functools import cache
from pathlib import Path

import jinja2
from jinja2.bccache import Bucket

from unitylink.resources import cache_folder


@cache
def environment(*folders: Path) -> jinja2.Environment:
    """Return the templates of some folders; what they lack is an error, and nothing is escaped.

    They make code, in which a planner lets nothing through that is not quoted or a name. Compiled they are
    kept in the user's cache: compiling them takes longer than filling them in.
    """
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        bytecode_cache=_Kept(),
    )


class _Kept(jinja2.BytecodeCache):
    """Compiled templates in files, by name and content; without a place to keep them nothing is kept."""

    def load_bytecode(self, bucket: Bucket) -> None:
        with suppress(Exception), self._file(bucket).open("rb") as file:  # whatever a damaged file raises
            bucket.load_bytecode(file)

    def dump_bytecode(self, bucket: Bucket) -> None:
        path = self._file(bucket)
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            fresh = path.with_name(f"{path.name}.{os.getpid()}")
            with fresh.open("wb") as file:
                bucket.write_bytecode(file)
            fresh.replace(path)  # whoever reads meanwhile has the old one or the new one

    def _file(self, bucket: Bucket) -> Path:
        return cache_folder("templates") / jinja2.__version__ / bucket.key
