// SPDX-License-Identifier: BSD-3-Clause
// Converts raw numbers to engineering values and back, as unitylink/values/codec.py does. Raw numbers are BigInt.
"use strict";

class ValueError extends Error {}

// `quantity` is an element or field of the model: {type, scale, offset, unit, minimum, maximum, overflow}.
// `types` is {enums: {name: enum}, bits: {name: bits}}.
class Codec {
  constructor(quantity, types) {
    this.quantity = quantity;
    this.types = types;
    this.type = quantity.type;
    this.width = this.type.width;
    this.mask = (1n << BigInt(this.width)) - 1n;
    this.signed = this.type.kind === "int" || this.type.kind === "fixed";
    this.scale = quantity.scale ?? 1;
    this.offset = quantity.offset ?? 0;
    this.factor = this.scale / 2 ** (this.type.fraction ?? 0);
    this.scaled = this.type.kind === "fixed" || this.type.kind === "ufixed" || this.scale !== 1 || this.offset !== 0;
    this.ratio = this.numeric ? ratio(this.scale, this.offset, this.type.fraction ?? 0, this.width) : null;
    if (this.numeric) [this.low, this.high] = this.rawLimits();
  }

  get numeric() { return ["int", "uint", "fixed", "ufixed"].includes(this.type.kind); }
  get enum() { return this.types.enums[this.type.name]; }
  get fields() { return this.types.bits[this.type.name].fields; }

  // Returns the value of a raw number: a number (BigInt if whole), a boolean, an enumeration's name, or fields.
  decode(raw) {
    raw &= this.mask;
    switch (this.type.kind) {
      case "bool": return raw !== 0n;
      case "enum": {
        const found = this.enum.values.find((item) => BigInt(item.value) === raw);
        if (found) return found.name;
        if (this.enum.open) return raw;
        throw new ValueError(`${raw} is no ${this.type.name}`);
      }
      case "bits":
        return Object.fromEntries(this.fields.map((f) => [f.name, this.field(f).decode(raw >> BigInt(f.low))]));
      case "float": {
        const number = this.float(raw);
        return this.scaled ? number * this.scale + this.offset : number;
      }
      default: {
        const number = this.signed ? BigInt.asIntN(this.width, raw) : raw;
        return this.scaled ? this.real(number) : number;
      }
    }
  }

  real(number) {
    if (this.ratio === null) return Number(number) * this.factor + this.offset;
    const [multiplier, added, divisor] = this.ratio;
    return Number(number * multiplier + added) / Number(divisor);
  }

  // Returns the raw number of a value that a person has typed. A ValueError says what is wrong with the text.
  encode(text) {
    text = String(text).trim();
    switch (this.type.kind) {
      case "bool": {
        if (["true", "1"].includes(text)) return 1n;
        if (["false", "0"].includes(text)) return 0n;
        throw new ValueError("true or false");
      }
      case "enum": {
        const found = this.enum.values.find((item) => item.name === text);
        if (found) return BigInt(found.value);
        const number = /^(0x[0-9a-f]+|\d+)$/i.test(text) ? BigInt(text) : -1n;
        const known = this.enum.values.some((item) => BigInt(item.value) === number);
        if (known || (this.enum.open && number >= 0n && number <= this.mask)) return number;
        throw new ValueError(`one of ${this.enum.values.map((item) => item.name).join(", ")}`);
      }
      case "bits": return this.whole(text, 0n, this.mask);
      case "float": return this.encodeFloat(this.number(text));
      default: {
        if (!this.scaled) return this.whole(text, this.low, this.high) & this.mask;
        const number = (this.number(text) - this.offset) / this.factor;
        if (Number.isNaN(number)) throw new ValueError("a number");
        const infinite = number > 0 ? this.high + 1n : this.low - 1n;
        return this.within(Number.isFinite(number) ? BigInt(roundHalfEven(number)) : infinite) & this.mask;
      }
    }
  }

  field(f) {
    const type = { ...f.type, width: f.high - f.low + 1 };
    return new Codec({ ...f, overflow: "error", type }, this.types);
  }

  rawLimits() {
    const low = this.signed ? -(1n << BigInt(this.width - 1)) : 0n;
    const high = this.signed ? -low - 1n : this.mask;
    const nearest = (value) => {
      if (!this.scaled && typeof value !== "number") return BigInt(value);
      return BigInt(roundHalfEven(this.scaled ? (value - this.offset) / this.factor : value));
    };
    const limits = [this.quantity.minimum ?? null, this.quantity.maximum ?? null];
    let ends = limits.map((v) => (v === null ? null : nearest(v)));
    if (this.factor < 0) ends = ends.reverse();
    return [ends[0] !== null && ends[0] > low ? ends[0] : low, ends[1] !== null && ends[1] < high ? ends[1] : high];
  }

  within(number) {
    if (number >= this.low && number <= this.high) return number;
    if (this.quantity.overflow === "saturate") return number < this.low ? this.low : this.high;
    throw new ValueError(this.range());
  }

