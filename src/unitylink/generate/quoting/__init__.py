# SPDX-License-Identifier: BSD-3-Clause
"""How a text of a spec gets into a generated file.

There is one class for each language, with its quoting functions.

>>> Python.text('the "arm"')
'\\'the "arm"\\''
>>> language_of("ros2/node.cpp.jinja").__name__
'Cpp'
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import PurePosixPath
from types import MappingProxyType

from .code import Code, Part, UnquotedText, file_name, one_line
from .cpp import Cpp
from .matlab import Matlab
from .python import Python
from .rust import Rust
from .scripts import CMake, Markdown, Message, Shell, Tcl, Toml, Yaml
from .vhdl import Vhdl
from .xml import Html, Xacro, Xml

__all__ = [
    "LANGUAGES",
    "CMake",
    "Code",
    "Cpp",
    "Html",
    "Markdown",
    "Matlab",
    "Message",
    "Part",
    "Python",
    "Rust",
    "Shell",
    "Tcl",
    "Toml",
    "UnquotedText",
    "Vhdl",
    "Xacro",
    "Xml",
    "Yaml",
    "file_name",
    "language_of",
    "one_line",
]

# Ending of a file name -> language of the file.
LANGUAGES: Mapping[str, type[Code]] = MappingProxyType(
    {
        ".cpp": Cpp,
        ".h": Cpp,
        ".hpp": Cpp,
        ".html": Html,
        ".launch": Xml,
        ".m": Matlab,
        ".md": Markdown,
        ".msg": Message,
        ".py": Python,
        ".rs": Rust,
        ".sh": Shell,
        ".srv": Message,
        ".tcl": Tcl,
        ".toml": Toml,
        ".txt": CMake,
        ".vhd": Vhdl,
        ".xacro": Xacro,
        ".xml": Xml,
        ".yaml": Yaml,
    }
)


@cache
def language_of(name: str) -> type[Code]:
    """Return the language of a file, or of the template of one.

    Return `Code` if the table does not have it.
    """
    return LANGUAGES.get(PurePosixPath(name.removesuffix(".jinja")).suffix, Code)
