// SPDX-License-Identifier: BSD-3-Clause

//! Links and values as objects of Rust: what the crates of `unitylink generate --only rust` are made of. It stands on
//! the C ABI (unitylink.h). After their construction the objects allocate nothing, and plain memory needs no lock.
//!
//! Threads: all types are `Send` and `Sync`. Outputs behind a commit (TOSNET, DOUBLE_BUFFER) share a shadow, so their
//! writes take a lock, which is held until the device has answered.

#![deny(unsafe_op_in_unsafe_fn)]

mod cycle;
mod error;
mod link;
mod part;
mod robot;
mod set;
mod stream;
mod value;

pub use crate::cycle::Cycle;
pub use crate::error::{Error, Result};
pub use crate::link::Link;
pub use crate::part::{ClearValue, Part, PulseValue, ReadClearValue, ReadValue, ReadWriteValue, WriteValue};
pub use crate::robot::{LinkFacts, MemoryFacts, RobotFacts};
pub use crate::set::Set;
pub use crate::stream::{Listener, Stream};
pub use crate::value::{Facts, Kind, Value};
pub use unitylink_sys::status::*;
pub use unitylink_sys::{ul_configuration as Configuration, ul_statistics as Statistics, ul_status as Status};

#[doc(hidden)]
pub use crate::{
    robot::Core,
    set::{Decoder, Encoder},
    value::{decode_field, encode_field, encode_open, CHECKED, FRAMES, OPEN, READ_AGAIN, SATURATE, SIGNED, WRITE_AGAIN},
};
