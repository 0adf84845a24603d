// SPDX-License-Identifier: BSD-3-Clause

//! Why a call failed. An error has its text in itself, so a failed call allocates nothing.

use std::ffi::CStr;
use std::fmt::{self, Write};

use unitylink_sys as sys;

use crate::Facts;

const TEXT_BYTES: usize = 640; // as in ul_failure of unitylink/value.h

/// What a call gives: a value, or the error why there is none.
pub type Result<T> = std::result::Result<T, Error>;

/// A status of the C ABI, the item that failed, and why.
#[derive(Clone)]
pub struct Error {
    status: sys::ul_status,
    path: &'static str,
    text: [u8; TEXT_BYTES],
    length: usize,
}

impl Error {
    pub(crate) fn new(status: sys::ul_status, path: &'static str, why: fmt::Arguments) -> Self {
        let mut made = Error { status, path, text: [0; TEXT_BYTES], length: 0 };
        // it never fails: what does not fit is left out
        let _ = write!(made, "{path}: {why}");
        made
    }

    /// The failure of the last call of the C ABI in this thread, with the name of the item.
    pub(crate) fn of_link(status: sys::ul_status, path: &'static str) -> Self {
        // SAFETY: the text is never NULL, and is valid until the next failure of this thread.
        let text = unsafe { CStr::from_ptr(sys::ul_last_error_text()) };
        Error::new(status, path, format_args!("{}", text.to_string_lossy()))
    }

    pub(crate) fn out_of_range(facts: &Facts, given: f64) -> Self {
        let (low, high, unit) = (Short(facts.minimum), Short(facts.maximum), facts.unit);
        let blank = if unit.is_empty() { "" } else { " " };
        let given = Short(given);
        Error::new(
            sys::UL_RANGE,
            facts.path,
            format_args!("{given}{blank}{unit} is not in {low} to {high}{blank}{unit}; nothing was sent"),
        )
    }

    /// A number that a closed enumeration of this name does not have. For `TryFrom` of generated types.
    #[doc(hidden)]
    pub fn no_member(path: &'static str, number: u64) -> Self {
        Error::new(
            sys::UL_RANGE,
            path,
            format_args!("{number} is not one of its numbers; nothing was sent"),
        )
    }

    /// The device holds a number that a closed enumeration does not have.
    #[doc(hidden)]
    pub fn strange_member(facts: &Facts, number: u64) -> Self {
        Error::new(
            sys::UL_PROTOCOL_ERROR,
            facts.path,
            format_args!(
                "the device holds {number}, which is not one of its numbers; if others may come, declare an open enum"
            ),
        )
    }

    /// `UL_TIMEOUT`, `UL_RANGE`, `UL_MISMATCH` and the others.
    pub fn status(&self) -> sys::ul_status {
        self.status
    }

    /// The name of the value, group, robot or link.
    pub fn path(&self) -> &'static str {
        self.path
    }

    /// What failed, why, and the remedy.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.text[..self.length]).unwrap_or("")
    }
}

impl Write for Error {
    fn write_str(&mut self, more: &str) -> fmt::Result {
        let mut room = (TEXT_BYTES - self.length).min(more.len());
        while !more.is_char_boundary(room) {
            room -= 1;
        }
        self.text[self.length..self.length + room].copy_from_slice(&more.as_bytes()[..room]);
        self.length += room;
        Ok(())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.write_str(self.text())
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        write!(to, "Error({}, {:?})", self.status, self.text())
    }
}

impl std::error::Error for Error {}

/// A number with at most nine digits, as `%.9g` of C writes it.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        if self.0.is_nan() {
            return to.write_str("nan");
        }
        if self.0.is_infinite() {
            return to.write_str(if self.0 > 0.0 { "inf" } else { "-inf" });
        }
        let mut digits = Digits::default();
        write!(digits, "{:.8e}", self.0)?;
        let (mantissa, exponent) = digits.text().split_once('e').unwrap_or(("0", "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        if (-4..9).contains(&exponent) {
            let mut plain = Digits::default();
            write!(plain, "{:.*}", (8 - exponent) as usize, self.0)?;
            return to.write_str(trimmed(plain.text()));
        }
        let sign = if exponent < 0 { '-' } else { '+' };
        write!(to, "{}e{sign}{:02}", trimmed(mantissa), exponent.abs())
    }
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

#[derive(Default)]
struct Digits {
    bytes: [u8; 32],
    length: usize,
}

impl Digits {
    fn text(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length]).unwrap_or("")
    }
}

impl Write for Digits {
    fn write_str(&mut self, more: &str) -> fmt::Result {
        let end = self.length + more.len();
        self.bytes.get_mut(self.length..end).ok_or(fmt::Error)?.copy_from_slice(more.as_bytes());
        self.length = end;
        Ok(())
    }
}
