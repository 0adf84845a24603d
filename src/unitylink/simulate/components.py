# SPDX-License-Identifier: BSD-3-Clause
"""The outside of the components of a virtual board: what a plant drives, and what it sees."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypeVar

from unitylink import _native
from unitylink.errors import ValueRangeError
from unitylink.interface.components import ComponentConfiguration

from .bus_servo import BusServo
from .device_registers import DeviceRegisters, i2c_address
from .distance_sensor import DistanceSensor
from .led_strip import LedStrip
from .load_cell import LoadCell
from .modbus_device import ModbusDevice
from .radio import Radio
from .sensor import Sensor
from .serial_encoder import SerialEncoder
from .serial_end import SerialEnd
from .speed_controller import SpeedController
from .thermometer import Thermometer

AnySensor = TypeVar("AnySensor", bound=Sensor)

_ANSWER_S = 30e-6  # from the end of a frame to the reply of a speed controller or of a servo


class BoardComponent:
    """The pins of one component from outside, and quantities above them.

        wheel = board.components["wheel"]      # quadrature_encoder
        wheel.turn(4096, seconds=0.1)          # its lines a and b run through 4096 counts
        drive = board.components["drive"]      # pwm
        drive.duty("pins", 0)                  # the share of high time since the last look, 0 to 1
        drive.pulse_s("pins", 0)               # the length of a servo's pulse

    Inputs are driven by `drive` and `turn`. Outputs are seen by `level`, `rises`, `steps`, `duty` and
    `pulse_s`. No edge is missed between two looks. Calls may come from any thread. Raises ValueRangeError for
    a port that the component does not have.
    """

    def __init__(self, native: _native.Board, number: int, configuration: ComponentConfiguration) -> None:
        self._native = native
        self._number = number
        self.configuration = configuration
        self._places: dict[tuple[str, str], tuple[int, int]] = {}
        counted = {"in": 0, "out": 0}
        for port, direction, bits in configuration.pins:
            if direction in counted:
                self._places[direction, port] = counted[direction], bits or 1
                counted[direction] += bits or 1
        self.forget()

    def forget(self) -> None:
        """Forget what was put at the pins, and what was seen there: the board begins anew."""
        self._counted: set[tuple[int, int]] = set()
        self._pulses: dict[int, tuple[int, float]] = {}  # pin -> pulses and high time at the last look
        self._device: DeviceRegisters | None = None
        self._controllers: dict[int, SpeedController] = {}
        self._servos: dict[int, BusServo] = {}
        self._serial: SerialEnd | None = None
        self._distance_sensor: DistanceSensor | None = None
        self._load_cell: LoadCell | None = None
        self._serial_encoder: SerialEncoder | None = None
        self._led_strip: LedStrip | None = None
        self._thermometer: Thermometer | None = None
        self._radio: Radio | None = None
        self._modbus: dict[int, ModbusDevice] = {}
        self._last: dict[int, tuple[float, float]] = {}  # pin -> high time and time of the last look

    def drive(self, port: str, level: bool | int, bit: int = 0) -> None:
        """Put a level on an input. It stays until another one is put there."""
        if not self._native.drive(self._number, self._pin("in", port, bit), bool(level)):
            raise self._without_pins()

    def level(self, port: str, bit: int = 0) -> bool:
        """Return the level of an output."""
        return self._look(port, bit)[0]

    def rises(self, port: str, bit: int = 0) -> int:
        """Return how many rising edges an output has had since the board was made."""
        return self._look(port, bit)[1]

    def steps(self, step: str, direction: str, bit: int = 0) -> int:
        """Return the rising edges of `step` while `direction` is high, less those while it is low.

        Edges before the first call all count as forward. So call it once before the motor may move.
        """
        pair = self._pin("out", step, bit), self._pin("out", direction, bit)
        if pair not in self._counted:
            if not self._native.count_by(self._number, *pair):
                raise self._without_pins()
            self._counted.add(pair)
        return self._look(step, bit)[2]

    def duty(self, port: str, bit: int = 0) -> float:
        """Return the share of time for which an output was high since the last call, or since the start.

        Within one instant it is the level.
        """
        level, _, _, high_s, time_s = self._look(port, bit)
        pin = self._pin("out", port, bit)
        high_before_s, before_s = self._last.get(pin, (0.0, 0.0))
        self._last[pin] = high_s, time_s
        passed_s = time_s - before_s
        return (high_s - high_before_s) / passed_s if passed_s > 0 else float(level)

    def pulse_s(self, port: str, bit: int = 0) -> float | None:
        """Return the mean length of the pulses since the last call. None: none has ended.

        A pulse that has only begun counts at its end.
        """
        level, rises, _, high_s, _ = self._look(port, bit)
        pin = self._pin("out", port, bit)
        if level:
            return None
        ended_before, high_before_s = self._pulses.get(pin, (0, 0.0))
        self._pulses[pin] = rises, high_s
        return (high_s - high_before_s) / (rises - ended_before) if rises > ended_before else None

    def turn(
        self,
        counts: float,
        seconds: float = 0.0,
        *,
        lines: Sequence[str] = ("a", "b", "index"),
        per_turn: int = 0,
        channel: int = 0,
    ) -> None:
        """Turn an encoder to `counts`, evenly within `seconds` from now. It begins at 0.

        Fractions are cut off downwards. With `per_turn` the third line is high at each whole turn. An
        `encoder_bank` has several channels.
        """
        pins = [self._pin("in", port, channel) for port in lines[: 3 if per_turn else 2]]
        place = pins[0], pins[1], pins[2] if per_turn else 0
        if not self._native.turn(self._number, place, per_turn, int(counts // 1), max(0.0, seconds)):
            raise self._without_pins()

    def modulate(self, level: float, seconds: float = 0.0, channel: int = 0) -> None:
        """Give the modulator at a channel of a `sigma_delta_adc` an input, as a share of its full scale.

        It goes there evenly within `seconds` from now. The first call puts the modulator there. `drive` of
        `data` breaks its line until the next call.

        board.components["current"].modulate(8.0 / 32.0)  # 8 A, where all bits are 1 at 32 A
        """
        if not math.isfinite(level):
            raise ValueRangeError(f"a modulator cannot have the input {level}: give a share from -1 to 1")
        lines = self._pin("out", "mclk", 0), self._pin("in", "data", channel)
        if not self._native.modulate(self._number, lines, level, max(0.0, seconds)):
            raise self._without_pins()

    def play(self, port: str, levels: Sequence[tuple[float, bool]], bit: int = 0) -> None:
        """Put levels on an input, each so many seconds from now. What is played follows what is still played.

        board.components["gnss"].play("rx", [(0.0, False), (1e-3, True)])  # low for a millisecond
        """
        self._native.play(self._number, self._pin("in", port, bit), levels)

    def edges(self, port: str, bit: int = 0) -> list[tuple[float, bool]]:
        """Return the edges of an output since the last call: when, in seconds, and the level from then on.

        The first call begins, and returns none. Of more than a million the oldest are lost.
        """
        found = self._native.edges(self._number, self._pin("out", port, bit))
        if found is None:
            raise self._without_pins()
        return found

    def time_s(self) -> float:
        """Return the time of the board, in seconds since it began."""
        return self._native.time_s()

    def serial(self, baud_hz: float | None = None) -> SerialEnd:
        """Return the far end of the line of a `uart_bridge`. The first call puts it there, with this rate.

        receiver = board.components["gnss"].serial()
        receiver.send(b"$GNGGA,")
        receiver.take()  # what the gateware has sent
        """
        if self._serial is None:
            self.drive("rx", True)
            facts = dict(self.configuration.generics)
            parity, stop_bits = int(facts["parity"]), int(facts["stop_bits"])
            self._serial = SerialEnd(self, baud_hz or int(facts["baud_hz"]), parity, stop_bits)
        elif baud_hz:
            self._serial.baud_hz = baud_hz
        return self._serial

    def modbus(self, unit: int = 1) -> ModbusDevice:
        """Return the device of this unit on the line of a `modbus_master`. The first call puts it there.

        drive = board.components["pump"].modbus(unit=1)
        drive[0x2100] = 0
        drive.answer()  # in each step of a plant
        """
        if unit not in self._modbus:
            self._modbus[unit] = ModbusDevice(self.serial(), unit)
        return self._modbus[unit]

    def radio(self) -> Radio:
        """Return the receiver of a remote control at an `rc_receiver`. The first call puts it there.

        board.components["pilot"].radio().send([1500.0] * 8)  # a frame, in microseconds
        """
        if self._radio is None:
            facts = self._facts()
            self._radio = Radio(self, sbus=bool(facts["protocol"]), inverted=bool(facts["inverted"]))
            self.drive("line", self._radio.rests_high)
        return self._radio

    @property
    def device(self) -> DeviceRegisters:
        """The registers of the device at the pins of an `spi_device` or `i2c_device`.

        The first look puts it there.

        imu = board.components["imu"].device
        imu[0x75] = 0x47                      # it says who it is
        imu[0x1D:0x1F] = bytes([0x12, 0x34])  # both at once
        """
        return self.device_with(register_bytes=1)

    def device_with(
        self, *, register_bytes: int = 1, word_bits: int = 0, numbered: bool = False
    ) -> DeviceRegisters:
        """Return the device, whose registers have one byte or two. Its bytes are counted all the same.

        meter = board.components["meter"].device_with(register_bytes=2)
        meter[2 * 3 : 2 * 3 + 2] = bytes([0x12, 0x34])  # the register 3, on I²C

        With `word_bits` it is a device on SPI without registers, as converters are. It sends one word of 1 to
        32 bits a frame: its word 0, or, if it is `numbered`, that of the four bits behind a start bit.

        converter = board.components["converter"].device_with(word_bits=10, numbered=True)  # MCP3008
        converter.set_word(8 + 3, 512)  # half of the reference voltage, at its input 3 against ground
        """
        spi = self.configuration.entity == "spi_device"
        if register_bytes not in (1, 2) or not 0 <= word_bits <= 32 or (word_bits and not spi):
            raise ValueRangeError(
                f"the device of {self.configuration.path}: choose register_bytes 1 or 2, or, on SPI, "
                f"word_bits 1 to 32, not {register_bytes} and {word_bits}"
            )
        if self._device is None:
            facts = dict(self.configuration.generics)
            if self.configuration.entity == "i2c_device":
                scl, sda = (self._pin("out", f"{line}_drive", 0) for line in ("scl", "sda"))
                lines = scl, sda, self._pin("in", "scl_in", 0), self._pin("in", "sda_in", 0)
                address = i2c_address(str(facts["program"]))
                found = self._native.attach_i2c(self._number, lines, address, register_bytes)
            else:
                select_n, sclk, mosi = (self._pin("out", name, 0) for name in ("select_n", "sclk", "mosi"))
                pins = select_n, sclk, mosi, self._pin("in", "miso", 0)
                mode = int(facts.get("mode", 0))
                found = self._native.attach_spi(self._number, pins, mode, word_bits, numbered)
            if found is None:
                raise self._without_pins()
            clock_hz = int(facts["clock_hz"])
            self._device = DeviceRegisters(found, self.configuration.path, clock_hz=clock_hz)
        return self._device

    def controller(self, channel: int = 0) -> SpeedController:
        """Return the speed controller at a channel of a `dshot`. The first call puts it there.

        esc = board.components["motor"].controller(0)
        esc.turn(1000.0 * esc.throttle)  # electrical rad/s
        """
        if channel not in self._controllers:
            pins = self._pin("out", "line_out", channel), self._pin("in", "line_in", channel)
            facts = self._facts()
            bit = facts["clock_hz"] / (1000 * facts["kbaud"])
            answer = _ANSWER_S * facts["clock_hz"]
            replies = bool(facts["bidirectional"])
            found = self._native.attach_esc(self._number, pins, bit, answer, replies)
            if found is None:
                raise self._without_pins()
            self._controllers[channel] = SpeedController(DeviceRegisters(found, self.configuration.path))
        return self._controllers[channel]

    def distance_sensor(self) -> DistanceSensor:
        """Return the sensor at the lines of a `sonar`. The first call puts it there.

        sensor = board.components["front"].distance_sensor()
        sensor.see(0.75)  # m
        """
        if self._distance_sensor is None:
            self._distance_sensor = self._sensor(
                DistanceSensor, self._native.attach_distance, "trigger", "echo"
            )
        return self._distance_sensor

    def load_cell(self, conversions_hz: float | None = None) -> LoadCell:
        """Return the chip at the lines of an `hx711`. The first call puts it there, with 80 conversions/s.

        cell = board.components["plate"].load_cell()
        cell.weigh(123456)  # counts
        """
        if self._load_cell is None:
            self._load_cell = self._sensor(LoadCell, self._native.attach_load_cell, "sck", "dout")
            self._load_cell.conversions_hz = 80
        if conversions_hz is not None:
            self._load_cell.conversions_hz = conversions_hz
        return self._load_cell

    def serial_encoder(self) -> SerialEncoder:
        """Return the encoder at the lines of an `absolute_encoder`. The first call puts it there, at 0."""
        if self._serial_encoder is None:
            self._serial_encoder = SerialEncoder.at(self._native, self._number, self.configuration, self._pin)
            if self._serial_encoder is None:
                raise self._without_pins()
        return self._serial_encoder

    def thermometer(self) -> Thermometer:
        """Return the thermometer at the line of a `one_wire`. The first call puts it there, at 25 degC.

        motor = board.components["motor"].thermometer()
        motor.warm(63.5)  # degC
        """
        if self._thermometer is None:
            attach = self._native.attach_thermometer
            self._thermometer = self._sensor(Thermometer, attach, "line_drive", "line_in")
            self._thermometer.warm(25.0)
            self._thermometer.conversion_s = 0.7 / 2 ** (12 - self._facts()["resolution"])
        return self._thermometer

    def led_strip(self) -> LedStrip:
        """Return the LEDs at the line of a `ws2812`. The first call puts them there.

        ring = board.components["ring"].led_strip()
        ring.colours  # [(red, green, blue), ...]
        """
        if self._led_strip is None:
            self._pin("out", "data", 0)
            facts = self._facts()
            self._led_strip = LedStrip(self, facts["leds"], facts["channels"])
        return self._led_strip

    def _facts(self) -> dict[str, int]:
        """Return the generics, if all are numbers."""
        return {name: int(value) for name, value in self.configuration.generics}

    def _sensor(
        self,
        kind: type[AnySensor],
        attach: Callable[[int, tuple[int, int], float], _native.BoardDevice | None],
        out: str,
        into: str,
    ) -> AnySensor:
        """Put a sensor at an output and an input."""
        pins = self._pin("out", out, 0), self._pin("in", into, 0)
        clock_hz = self._facts()["clock_hz"]
        found = attach(self._number, pins, clock_hz / 1e6)
        if found is None:
            raise self._without_pins()
        return kind(DeviceRegisters(found, self.configuration.path, clock_hz=clock_hz), clock_hz)

    def servo(self, number: int = 0) -> BusServo:
        """Return one of the servos of a `servo_bus`. The first call puts it there.

        servo = board.components["arm"].servo(0)
        servo.tell(position=2048)
        servo.goal  # counts
        """
        if number not in self._servos:
            pins = self._pin("out", "tx", 0), self._pin("out", "tx_enable", 0), self._pin("in", "rx", 0)
            facts = self._facts()
            if not 0 <= number < facts["servos"]:
                raise ValueRangeError(
                    f"{self.configuration.path} has {facts['servos']} servos: choose 0 to "
                    f"{facts['servos'] - 1}, not {number}"
                )
            bit, answer = facts["clock_hz"] / facts["baud_hz"], _ANSWER_S * facts["clock_hz"]
            feetech = bool(facts["protocol"])
            one = facts["first_id"] + number
            found = self._native.attach_servo(self._number, pins, bit, answer, feetech, one)
            if found is None:
                raise self._without_pins()
            self._servos[number] = BusServo(DeviceRegisters(found, self.configuration.path), feetech)
        return self._servos[number]

    def _look(self, port: str, bit: int) -> tuple[bool, int, int, float, float]:
        seen = self._native.look(self._number, self._pin("out", port, bit))
        if seen is None:
            raise self._without_pins()
        return seen

    def _pin(self, direction: str, port: str, bit: int) -> int:
        place = self._places.get((direction, port))
        if place is None:
            known = [name for way, name in self._places if way == direction]
            what = "input" if direction == "in" else "output"
            raise ValueRangeError(
                f"component {self.configuration.path} has no {what} {port!r}; "
                f"there are {', '.join(known) or 'none'}"
            )
        first, bits = place
        if not 0 <= bit < bits:
            raise ValueRangeError(
                f"{self.configuration.path}.{port} has {bits} pins: choose bit 0 to {bits - 1}, not {bit}"
            )
        return first + bit

    def _without_pins(self) -> ValueRangeError:
        return ValueRangeError(
            f"the pins of {self.configuration.path} cannot be reached on this board: "
            f"there is neither a model of {self.configuration.entity} nor its VHDL"
        )


class BoardComponents(Mapping[str, BoardComponent]):
    """The components of a board by their paths: `board.components["arm.wheel[0]"]`."""

    def __init__(self, native: _native.Board, configurations: Sequence[ComponentConfiguration]) -> None:
        self._found = {
            one.path: BoardComponent(native, number, one) for number, one in enumerate(configurations)
        }
        self._modelled = [one for one in configurations if _native.has_component_model(one.entity)]

    def forget(self) -> None:
        """Forget what is at all pins: the board begins anew."""
        for each in self._found.values():
            each.forget()

    def owns(self, address: int) -> bool:
        """Does a component set the word at `address` itself? Then a plant cannot."""
        return any(address in one.addresses for one in self._modelled)

    def __getitem__(self, path: str) -> BoardComponent:
        found = self._found.get(path)
        if found is None:
            raise ValueRangeError(
                f"the board has no component {path!r}; there are {', '.join(self._found) or 'none'}"
            )
        return found

    def __contains__(self, path: object) -> bool:
        return path in self._found

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)
