# SPDX-License-Identifier: BSD-3-Clause
"""The names of generated modules. A file `types.py` would hide Python's own `types`."""

from __future__ import annotations

import keyword
import re
import sys

# Modules of the standard library that some Python from 3.10 to 3.14 has and another lacks. So a spec gives
# the same file with every Python.
_COME_AND_GONE = """
aifc annotationlib asynchat asyncore audioop binhex cgi cgitb chunk compression crypt distutils imghdr imp
lib2to3 mailcap msilib nis nntplib ossaudiodev pipes smtpd sndhdr spwd sunau telnetlib tomllib uu xdrlib
"""
# Modules that unitylink and nodes import, and files that Python, pip or pytest would take for their own.
_TAKEN = """
catkin_pkg click jinja2 launch launch_ros markupsafe numpy rclpy rich rospy tomli typing_extensions unitylink
__init__ __main__ conftest setup sitecustomize usercustomize
"""
RESERVED = frozenset({*sys.stdlib_module_names, *_COME_AND_GONE.split(), *_TAKEN.split()})


def variable_name(name: str) -> str:
    """Return the name of a variable for something of this name."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    plain = plain if plain.isidentifier() else f"n{plain}"
    return f"{plain}_" if keyword.iskeyword(plain) else plain


def module_name(name: str) -> str:
    """Return the module name for a spec of this name. If the name is taken, it ends in `_`.

    >>> module_name("arm"), module_name("types"), module_name("class")
    ('arm', 'types_', 'class_')
    """
    plain = variable_name(name)
    return f"{plain}_" if plain in RESERVED else plain
