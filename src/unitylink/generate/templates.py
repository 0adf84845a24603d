# SPDX-License-Identifier: BSD-3-Clause
"""How the templates of all generators are read."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path

import jinja2
from jinja2.bccache import Bucket
from jinja2.runtime import Context

from unitylink.output_file import replace_file
from unitylink.resources import cache_folder

from .quoting import Code, Part, language_of

_CHECKS = 1  # raised when templates are compiled in another way, so that older files are not used


@cache
def environment(*folders: Path) -> jinja2.Environment:
    """Return the templates of some folders. A missing name is an error, and so is an unquoted text.

    The name of a template tells its language. It may insert code of this language, a number or a name.
    `{{ x | text }}` quotes a text as a literal, and `{{ x | remark }}` quotes it for a comment.
    `{{ code("({})", n) if .. }}` is code that the template itself contains. Compiled templates are kept in
    the user's cache, because compiling them takes longer than filling them in.
    """
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folders),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # an unquoted value is refused instead of escaped
        finalize=_checked,
        bytecode_cache=_Kept(),
    )
    made.filters.update(text=_text, remark=_remark, join=_joined)
    made.globals.update(code=_code)
    return made


@jinja2.pass_context
def _checked(context: Context, value: Part | jinja2.Undefined) -> Part:
    if isinstance(value, jinja2.Undefined):  # from an `if` without `else`; a missing name raises in `str`
        return str(value)
    return _language(context).part(value)


@jinja2.pass_context
def _text(context: Context, text: str) -> Code:
    return _language(context).text(text)


@jinja2.pass_context
def _remark(context: Context, text: str) -> Code:
    return _language(context).remark(text)


@jinja2.pass_context
def _joined(context: Context, parts: Iterable[Part], between: str = "") -> Code:
    """Join as jinja's own filter does, but check the parts.

    The text between them comes from the template.
    """
    return _language(context)(between).join(parts)


@jinja2.pass_context
def _code(context: Context, pattern: str, *parts: Part) -> Code:
    return _language(context).of(pattern, *parts)


def _language(context: Context) -> type[Code]:
    return language_of(context.name or "")


class _Kept(jinja2.BytecodeCache):
    """Compiled templates in files, by name and content. Without a cache folder, nothing is kept."""

    def load_bytecode(self, bucket: Bucket) -> None:
        with suppress(Exception), self._file(bucket).open("rb") as file:  # a damaged file may raise anything
            bucket.load_bytecode(file)

    def dump_bytecode(self, bucket: Bucket) -> None:
        path = self._file(bucket)
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, bucket.bytecode_to_string())

    def _file(self, bucket: Bucket) -> Path:
        return cache_folder("templates") / f"{jinja2.__version__}-{_CHECKS}" / bucket.key
