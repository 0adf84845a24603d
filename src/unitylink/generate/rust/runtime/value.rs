// SPDX-License-Identifier: BSD-3-Clause

//! The facts of one value of a spec, and the conversion between raw numbers and values.
//!
//! A value is raw * scale + offset, in its unit. The raw number has `width` bits and lies in `words` words of the bus,
//! the low word first. The same as unitylink/value.h, which is for C and C++.

use unitylink_sys as sys;

use crate::{Error, Result};

/// How the raw number is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Unsigned,
    Signed,
    Real,
    Scaled,
    Bool,
    Enum,
    Bits,
}

/// The raw number is two's complement.
pub const SIGNED: u8 = 1;
/// A value beyond the limits is replaced by the limit.
pub const SATURATE: u8 = 2;
/// Its requests have a checksum.
pub const CHECKED: u8 = 4;
/// Reading it twice does no harm.
pub const READ_AGAIN: u8 = 8;
/// Writing it twice does no harm.
pub const WRITE_AGAIN: u8 = 16;
/// An enumeration that takes other numbers, too.
pub const OPEN: u8 = 32;
/// It has a SAFE value or is a PULSE, which needs the framed protocol.
pub const FRAMES: u8 = 64;

/// What the spec says about a value.
#[derive(Debug)]
pub struct Facts {
    pub path: &'static str,
    pub unit: &'static str,
    /// Of the low word. Of a field: the number of its lowest bit.
    pub address: u32,
    pub kind: Kind,
    /// In bits.
    pub width: u8,
    pub words: u8,
    pub flags: u8,
    /// Which link of the robot.
    pub link: u8,
    /// Which committed memory of the robot; -1: none.
    pub memory: i16,
    /// Of an output: the place of its low word in this memory.
    pub slot: u16,
    /// The smallest raw number that may be written; of a signed type in two's complement of 64 bits.
    pub low: u64,
    /// The largest one.
    pub high: u64,
    pub scale: f64,
    pub offset: f64,
    /// value = (raw * multiplier + added) / divisor; divisor 0: use scale and offset.
    pub multiplier: f64,
    pub added: f64,
    pub divisor: f64,
    /// Of a real number, and for messages.
    pub minimum: f64,
    pub maximum: f64,
}

impl Facts {
    /// Whether a flag is set.
    pub fn is(&self, flag: u8) -> bool {
        self.flags & flag != 0
    }

    fn mask(&self) -> u64 {
        mask(self.width)
    }

    /// The raw number as its type reads it, for signed types.
    fn signed(&self, raw: u64) -> i64 {
        let sign = 1u64 << (self.width - 1);
        (((raw & self.mask()) ^ sign).wrapping_sub(sign)) as i64
    }

    pub(crate) fn split(&self, data_bits: u32, raw: u64, words: &mut [u32]) {
        for (number, word) in words.iter_mut().take(self.words.into()).enumerate() {
            let shift = number as u32 * data_bits;
            *word = (raw.checked_shr(shift).unwrap_or(0) & mask(data_bits as u8)) as u32;
        }
    }

    pub(crate) fn join(&self, data_bits: u32, words: &[u32]) -> u64 {
        let mut raw = 0u64;
        for (number, word) in words.iter().take(self.words.into()).enumerate() {
            raw |= u64::from(*word).checked_shl(number as u32 * data_bits).unwrap_or(0);
        }
        raw & self.mask()
    }
}

fn mask(width: u8) -> u64 {
    if width >= 64 {
        u64::MAX
    } else {
        (1 << width) - 1
    }
}

/// A type that a value of a spec can have.
pub trait Value: Copy {
    #[doc(hidden)]
    fn decode(facts: &Facts, raw: u64) -> Result<Self>;
    #[doc(hidden)]
    fn encode(self, facts: &Facts) -> Result<u64>;
}

impl Value for bool {
    fn decode(_: &Facts, raw: u64) -> Result<Self> {
        Ok(raw & 1 != 0)
    }
    fn encode(self, _: &Facts) -> Result<u64> {
        Ok(self.into())
    }
}

macro_rules! whole_numbers {
    ($encode:ident, $wide:ty, $decode:expr; $($type:ty),*) => {$(
        impl Value for $type {
            fn decode(facts: &Facts, raw: u64) -> Result<Self> {
                Ok($decode(facts, raw) as $type)
            }
            fn encode(self, facts: &Facts) -> Result<u64> {
                $encode(facts, <$wide>::from(self))
            }
        }
    )*};
}
whole_numbers!(encode_unsigned, u64, |facts: &Facts, raw| raw & facts.mask(); u8, u16, u32, u64);
whole_numbers!(encode_signed, i64, Facts::signed; i8, i16, i32, i64);

