# SPDX-License-Identifier: BSD-3-Clause
"""What is true at each place of the program of the small engine: a table for the proof of `small_engine`.

The solver checks the table, so nobody has to trust what is computed here. A fact is true at a place if it is
true behind each instruction that leads there. gateware/formal/small_engine_formal.vhd says what a fact means.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

# The bits of a fact. Their order is that of small_engine_formal.
FACTS = (
    "none",  # the frame has had no effect yet
    "reached",  # a frame was begun
    "not_post",
    "is_post",
    "older",  # the place of the id has an older one
    "recorded",  # `record` is the place of the id
    "fresh",  # `older`, or the request was executed before
    "remembered",  # the place has the id
    "settled",  # nothing was executed that would have to be remembered
    "renewed",  # a session has begun or ended
    "next",  # posts are one more than the id
    "out_known",  # `outside` is as the kind says
    "a_high",  # A is 80 or more
    "a_low",
    "a_counter",  # A is the address of a counter
    "x_low",  # X is below 80
    "x_counter",
    "x_high",  # X is 100 or more
    "x_ring",  # X is 180 or more
    "look_high",
    "after_high",
    "x_clear",  # X is below 80, or 100 or more: where no id, counter or word of the program is
    "kind_legal",  # what a checked frame may have as its kind
    "kind_small",  # below 48
    "post_or_older",
    "post_or_recorded",
    "head_high",
)
BIT = {name: 1 << bit for bit, name in enumerate(FACTS)}
IMPLIED = {
    "none": ("settled",),
    "is_post": ("settled", "post_or_older", "post_or_recorded"),
    "remembered": ("settled",),
    "renewed": ("settled",),
    "older": ("fresh", "post_or_older"),
    "recorded": ("post_or_recorded",),
    "x_ring": ("x_high", "x_clear"),
    "x_high": ("x_clear",),
    "x_low": ("x_clear",),
    "a_counter": ("a_high",),
    "kind_small": ("kind_legal",),
}
OF_PLACE = ("older", "fresh", "remembered", "settled", "post_or_older")
OF_ID = (*OF_PLACE, "recorded", "post_or_recorded", "next")
OF_A = ("a_high", "a_low", "a_counter")
OF_X = ("x_low", "x_counter", "x_high", "x_ring", "x_clear")
KILLED_BY_STORE = {
    "id_h": (*OF_PLACE, "next"),
    "id_l": OF_ID,
    "kind": (
        "not_post",
        "is_post",
        "settled",
        "out_known",
        "kind_legal",
        "kind_small",
        "post_or_older",
        "post_or_recorded",
    ),
    "status": ("settled",),
    "record": ("recorded", "post_or_recorded"),
    "repeated": ("fresh",),
    "posts_h": ("next",),
    "posts_l": ("next",),
    "outside": ("out_known",),
    "look": ("look_high",),
    "after": ("after_high",),
    "head": ("head_high",),
}
HIGH_PAGE = ("next", "out_known")  # facts about bytes from 100 to 17F
KEPT_HIGH = {"look": "look_high", "after": "after_high", "head": "head_high"}
COUNTERS = range(0x80, 0xC8)
# Where a fact begins for another reason than the ones below: label, offset, fact.
BEGINS = (
    ("now", 7, "none"),
    ("now", 7, "reached"),
    ("now", 14, "not_post"),
    ("now", 9, "kind_legal"),
    ("post", 0, "is_post"),
    ("post_failed", 0, "is_post"),
    ("judge", 11, "older"),
    ("judge", 5, "recorded"),
    ("not_new", 10, "fresh"),
    ("put_reply", 4, "older"),
    ("remember", 4, "remembered"),
    ("remember", 5, "remembered"),
    ("remember", 6, "remembered"),
    ("answer", 0, "settled"),
    ("session", 1, "renewed"),
    ("post_write", 0, "next"),
    ("listen", 23, "out_known"),
    ("dropped", 0, "kind_small"),
    ("drop", 2, "a_counter"),
    ("slot", 5, "a_low"),
    ("is_outside", 0, "kind_legal"),
    ("is_alive", 0, "kind_legal"),
    ("judged", 1, "kind_legal"),
    ("decode_end", 24, "kind_legal"),
    ("fails", 4, "older"),
    ("fails", 4, "recorded"),
    ("fails", 4, "not_post"),
    ("bump", 10, "a_counter"),
    ("bump", 13, "x_counter"),
    ("bump", 14, "x_counter"),
    ("bump", 15, "x_counter"),
)


def closed(facts: int) -> int:
    """Return the facts with all that they imply."""
    for name, others in IMPLIED.items():
        if facts & BIT[name]:
            facts |= mask(others)
    return facts


def mask(names: tuple[str, ...]) -> int:
    """Return the bits of some facts."""
    return sum(BIT[name] for name in names)


class Analysis:
    """The facts of one program, found by going through it until nothing changes."""

    def __init__(self, program: Any) -> None:
        self.lines = program.lines
        self.labels = program.labels
        self.names = program.names
        self.byte = {self.names[name]: name for name in KILLED_BY_STORE}
        self.begins: dict[int, int] = {}
        for label, offset, fact in BEGINS:
            place = self.labels[label] + offset
            self.begins[place] = self.begins.get(place, 0) | BIT[fact]
        self.places = range(len(self.lines))
        self.returning = self._returning()
        self.bodies = {entry: self._body(entry) for entry in self._entries()}
        self._find()

    def _target(self, place: int) -> int:
        return int(self.labels[self.lines[place].operand])

    def _goes_to(self, place: int) -> Iterator[int]:
        """Yield the places behind an instruction in the same routine. A call goes on behind it."""
        operation = self.lines[place].operation
        if operation == "ret":
            return
        if operation == "jmp":
            yield self._target(place)
            return
        if operation != "call" or self._target(place) in self.returning:
            yield place + 1
        if operation.startswith("j"):
            yield self._target(place)

    def _returning(self) -> set[int]:
        """Return the places from which a `ret` is reached in the same routine."""
        found = {place for place in self.places if self.lines[place].operation == "ret"}
        self.returning = found
        while True:
            more = {
                place
                for place in self.places
                if place not in found
                and self.lines[place].operation != "ret"
                and any(to in found for to in self._goes_to(place))
            }
            if not more:
                return found
            found |= more

    def _entries(self) -> set[int]:
        return {self._target(p) for p in self.places if self.lines[p].operation == "call"}

    def _body(self, entry: int) -> set[int]:
        body, left = set(), [entry]
        while left:
            place = left.pop()
            if place in self.returning and place not in body:
                body.add(place)
                left += self._goes_to(place)
        return body

    def _killed(self, place: int) -> int:
        """Return the facts that an instruction ends. What X is known to be may save some."""
        line = self.lines[place]
        operation, operand = line.operation, line.operand
        ends = 0
        if operation in ("ld", "and", "or", "xor", "add", "adc", "sub", "sbc", "in", "get"):
            ends |= mask(OF_A)
        if operation in ("ldx", "tax", "follow"):
            ends |= mask(OF_X)
        if operation in ("out", "tell") and {"read", "write", "start", "arm"} & set(operand.split()):
            ends |= BIT["none"] | BIT["settled"]
        if operand.endswith("[x+]") or operation in ("get", "give"):
            ends |= BIT["x_counter"]
        if operation == "put":
            ends |= mask(HIGH_PAGE)
        if operation in ("st", "clr", "set", "get", "give"):
            if operand.startswith("[x") or operation == "give":
                known = self.facts[place]
                if known & BIT["x_ring"] or known & BIT["x_low"] or known & BIT["x_counter"]:
                    pass
                elif known & BIT["x_clear"]:
                    ends |= mask(HIGH_PAGE)
                else:
                    ends |= mask(HIGH_PAGE if self._is_counter_store(place) else OF_PLACE)
            elif (name := self.byte.get(self._address(operand))) is not None:
                ends |= mask(KILLED_BY_STORE[name])
        return ends

    def _is_counter_store(self, place: int) -> bool:
        """Whether `clear` stores. There X is below the counters' end, or in a higher page."""
        return bool(self.labels["clear"] <= place < self.labels["clock"])

    def _address(self, operand: str) -> int:
        return int(eval(operand, {"__builtins__": {}}, dict(self.names)))

    def _made(self, place: int, known: int) -> int:
        """Return the facts that an instruction makes true, if `known` are true before it."""
        line = self.lines[place]
        operation, operand = line.operation, line.operand
        made: list[str] = []
        if operation == "ld" and operand.startswith("#"):
            value = self._address(operand[1:])
            made.append("a_high" if value >= 0x80 else "a_low")
            if value in COUNTERS:
                made.append("a_counter")
        elif operation == "or" and operand == "#0x80":
            made.append("a_high")
        elif operation == "ld" and not operand.startswith("[") and not operand.startswith("#"):
            name = self.byte.get(self._address(operand), "")
            if name in KEPT_HIGH and known & BIT[KEPT_HIGH[name]]:
                made.append("a_high")
        elif operation == "in" and operand == "x":
            made += ["a_high"] * bool(known & BIT["x_ring"]) + ["a_low"] * bool(known & BIT["x_low"])
        elif operation == "ldx":
            value = self._address(operand)
            made.append(
                "x_ring"
                if value >= 0x180
                else "x_high"
                if value >= 0x100
                else "x_low"
                if value < 0x80
                else ""
            )
        elif operation == "follow":
            name = self.byte.get(self._address(operand), "")
            made.append("x_ring" if known & BIT.get(KEPT_HIGH.get(name, ""), 0) else "x_high")
        elif operation == "tax" and operand == "1":
            made.append("x_ring" if known & BIT["a_high"] else "x_high")
        elif operation == "tax" and operand == "0":
            made.append("x_low" if known & BIT["a_low"] else "x_counter" if known & BIT["a_counter"] else "")
        elif operation == "st" and not operand.startswith("["):
            name = self.byte.get(self._address(operand), "")
            if name in KEPT_HIGH and known & BIT["a_high"]:
                made.append(KEPT_HIGH[name])
        return mask(tuple(filter(None, made)))

    def _find(self) -> None:
        everything = (1 << len(FACTS)) - 1
        self.facts = [everything] * len(self.lines)
        self.carried = [everything] * len(self.lines)
        changed = True
        while changed:
            changed = False
            comes = [everything] * len(self.lines)
            comes[0] = BIT["none"]
            carried = [everything] * len(self.lines)
            for place in self.places:
                known = self.facts[place]
                behind = closed((known & ~self._killed(place)) | self._made(place, known))
                line = self.lines[place]
                if line.operation == "ret":
                    continue
                if line.operation == "call":
                    entry = self._target(place)
                    comes[entry] &= behind
                    if place + 1 < len(self.lines) and entry in self.returning:
                        body = self.bodies[entry]
                        kept = known & ~self._killed_in(body)
                        carried[place + 1] = kept
                        ends = everything
                        for each in body:
                            if self.lines[each].operation == "ret":
                                ends &= self.facts[each]
                        comes[place + 1] &= closed(kept | ends)
                    continue
                for to in self._goes_to(place):
                    if to < len(self.lines):
                        comes[to] &= behind
            found = [closed(comes[p] | self.begins.get(p, 0)) for p in self.places]
            if found != self.facts or carried != self.carried:
                changed = True
            self.facts, self.carried = found, carried

    def _killed_in(self, body: set[int]) -> int:
        ends = 0
        for place in body:
            ends |= self._killed(place)
            if self.lines[place].operation == "call" and self._target(place) in self.returning:
                inner = self.bodies[self._target(place)]
                for each in inner:
                    ends |= self._killed(each)
        return ends

    def sites(self) -> dict[int, frozenset[int]]:
        """Return, for each place that returns, where it may return to."""
        behind: dict[int, set[int]] = {entry: set() for entry in self.bodies}
        for place in self.places:
            if self.lines[place].operation == "call":
                behind[self._target(place)].add(place + 1)
        found: dict[int, set[int]] = {}
        for entry, body in self.bodies.items():
            for place in body:
                found.setdefault(place, set()).update(behind[entry])
        return {place: frozenset(all_sites) for place, all_sites in found.items()}


def table(program: Any) -> str:
    """Return 24 hexadecimal digits for each place: facts, facts kept through a call, group, groups."""
    analysis = Analysis(program)
    sites = analysis.sites()
    groups = {each: number for number, each in enumerate(sorted(set(sites.values()), key=sorted), 1)}
    if len(groups) > 31:
        raise ValueError(f"the table has room for 31 groups of places, and the program has {len(groups)}")
    rows = []
    for place in analysis.places:
        group = groups[sites[place]] if place in sites else 0
        returned = sum(1 << number for each, number in groups.items() if place in each)
        carried = analysis.carried[place] if returned else 0
        rows.append(f"{analysis.facts[place]:07X}{carried:07X}{group:02X}{returned:08X}")
    return "".join(rows)