  whole(text, low, high) {
    if (!/^([+-]?\d+|0x[0-9a-f]+|0b[01]+)$/i.test(text)) throw new ValueError("a whole number");
    const number = text[0] === "-" ? -BigInt(text.slice(1)) : BigInt(text.replace("+", ""));
    if (this.numeric) return this.within(number);
    if (number < low || number > high) throw new ValueError(`${low} to ${high}`);
    return number;
  }

  number(text) {
    const unit = this.quantity.unit;
    if (unit && text.endsWith(unit)) text = text.slice(0, -unit.length).trim();
    if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$|^[+-]?inf$|^nan$/i.test(text)) throw new ValueError("a number");
    return Number(text.replace(/inf$/i, "Infinity").replace(/^nan$/i, "NaN"));
  }

  float(raw) {
    const view = new DataView(new ArrayBuffer(8));
    if (this.width === 32) { view.setUint32(0, Number(raw)); return view.getFloat32(0); }
    view.setBigUint64(0, raw);
    return view.getFloat64(0);
  }

  encodeFloat(value) {
    const largest = this.width === 32 ? 3.4028234663852886e38 : Number.MAX_VALUE;
    const low = this.quantity.minimum ?? -largest, high = this.quantity.maximum ?? largest;
    const limited = (this.quantity.minimum ?? null) !== null || (this.quantity.maximum ?? null) !== null;
    if (Number.isNaN(value) && limited) throw new ValueError(this.range());
    if (!Number.isNaN(value) && !(low <= value && value <= high) && (limited || Number.isFinite(value))) {
      if (this.quantity.overflow !== "saturate") throw new ValueError(this.range());
      value = Math.min(Math.max(value, low), high);
    }
    const view = new DataView(new ArrayBuffer(8));
    const number = (value - this.offset) / this.scale;
    const stored = this.width === 32 ? Math.fround(number) : number;
    const beyond = Number.isFinite(value) && !Number.isFinite(stored);
    if (beyond && this.quantity.overflow !== "saturate") throw new ValueError(this.range());
    const sent = beyond ? Math.sign(number) * largest : stored;
    if (this.width === 32) {
      view.setFloat32(0, sent);
      return BigInt(view.getUint32(0));
    }
    view.setFloat64(0, sent);
    return view.getBigUint64(0);
  }

  // Returns the range of values that may be written, as text for people.
  range() {
    const unit = this.quantity.unit ? ` ${this.quantity.unit}` : "";
    if (this.type.kind === "float") {
      const [low, high] = [this.quantity.minimum ?? null, this.quantity.maximum ?? null];
      if (low === null && high === null) return "";
      return `${low === null ? "-∞" : low} to ${high === null ? "∞" : high}${unit}`;
    }
    if (!this.numeric) return "";
    const real = (raw) => (this.scaled ? this.real(raw) : raw);
    const ends = [real(this.low), real(this.high)];
    if (this.factor < 0) ends.reverse();
    const declared = [this.quantity.minimum ?? null, this.quantity.maximum ?? null];
    return `${show(declared[0] ?? ends[0])} to ${show(declared[1] ?? ends[1])}${unit}`;
  }
}

// Returns [a, b, c] so that a value is (number * a + b) / c. This gives 12.54, while 1254 * 0.01 is 12.540000000000001.
// Returns null if there are no whole numbers that are small enough to be exact.
function ratio(scale, offset, fraction, width) {
  if (!Number.isFinite(scale) || !Number.isFinite(offset)) return null;
  const [a, aUnder] = decimal(scale), [b, bUnder] = decimal(offset);
  const under = aUnder << BigInt(fraction);
  const first = under / gcd(a, under), second = bUnder / gcd(b, bUnder);
  const divisor = first / gcd(first, second) * second;
  const multiplier = a * divisor / under, added = b * divisor / bUnder;
  const exact = 1n << 53n, size = (number) => (number < 0n ? -number : number);
  const isExact = (1n << BigInt(width)) * size(multiplier) + size(added) < exact && divisor < exact;
  return isExact ? [multiplier, added, divisor] : null;
}

// Returns the fraction that a decimal number stands for: [1n, 100n] for 0.01.
function decimal(number) {
  const [digits, exponent] = String(number).split("e");
  const [whole, behind = ""] = digits.split(".");
  const power = Number(exponent ?? 0) - behind.length;
  const numerator = BigInt(whole + behind);
  return power < 0 ? [numerator, 10n ** BigInt(-power)] : [numerator * 10n ** BigInt(power), 1n];
}

function gcd(a, b) {
  if (a < 0n) a = -a;
  while (b) [a, b] = [b, a % b];
  return a || 1n;
}

function roundHalfEven(number) {
  const floor = Math.floor(number), rest = number - floor;
  if (rest !== 0.5) return Math.round(number);
  return floor % 2 === 0 ? floor : floor + 1;
}

// Returns a value as text for people. Floats have only the digits that matter.
function show(value) {
  if (typeof value === "number") {
    if (Number.isFinite(value)) return String(Number(value.toPrecision(9)));
    return String(value).replace("Infinity", "inf").toLowerCase();
  }
  if (value !== null && typeof value === "object") {
    return Object.entries(value).map(([name, one]) => `${name}=${show(one)}`).join(", ");
  }
  return String(value);
}
