# SPDX-License-Identifier: BSD-3-Clause
"""Names of a spec as names of C and C++."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

# Words of C11 and C++20. Also macros that the headers of both may define: those in small letters, and the
# names of the system's errors.
KEYWORDS = frozenset((Path(__file__).parent / "keywords.txt").read_text(encoding="ascii").split())
# Words of Rust of all editions, beside those of C and C++, and names that no variable can have there.
RUST_KEYWORDS = frozenset((Path(__file__).parent / "keywords_rust.txt").read_text(encoding="ascii").split())
# Macros in capitals that the headers of both may define.
_MACROS = re.compile(
    r"""UL_\w+|UNITYLINK_\w+|I|W?EOF|[A-Z0-9_]+_(?:MAX|MIN|WIDTH|ENDIAN|OK)
    |(?:ADJ|AIO|ATOMIC|CHAR|CLOCKS?|CLONE|CLOSE|COLL|CPU|DBL|DECIMAL|EXIT|EXPR|F|FD|FLT|FP|HUGE|ITIMER|L|LC|LDBL|M|MATH
    |MOD|NL|P|PIPE|PTHREAD|RAND|RENAME|SCHED|SEEK|SEM|STA|STDERR|STDIN|STDOUT|SYS|TEMP|TIME|TIMER|TMP|W|XATTR)_\w+
    |(?:U?INT\d+|U?INTMAX)_\w+|TIME\w+_TO_\w+|SNANF?\w*|NULL|NAN|INFINITY|BUFSIZ|TRUE|FALSE
    |W(?:NOHANG|UNTRACED|STOPPED|EXITED|CONTINUED|NOWAIT|COREDUMP|TERMSIG|STOPSIG|IF\w+|\w+STATUS)
    |NR_OPEN|NFDBITS|BYTE_ORDER|LONG_BIT|WORD_BIT|MAX_CANON|MAX_INPUT|CSIGNAL|NZERO|MAXFLOAT""",
    re.VERBOSE | re.ASCII,
)


def usable(name: str, reserved: Iterable[str] = ()) -> bool:
    """Return whether C and C++ take this as the name of a member, and nothing else has it.

    Names that begin with `ul_` are those of the library.

    >>> usable("cpos"), usable("class"), usable("EOF"), usable("__x"), usable("a__b"), usable("ul_x")
    (True, False, False, False, False, False)
    """
    taken = name in KEYWORDS or name in set(reserved) or _MACROS.fullmatch(name) is not None
    return not (taken or name.startswith(("_", "ul_")) or "__" in name or name[:1].isdigit() or not name)


def members(names: Iterable[str], reserved: Iterable[str] = ()) -> dict[str, str]:
    """Map names of a spec to names of members.

    A name is unchanged if that works, else it gets "_" or a number at the end.

    >>> members(["cpos", "class", "class_", "read", "__x"], {"read"})
    {'cpos': 'cpos', 'class': 'class_2', 'class_': 'class_', 'read': 'read_2', '__x': 'x'}
    """
    names, blocked = list(dict.fromkeys(names)), set(reserved)
    result = {name: name for name in names if usable(name, blocked)}
    scope = Names({*blocked, *result})
    return {name: result.get(name) or scope.claim(name) for name in names}


class Names:
    """The names of one scope. Each claim gets a name that no other one has."""

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self.taken = set(reserved)

    def claim(self, name: str, endings: Iterable[str] = (), between: str = "_") -> str:
        """Return a free name like `name`, and reserve it. With each of the `endings` it is free, too.

        >>> scope = Names({"mode"})
        >>> [scope.claim(name) for name in ("Mode", "mode", "int", "2nd", "a__b", "j[2].pos")]
        ['Mode', 'mode_2', 'int_', 'n2nd', 'a_b', 'j_2_pos']
        >>> scope.claim("j", ["_2_pos"])
        'j_2'
        """
        plain = re.sub(r"_+", "_", re.sub(r"\W", "_", name, flags=re.ASCII)).strip("_") or "n"
        plain = f"n{plain}" if plain[0].isdigit() or plain.startswith("ul_") else plain
        plain = plain if usable(plain) else f"{plain}_"
        endings = tuple(endings)
        free, number = plain, 1
        while self.taken & {free, *(free + ending for ending in endings)}:
            number += 1
            free = f"{plain.rstrip('_')}{between}{number}"
        self.taken |= {free, *(free + ending for ending in endings)}
        return free


def snake(name: str) -> str:
    """Return a name in small letters: `j1Arm` -> j1_arm.

    >>> snake("TosNetArm"), snake("J1"), snake("j1.cpos")
    ('tos_net_arm', 'j1', 'j1_cpos')
    """
    apart = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)
    return re.sub(r"_+", "_", re.sub(r"\W", "_", apart, flags=re.ASCII)).strip("_").lower()
