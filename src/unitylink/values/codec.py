# SPDX-License-Identifier: BSD-3-Clause
"""From engineering values to raw numbers and words, and back. This is exact, or an error says why not."""

from __future__ import annotations

import math
import operator
import struct
import sys
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from unitylink.errors import UnexpectedValue, ValueRangeError, shown
from unitylink.spec.types import ValueType

from .classes import enum_class, field_names, member_names, record_class
from .quantity import Quantity, format_value

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_FLOATS = {16: "e", 32: "f", 64: "d"}
_EXACT = 1 << 53  # whole numbers below this are exact as floats
_FLOAT_MAX = {16: 65504.0, 32: float.fromhex("0x1.fffffep+127"), 64: sys.float_info.max}


class Codec:
    """Encode and decode one value. `name` is its name in errors.

    `classes` gives the Python classes of enumerations and packed values by their names in the spec. Missing
    classes are made. `commanded` means that the values are set-points. These are never NaN or infinite.
    Values of a sensor without limits may be. `integer_sign` is set if decoding is only a sign: (raw ^ sign) -
    sign.

    >>> position = Codec("pos", Quantity(ValueType("int", 16), scale=0.5, unit="mm", maximum=100.0), 32)
    >>> position.encode(-1.5), position.decode(0xFFFD)
    (65533, -1.5)
    >>> position.encode(101)
    Traceback (most recent call last):
    unitylink.errors.ValueRangeError: pos: 101 mm is not in -16384 to 100 mm; nothing was sent
    """

    def __init__(
        self,
        name: str,
        quantity: Quantity,
        data_bits: int,
        classes: Mapping[str, type[Any]] | None = None,
        *,
        commanded: bool = False,
    ) -> None:
        kind = quantity.type
        self.name = name
        self.quantity = quantity
        self.type = kind
        self.data_bits = data_bits
        self.width = data_bits if kind.bus else kind.width
        self.words = -(-self.width // data_bits)
        self.mask = (1 << self.width) - 1
        self.word_mask = (1 << data_bits) - 1
        self.sign = 1 << self.width - 1 if kind.signed else 0
        self._classes = classes or {}
        self._commanded = commanded
        self._saturates = quantity.overflow == "saturate"
        self.factor = quantity.scale / (1 << kind.fraction)
        if kind.kind == "float" and self.width not in _FLOATS:
            raise ValueRangeError(f"{name}: a float has 16, 32 or 64 bits, not {self.width}")
        if not math.isfinite(self.factor) or self.factor == 0.0 or not math.isfinite(quantity.offset):
            raise ValueRangeError(
                f"{name}: scale {quantity.scale} and offset {quantity.offset} give no value back"
            )
        if quantity.overflow not in ("error", "saturate"):
            raise ValueRangeError(f"{name}: overflow is {quantity.overflow!r}; choose error or saturate")
        self.ratio = _ratio(quantity, self.width)
        """(a, b, c) where a value is (number * a + b) / c; None where there are no such numbers."""
        plain = kind.kind in ("int", "uint") and not quantity.scaled
        self.integer_sign: int | None = self.sign if plain else None
        self.low, self.high = -self.sign, self.mask ^ self.sign  # range of the number as the type reads it
        self._encode: Callable[[Any], int]
        self._decode: Callable[[int], Any]
        {
            "bool": self._make_bool,
            "enum": self._make_enum,
            "bits": self._make_bits,
            "float": self._make_float,
        }.get(kind.kind, self._make_number)()
        self.encoder = self._encode
        """What `encode` calls, for loops."""

    def encode(self, value: Any) -> int:
        """Return the raw unsigned number of a value.

        Raises ValueRangeError, which names value, limits and unit.
        """
        return self._encode(value)

    def decode(self, raw: int) -> Any:
        """Return the value of a raw number, ignoring bits above the type's.

        Raises UnexpectedValue if there is none.
        """
        return self._decode(raw & self.mask)

    def check_raw(self, raw: int, value: Any) -> None:
        """Raise ValueRangeError if the type has no such raw number, or if it is beyond the limits.

        Errors show `value`.
        """
        try:
            known = self.decode(raw)
            if self.type.kind in ("bool", "enum", "bits"):
                return
            beyond = self.encode(known) != raw & self.mask  # a saturated value would be a different number
        except UnexpectedValue as error:
            raise ValueRangeError(f"{self.name}: {_text(value)}: {error.message}; nothing was sent") from None
        if beyond:
            raise self._refused(known)

    def split(self, raw: int) -> tuple[int, ...]:
        """Return the words of a raw number, with the low word first.

        >>> Codec("t", Quantity(ValueType("uint", 48)), 16).split(0x1_0002_0003)
        (3, 2, 1)
        """
        return tuple(raw >> self.data_bits * i & self.word_mask for i in range(self.words))

    def join(self, words: Sequence[int]) -> int:
        """Return the raw number of its words, with the low word first."""
        raw = 0
        for word in reversed(words):
            raw = raw << self.data_bits | int(word)
        return raw & self.mask

    @property
    def minimum(self) -> Any:
        """The smallest value that can be written. It is the declared limit, or else the type's."""
        return self._limit(self.low, self.high, self.quantity.minimum, min)

    @property
    def maximum(self) -> Any:
        """The largest value that can be written."""
        return self._limit(self.high, self.low, self.quantity.maximum, max)

    def _limit(self, end: int, other: int, declared: float | None, pick: Callable[..., Any]) -> Any:
        kind = self.type.kind
        if declared is not None:
            return int(declared) if self.integer_sign is not None and declared == int(declared) else declared
        if kind == "bool":
            return pick(False, True)
        if kind == "enum" and self.type.enum and not self.type.enum.open:
            return pick(item.value for item in self.type.enum.values)
        if kind == "float":
            return pick(-self._float_max(), self._float_max())
        if self.integer_sign is not None or kind in ("enum", "bits"):
            return end
        return pick(self._real(end), self._real(other)) if self.factor < 0 else self._real(end)

    # Whole numbers, scaled or not

    def _make_number(self) -> None:
        scaled = self.quantity.scaled
        limits = self.low, self.high
        ends = []
        for declared in (self.quantity.minimum, self.quantity.maximum):
            ends.append(None if declared is None else self._nearest(declared))
        if self.factor < 0:
            ends.reverse()
        self.low = limits[0] if ends[0] is None else max(limits[0], ends[0])
        self.high = limits[1] if ends[1] is None else min(limits[1], ends[1])
        self._encode = self._encode_scaled if scaled else self._encode_whole
        self._decode = self._decode_whole
        if scaled:
            self._decode = self._decode_scaled if self.ratio is None else self._decode_ratio

    def _nearest(self, value: float) -> int:
        return round((value - self.quantity.offset) / self.factor) if self.quantity.scaled else round(value)

    def _real(self, number: int) -> float:
        if self.ratio is None:
            return number * self.factor + self.quantity.offset
        multiplier, added, divisor = self.ratio
        return (number * multiplier + added) / divisor

    def _encode_whole(self, value: Any) -> int:
        try:
            number = operator.index(value)
        except TypeError:
            raise ValueRangeError(
                f"{self.name}: {_text(value)} is not an integer; round it first. Nothing was sent"
            ) from None
        return number & self.mask if self.low <= number <= self.high else self._within(number, value)

    def _decode_whole(self, raw: int) -> int:
        return (raw ^ self.sign) - self.sign

    def _encode_scaled(self, value: Any) -> int:
        number = (self._number(value) - self.quantity.offset) / self.factor
        if math.isnan(number):
            raise self._refused(value)
        if math.isinf(number):
            return self._within(self.high + 1 if number > 0 else self.low - 1, value)
        return self._within(round(number), value)

    def _decode_scaled(self, raw: int) -> float:
        return self._real((raw ^ self.sign) - self.sign)

    def _decode_ratio(self, raw: int) -> float:
        multiplier, added, divisor = self.ratio  # type: ignore[misc]  # there is one
        return (((raw ^ self.sign) - self.sign) * multiplier + added) / divisor

    def _within(self, number: int, value: Any) -> int:
        if not self.low <= number <= self.high:
            if not self._saturates:
                raise self._refused(value)
            number = min(max(number, self.low), self.high)
        return number & self.mask

    def _number(self, value: Any) -> float:
        if type(value) is float:
            return value
        try:
            if isinstance(value, (str, bytes, bytearray)) or getattr(value, "ndim", None):
                raise TypeError
            return float(value)
        except OverflowError:  # an integer beyond all floats
            return math.inf if value > 0 else -math.inf
        except (TypeError, ValueError):
            raise ValueRangeError(f"{self.name}: {_text(value)} is not a number; nothing was sent") from None

    def _refused(self, value: Any) -> ValueRangeError:
        unit = f" {self.quantity.unit}" if self.quantity.unit else ""
        return ValueRangeError(
            f"{self.name}: {_text(value)}{unit} is not in {format_value(self.minimum)} to "
            f"{format_value(self.maximum)}{unit}; nothing was sent"
        )

    # The other kinds

    def _make_bool(self) -> None:
        def encode(value: Any) -> int:
            if _is_bool(value) or _index(value) in (0, 1):
                return int(value)
            raise ValueRangeError(f"{self.name}: {_text(value)} is neither true nor false; nothing was sent")

        self._encode = encode
        self._decode = bool

    def _float_max(self) -> float:
        return _FLOAT_MAX[self.width]

    def _make_float(self) -> None:
        code, whole = f"<{_FLOATS[self.width]}", f"<{ {16: 'H', 32: 'I', 64: 'Q'}[self.width] }"
        quantity = self.quantity
        finite = self._commanded or quantity.minimum is not None or quantity.maximum is not None

        def pack(value: Any) -> int:
            real = self._number(value)
            low, high = self.minimum, self.maximum
            if not low <= real <= high and (finite or math.isfinite(real)):
                if math.isnan(real) or not self._saturates:
                    raise self._refused(value)
                real = min(max(real, low), high)
            number = (real - quantity.offset) / quantity.scale
            if math.isinf(number) and math.isfinite(real):  # too large for the raw number
                if not self._saturates:
                    raise self._refused(value)
                number = math.copysign(self._float_max(), number)
            try:
                return int(struct.unpack(whole, struct.pack(code, number))[0])
            except OverflowError:
                if not self._saturates:
                    raise self._refused(value) from None
                largest = math.copysign(self._float_max(), number)
                return int(struct.unpack(whole, struct.pack(code, largest))[0])

        def unpack(raw: int) -> float:
            number = float(struct.unpack(code, struct.pack(whole, raw))[0])
            return number * quantity.scale + quantity.offset if quantity.scaled else number

        self._encode, self._decode = pack, unpack

    def _make_enum(self) -> None:
        enum = self.type.enum
        if enum is None:
            raise ValueRangeError(f"{self.name}: an enum without its names")
        made: type[IntEnum] = self._classes.get(enum.name) or enum_class(enum)
        by_name = {spec: made[python] for spec, python in member_names(enum).items()}
        by_number = {int(member): member for member in made}
        known = ", ".join(f"{item.name} ({item.value})" for item in enum.values)

        def encode(value: Any) -> int:
            if isinstance(value, str):
                if value not in by_name:
                    raise ValueRangeError(
                        f"{self.name}: no {enum.name} is called {_text(value)}; there are {known}. "
                        "Nothing was sent"
                    )
                return int(by_name[value])
            number = _index(value)
            if number not in by_number and not (enum.open and 0 <= number <= self.mask):
                raise ValueRangeError(
                    f"{self.name}: {_text(value)} is no {enum.name}; there are {known}. Nothing was sent"
                )
            return number

        def decode(raw: int) -> int:
            if raw in by_number:
                return by_number[raw]
            if enum.open:
                return raw
            raise UnexpectedValue(
                f"the device holds {raw}, which is no {enum.name}; there are {known}. "
                f"If other numbers may come, declare it `open enum {enum.name}`",
                item=self.name,
            )

        self._encode, self._decode = encode, decode

    def _make_bits(self) -> None:
        made = self._classes.get(self.type.name) or record_class(self.type)
        names = field_names(self.type)
        parts: dict[str, tuple[int, Codec]] = {}
        for field in self.type.fields:
            width = field.high - field.low + 1
            codec = Codec(
                f"{self.name}.{field.name}",
                Quantity.of(field),
                width,
                self._classes,
                commanded=self._commanded,
            )
            if codec.width > width:
                raise ValueRangeError(
                    f"{codec.name}: {field.type} does not fit bits {field.high} to {field.low}"
                )
            parts[names[field.name]] = (field.low, codec)
        spec_names = {python: spec for spec, python in names.items()}

        def encode(value: Any) -> int:
            number = -1 if _is_bool(value) else _index(value)
            if number >= 0 or isinstance(value, int):  # the packed number itself
                raw = self._within(number, value)
                for low, codec in parts.values():  # a number that does not fit a field is not sent either
                    codec.check_raw(raw >> low, value)
                return raw
            given = value
            if not isinstance(value, Mapping):
                given = {name: getattr(value, name) for name in parts if hasattr(value, name)}
            known = set(parts) | set(spec_names.values())
            fields = ", ".join(spec_names[name] for name in parts)
            unknown = [str(name) for name in given if name not in known]
            missing = [spec_names[n] for n in parts if n not in given and spec_names[n] not in given]
            if unknown or missing:
                trouble = f"no field {', '.join(unknown)}" if unknown else f"{', '.join(missing)} missing"
                raise ValueRangeError(f"{self.name}: {trouble}; its fields are {fields}. Nothing was sent")
            raw = 0
            for name, (low, codec) in parts.items():
                raw |= codec.encode(given[name] if name in given else given[spec_names[name]]) << low
            return raw

        def decode(raw: int) -> Any:
            return made(**{name: codec.decode(raw >> low) for name, (low, codec) in parts.items()})

        self._encode, self._decode = encode, decode

    # Many at once

    def decode_array(self, raws: NDArray[np.uint64]) -> NDArray[Any]:
        """Return the values of many raw numbers: float64, bool, int64, uint64. Packed values stay numbers.

        >>> import numpy as np
        >>> half = Codec("x", Quantity(ValueType("int", 8), scale=0.5), 32)
        >>> half.decode_array(np.array([1, 255], np.uint64))
        array([ 0.5, -0.5])
        """
        import numpy as np

        raws = raws & np.uint64(self.mask)
        kind, quantity = self.type.kind, self.quantity
        if kind == "float":
            whole = raws.astype(f"u{self.width // 8}").view(f"f{self.width // 8}").astype(np.float64)
            return np.asarray(whole * quantity.scale + quantity.offset) if quantity.scaled else whole
        if kind == "bool":
            return raws.astype(bool)
        numbers: NDArray[Any] = raws
        if self.sign:
            sign = np.uint64(self.sign)
            # wraps, because it is two's complement of 64 bits
            numbers = ((raws ^ sign) - sign).view(np.int64)
        elif self.width < 64:
            numbers = raws.astype(np.int64)
        if not quantity.scaled:
            return numbers
        if self.ratio is None:
            return np.asarray(numbers * self.factor + quantity.offset)
        multiplier, added, divisor = self.ratio
        return np.asarray((numbers.astype(np.float64) * multiplier + added) / divisor)


def _ratio(quantity: Quantity, width: int) -> tuple[int, int, int] | None:
    """Return (a, b, c) so that a value is (number * a + b) / c.

    Return None if there are no whole numbers that are small enough.

    A SCALE of 0.01 means one hundredth, which no binary number equals. So 1254 * 0.01 is 12.540000000000001,
    but 1254 / 100 is 12.54.
    """
    scale, offset = (
        Fraction(float.__repr__(number) if isinstance(number, float) else number)
        for number in (quantity.scale, quantity.offset)
    )
    factor = scale / (1 << quantity.type.fraction)
    divisor = math.lcm(factor.denominator, offset.denominator)
    multiplier, added = int(factor * divisor), int(offset * divisor)
    exact = (1 << width) * abs(multiplier) + abs(added) < _EXACT and divisor < _EXACT
    return (multiplier, added, divisor) if exact else None


def _index(value: Any) -> int:
    """Return a value as an integer.

    Integers of numpy are accepted, too. Return -1 if it is not an integer.
    """
    try:
        return operator.index(value)
    except TypeError:
        return -1


def _text(value: Any) -> str:
    """Return a value as text for an error. Numbers of numpy look like those of Python."""
    return str(value) if isinstance(value, float) else shown(value)


def _is_bool(value: Any) -> bool:
    """Return whether this is a truth value of Python, or of numpy if that is loaded."""
    numpy = sys.modules.get("numpy")
    return isinstance(value, bool) or (numpy is not None and isinstance(value, numpy.bool_))


def member_text(type_: ValueType, value: Any) -> str:
    """Return the spec's name of a member of an enumeration, or the value as text."""
    if type_.enum is not None:
        for item in type_.enum.values:
            if item.value == value:
                return item.name
    return format_value(value)
