// SPDX-License-Identifier: BSD-3-Clause

//! Values and parts of a robot.

use std::marker::PhantomData;
use std::sync::Arc;

use crate::robot::Core;
use crate::set::{self, Places, Set};
use crate::{Cycle, Facts, Result, Value};

macro_rules! values {
    ($($(#[$about:meta])* $name:ident { $($access:ident),* })*) => {$(
        $(#[$about])*
        pub struct $name<T> {
            core: Arc<Core>,
            index: u32,
            kind: PhantomData<fn(T) -> T>,
        }

        impl<T: Value> $name<T> {
            #[doc(hidden)]
            pub fn new(core: &Arc<Core>, index: u32) -> Self {
                Self { core: Arc::clone(core), index, kind: PhantomData }
            }
            /// The value's address, unit, limits and so on.
            pub fn facts(&self) -> &'static Facts {
                &self.core.facts.values[self.index as usize]
            }
            $(access! { $access })*
        }
    )*};
}
macro_rules! access {
    (read) => {
        pub fn read(&self) -> Result<T> {
            set::read_one(&self.core, self.index)
        }
    };
    (write) => {
        /// A value that is out of its limits is an error (`UL_RANGE`), and nothing is sent.
        pub fn write(&self, value: T) -> Result<()> {
            set::write_one(&self.core, self.index, value)
        }
    };
    (clear) => {
        /// Clears the flags that are set in `flags`.
        pub fn clear(&self, flags: T) -> Result<()> {
            set::write_one(&self.core, self.index, flags)
        }
    };
    (pulse) => {
        pub fn pulse(&self, value: T) -> Result<()> {
            set::write_one(&self.core, self.index, value)
        }
    };
}
values! {
    /// A value that the gateware gives.
    ReadValue { read }
    /// A value that the gateware takes.
    WriteValue { write }
    /// A value that is read and written.
    ReadWriteValue { read, write }
    /// A read changes it, so no read is repeated: `UL_TIMEOUT` may have taken the value with it.
    ReadClearValue { read }
    /// Flags that the gateware sets.
    ClearValue { read, clear }
    /// A strobe: what is written works for a moment. It is never repeated.
    PulseValue { pulse }
}

/// A part of a robot, or a group: values that are read together, written together, and exchanged in a control loop.
pub struct Part<I, O> {
    core: Arc<Core>,
    first: u32,
    path: &'static str,
    kind: PhantomData<fn(O) -> I>,
}

impl<I: Set, O: Set> Part<I, O> {
    #[doc(hidden)]
    pub fn new(core: &Arc<Core>, first: u32, path: &'static str) -> Self {
        Part { core: Arc::clone(core), first, path, kind: PhantomData }
    }

    /// Reads all inputs.
    pub fn snapshot(&self) -> Result<I> {
        self.read(false)
    }

    /// Reads all inputs. Those of a link are of one moment, or it is an error (`UL_MISMATCH`).
    pub fn consistent_snapshot(&self) -> Result<I> {
        self.read(true)
    }

    fn read(&self, atomic: bool) -> Result<I> {
        let (mut room, mut raws) = (I::ROOM, I::RAWS);
        let places = Places::of(&self.core, self.first, I::PLACES);
        set::read(&self.core, places, atomic, room.as_mut(), raws.as_mut(), self.path)?;
        set::decode(&self.core, self.first, &raws)
    }

    /// Writes all outputs together. Nothing is sent if one is out of its limits.
    pub fn write(&self, outputs: &O) -> Result<()> {
        let raws = set::encode(&self.core, self.first, outputs)?;
        let places = Places::of(&self.core, self.first, O::PLACES);
        let mut room = O::ROOM;
        set::write(&self.core, places, raws.as_ref(), room.as_mut(), self.path)
    }

    /// The body of a control loop with all outputs and inputs.
    pub fn cycle(&self) -> Cycle<I, O> {
        Cycle::new(&self.core, self.first, self.path)
    }
}
