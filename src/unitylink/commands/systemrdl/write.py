# SPDX-License-Identifier: BSD-3-Clause
"""From an elaborated SystemRDL tree to the text of a spec."""

from __future__ import annotations

from systemrdl.node import AddressableNode, AddrmapNode, MemNode, RegfileNode, RegNode

from unitylink.protocol import DATA_BITS_MAX

from ..failure import Failure
from ..imported import Imported, checked
from ..spec_names import Names
from .comments import documentation
from .registers import Types, register


def write_spec(top: AddrmapNode) -> Imported:
    """Return the spec of an address map.

    Raises Failure, which names the parts that UL-spec cannot express.
    """
    writer = _Writer(top)
    text, _ = checked(writer.text(), top.inst_name)
    return Imported(text, tuple(writer.types.notes))


class _Writer:
    def __init__(self, top: AddrmapNode) -> None:
        self.top = top
        self.names = Names()
        self.types = Types(self.names, {}, [], [])
        self.constructors: dict[tuple[str, int], str] = {}  # (body, words) -> name
        self.texts: list[str] = []
        self.data_bits = _data_bits(top)
        self.bytes = self.data_bits // 8

    def text(self) -> str:
        name = self.names.unique(self.top.inst_name)
        body = self._body(self.top, "")
        link = f"link {name} (DATA={self.data_bits});\n\n"
        public = f"{documentation(self.top, '')}public {name}() {{\n{body}}}\n"
        return link + "\n".join([*self.types.texts, public, *self.texts])

    def _body(self, node: AddressableNode, base: str) -> str:
        """Return the members of a node. `base` is the name of its block's address, or "" at the top."""
        names = Names()
        names.unique(base)
        lines = []
        for child in node.children(unroll=False):
            if isinstance(child, RegNode) and child.is_alias:
                self.types.notes.append(f"{child.get_path()}: an alias, left out; UL-spec has groups")
            elif isinstance(child, RegNode):
                lines.append(self._register(child, base, names))
            elif isinstance(child, MemNode):
                lines.append(self._memory(child, base, names))
            elif isinstance(child, (RegfileNode, AddrmapNode)):
                lines.append(self._block(child, base, names))
        return "".join(lines)

    def _register(self, reg: RegNode, base: str, names: Names) -> str:
        kind = register(reg, self.types)
        comment = documentation(reg, "   ")
        stride = reg.array_stride
        if not reg.is_array or stride is None:
            return f"{comment}   @{names.unique(reg.inst_name)} = {self._at(reg, base)}: {kind};\n"
        if stride == reg.size:
            count = f"[{reg.n_elements}]"
            return f"{comment}   @{names.unique(reg.inst_name)}{count} = {self._at(reg, base)}: {kind};\n"
        lines = []
        for index in range(reg.n_elements):
            address = self._at(reg, base, index * stride)
            lines.append(f"{comment}   @{names.unique(f'{reg.inst_name}_{index}')} = {address}: {kind};\n")
        return "".join(lines)

    def _memory(self, memory: MemNode, base: str, names: Names) -> str:
        width, entries = memory.get_property("memwidth"), memory.get_property("mementries")
        access = {"r": "READ", "w": "WRITE"}.get(memory.get_property("sw").name, "READWRITE")
        name = names.unique(memory.inst_name)
        text = documentation(memory, "   ")
        return f"{text}   @{name}[{entries}] = {self._at(memory, base)}: u{width} {access}();\n"

    def _block(self, block: AddressableNode, base: str, names: Names) -> str:
        words = -(-block.size // self.bytes)
        body = self._body(block, "at")
        if not body:
            return ""
        key = (documentation(block, "") + body, words)
        if key not in self.constructors:
            callee = self.names.unique(block.type_name or block.inst_name)
            self.constructors[key] = callee
            head = f"{documentation(block, '')}{callee}(): @at[{words}] {{\n"
            self.texts.append(f"{head}{body}}}\n")
        callee = self.constructors[key]
        name = names.unique(block.inst_name)
        if not block.is_array or block.array_stride is None:
            return f"   {name}: {callee}() @ {self._at(block, base)};\n"
        stride = self._words(block.array_stride, block)
        return f"   {name}[{block.n_elements}]: {callee}() @ {self._at(block, base)}+i*{stride};\n"

    def _at(self, node: AddressableNode, base: str, offset: int = 0) -> str:
        words = self._words(node.raw_address_offset + offset, node)
        return f"{base}+{words}" if base and words else base or f"0x{words:X}"

    def _words(self, size: int, node: AddressableNode) -> int:
        if size % self.bytes:
            raise Failure(
                f"{node.get_path()} lies at byte 0x{node.raw_absolute_address:X}, between two words of "
                f"{self.data_bits} bits",
                "align it, or give the registers one width",
            )
        return size // self.bytes


def _data_bits(top: AddrmapNode) -> int:
    """Return the width of a word.

    It is that of the narrowest register, because wider ones take several words.
    """
    widths = {node.get_property("regwidth") for node in top.descendants() if isinstance(node, RegNode)}
    widths |= {node.get_property("memwidth") for node in top.descendants() if isinstance(node, MemNode)}
    return int(min([*widths, DATA_BITS_MAX]))
