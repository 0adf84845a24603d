# SPDX-License-Identifier: BSD-3-Clause
"""How C, C++ and Rust name the same things: `Joint` in the namespace `scara`, and `scara_joint`."""

from __future__ import annotations

from dataclasses import dataclass, field

from .dialect import CPP, Dialect
from .names import Names, snake
from .shapes import camel

Endings = tuple[tuple[str, ...], tuple[str, ...]]  # in C++, and in C


@dataclass
class Style:
    """The names of one header. `prefix` is the name of the spec, and `plain` says that the language is C."""

    prefix: str
    plain: bool
    reserved: frozenset[str]  # names that members cannot have
    dialect: Dialect = CPP
    scope: Names = field(init=False)

    def __post_init__(self) -> None:
        self.scope = Names(() if self.plain else self.reserved)

    def type(self, name: str, endings: Endings = ((), ())) -> str:
        """Claim the name of a type: `joint` -> Joint, scara_joint.

        `endings` are those of the names that are made from it, in C++ and in C.
        """
        plain = snake(name)
        if self.plain:
            return self.scope.claim(f"{self.prefix}_{plain}", endings[1])
        return self.scope.claim(camel(plain), endings[0], between="")

    def typedef(self, name: str, endings: Endings) -> str:
        """Claim the name of an enumeration or a packed value: Mode, scara_mode_t."""
        if self.plain:
            return self.scope.claim(f"{self.prefix}_{snake(name)}_t", endings[1])
        return self.type(name, endings)

    def robot(self, name: str, endings: Endings) -> str:
        """Claim the name of a public constructor's type.

        In C, the constructor with the name of the spec is the prefix alone.
        """
        if self.plain and snake(name) == self.prefix:
            return self.scope.claim(self.prefix, endings[1])
        return self.type(name, endings)

    def within(self, owner: str, name: str, endings: Endings = ((), ())) -> str:
        """Claim a name that begins with that of a type: Joint, pose -> JointPose, scara_joint_pose."""
        plain = snake(name)
        if self.plain:
            return self.scope.claim(f"{owner}_{plain}", endings[1])
        return self.scope.claim(f"{owner}{camel(plain)}", endings[0], between="")
