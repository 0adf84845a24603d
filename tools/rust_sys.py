#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the declarations of the C ABI in Rust from its header: `python tools/rust_sys.py`.

With --check it only compares. The header keeps to a few forms (a struct, an enumeration, a function). What
this program does not understand is an error.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HEADER = ROOT / "native" / "include" / "unitylink.h"
DECLARATIONS = ROOT / "src" / "unitylink" / "generate" / "rust" / "runtime" / "sys.rs"

TYPES = {
    "char": "c_char",
    "double": "f64",
    "int32_t": "i32",
    "size_t": "usize",
    "uint32_t": "u32",
    "uint64_t": "u64",
}
BEGIN = """// SPDX-License-Identifier: BSD-3-Clause

//! The C ABI of Unity-Link (unitylink.h), as it is. `tools/rust_sys.py` makes this from the header.
//! The crate `unitylink` has the same without `unsafe`.

#![allow(non_camel_case_types)]

use std::os::raw::c_char;
"""


def declarations(header: str) -> str:
    """Return the declarations of Rust for the text of the header."""
    plain = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    plain = plain[plain.index("typedef") : plain.rindex("#ifdef __cplusplus")]
    parts = list(_parts(plain))
    made = [BEGIN, "/// What a call gives.", "pub type ul_status = i32;", "", "pub mod status {"]
    numbers = [text for kind, text in parts if kind == "enum"]
    made += [f"    {line}" for line in _constants(numbers[0], "super::ul_status")]
    made += ["}", "pub use status::*;", ""]
    for body in numbers[1:]:
        made += [*_constants(body, "u32"), ""]
    for kind, text in parts:
        if kind == "struct":
            made += [*_struct(text), ""]
        elif kind == "opaque":
            made += ["#[repr(C)]", f"pub struct {text} {{", "    _private: [u8; 0],", "}", ""]
    made += ['extern "C" {', *(f"    {_function(text)}" for kind, text in parts if kind == "function"), "}"]
    return "\n".join(made).replace("\n\n\n", "\n\n") + "\n"


def _parts(plain: str) -> Iterator[tuple[str, str]]:
    forms = {
        "opaque": r"typedef struct (\w+) \1;",
        "status": r"typedef int32_t (ul_status);",
        "enum": r"enum \{([^}]*)\};",
        "struct": r"typedef struct \{([^}]*\}\s*\w+);",
        "function": r"UL_API ([^;]*);",
    }
    at = 0
    while plain[at:].strip():
        at += len(plain[at:]) - len(plain[at:].lstrip())
        found = [
            (kind, match) for kind, form in forms.items() if (match := re.compile(form).match(plain, at))
        ]
        if not found:
            raise ValueError(
                f"unitylink.h has a form that this program does not know: {plain[at : at + 60]!r}"
            )
        kind, match = found[0]
        yield kind, match[1]
        at = match.end()


def _constants(body: str, kind: str) -> Iterator[str]:
    for name, number in re.findall(r"(\w+)\s*=\s*(\w+)", body):
        yield f"pub const {name}: {kind} = {number};"


def _struct(text: str) -> Iterator[str]:
    body, name = text.rsplit("}", 1)
    yield "#[repr(C)]"
    yield "#[derive(Clone, Copy, Debug)]"
    yield f"pub struct {name.strip()} {{"
    for field in filter(None, (one.strip() for one in body.split(";"))):
        kind, names = re.fullmatch(r"(\w+)\s+([\w\s,]+)", field).groups()  # type: ignore[union-attr]
        for one in names.split(","):
            yield f"    pub {one.strip()}: {TYPES.get(kind, kind)},"
    yield "}"


def _function(text: str) -> str:
    returned, name, given = re.fullmatch(r"(.*?)(\w+)\(([^)]*)\)", " ".join(text.split())).groups()  # type: ignore[union-attr]
    arguments = [] if given == "void" else [_argument(one.strip()) for one in given.split(",")]
    gives = "" if returned.strip() == "void" else f" -> {_type(returned)}"
    return f"pub fn {name}({', '.join(arguments)}){gives};"


def _argument(text: str) -> str:
    kind, name = re.fullmatch(r"(.*?)(\w+)", text).groups()  # type: ignore[union-attr]
    return f"{name}: {_type(kind)}"


def _type(text: str) -> str:
    """Return a type of C as Rust writes it: `const char**` -> *mut *const c_char."""
    constant, base, stars = re.fullmatch(r"(const )?(\w+)\s*(\**)", text.strip()).groups()  # type: ignore[union-attr]
    kind = TYPES.get(base, base)
    for star in range(len(stars)):
        kind = f"*{'const' if constant and star == 0 else 'mut'} {kind}"
    return kind


def main() -> int:
    text = declarations(HEADER.read_text(encoding="utf-8"))
    if "--check" in sys.argv[1:]:
        return DECLARATIONS.read_text(encoding="utf-8") != text
    DECLARATIONS.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