fn encode_signed(facts: &Facts, number: i64) -> Result<u64> {
    let (low, high) = (facts.low as i64, facts.high as i64);
    if !(low..=high).contains(&number) && !facts.is(SATURATE) {
        return Err(Error::out_of_range(facts, number as f64));
    }
    Ok(number.max(low).min(high) as u64 & facts.mask())
}

fn encode_unsigned(facts: &Facts, number: u64) -> Result<u64> {
    if !(facts.low..=facts.high).contains(&number) && !facts.is(SATURATE) {
        return Err(Error::out_of_range(facts, number as f64));
    }
    Ok(number.max(facts.low).min(facts.high))
}

impl Value for f64 {
    fn decode(facts: &Facts, raw: u64) -> Result<Self> {
        if facts.kind == Kind::Scaled {
            let whole = if facts.is(SIGNED) { facts.signed(raw) as f64 } else { (raw & facts.mask()) as f64 };
            return Ok(if facts.divisor != 0.0 {
                (whole * facts.multiplier + facts.added) / facts.divisor
            } else {
                whole * facts.scale + facts.offset
            });
        }
        let real = if facts.width == 32 { f32::from_bits(raw as u32).into() } else { f64::from_bits(raw) };
        let plain = facts.scale == 1.0 && facts.offset == 0.0; // -0 stays -0
        Ok(if plain { real } else { real * facts.scale + facts.offset })
    }

    /// A set-point is never NaN or infinite.
    fn encode(self, facts: &Facts) -> Result<u64> {
        if facts.kind == Kind::Scaled {
            return encode_scaled(facts, self);
        }
        let refused = || Err(Error::out_of_range(facts, self));
        let saturates = facts.is(SATURATE);
        let mut number = self;
        if !(facts.minimum <= self && self <= facts.maximum) {
            if self.is_nan() || !saturates {
                return refused();
            }
            number = if self < facts.minimum { facts.minimum } else { facts.maximum };
        }
        number = (number - facts.offset) / facts.scale;
        if facts.width == 32 {
            let most = f64::from(f32::MAX);
            // the largest number that is rounded to a finite one lies half a step above f32::MAX
            if number.abs() >= most + 2f64.powi(103) && !saturates {
                return refused();
            }
            return Ok((number.max(-most).min(most) as f32).to_bits().into());
        }
        if number.is_infinite() {
            if !saturates {
                return refused();
            }
            number = f64::MAX.copysign(number);
        }
        Ok(number.to_bits())
    }
}

fn encode_scaled(facts: &Facts, wanted: f64) -> Result<u64> {
    let signed = facts.is(SIGNED);
    let number = round_to_even((wanted - facts.offset) / facts.scale);
    if number.is_nan() {
        return Err(Error::out_of_range(facts, wanted));
    }
    let end = 2f64.powi(if signed { 63 } else { 64 }); // numbers from here on do not fit 64 bits
    let mut low = number < if signed { -end } else { 0.0 };
    let mut high = number >= end;
    let mut bits = 0;
    if !low && !high {
        if signed {
            bits = number as i64 as u64;
            low = (bits as i64) < facts.low as i64;
            high = bits as i64 > facts.high as i64;
        } else {
            bits = number as u64;
            low = bits < facts.low;
            high = bits > facts.high;
        }
    }
    if (low || high) && !facts.is(SATURATE) {
        return Err(Error::out_of_range(facts, wanted));
    }
    let bits = if low {
        facts.low
    } else if high {
        facts.high
    } else {
        bits
    };
    Ok(bits & facts.mask())
}

/// The nearest whole number; of two that are as near, the even one.
fn round_to_even(number: f64) -> f64 {
    const WHOLE: f64 = 4_503_599_627_370_496.0; // 2**52: from here on each number is whole
    if number.is_nan() || number.abs() >= WHOLE {
        return number;
    }
    let magic = WHOLE.copysign(number);
    (number + magic) - magic
}

/// A field of a packed value.
#[doc(hidden)]
pub fn decode_field<T: Value>(facts: &Facts, raw: u64) -> Result<T> {
    T::decode(facts, raw >> facts.address & facts.mask())
}
#[doc(hidden)]
pub fn encode_field<T: Value>(facts: &Facts, value: T) -> Result<u64> {
    Ok((value.encode(facts)? & facts.mask()) << facts.address)
}

/// The number of an open enumeration.
#[doc(hidden)]
pub fn encode_open(facts: &Facts, number: u64) -> Result<u64> {
    if number > facts.mask() {
        return Err(Error::new(
            sys::UL_RANGE,
            facts.path,
            format_args!("{number} is not one of its numbers; nothing was sent"),
        ));
    }
    Ok(number)
}
