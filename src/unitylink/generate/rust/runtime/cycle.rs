// SPDX-License-Identifier: BSD-3-Clause

//! The body of a control loop: all outputs of a part are written, then all its inputs are read.

use std::marker::PhantomData;
use std::sync::Arc;

use unitylink_sys as sys;

use crate::robot::{how_once, Core};
use crate::set::{self, Places, Set};
use crate::{Error, Result};

/// `exchange` writes all outputs, then reads all inputs, in one message each way where the device can. Call `open`
/// before the loop. It names the words to the device once, and only it allocates.
pub struct Cycle<I, O> {
    core: Arc<Core>,
    first: u32,
    path: &'static str,
    link: usize,
    addresses: Vec<u32>,
    words: Vec<u32>,
    plain: usize,       // words of outputs that need no commit
    group: Option<u32>, // none: the device has no room for it, so each message names its words
    opened: bool,
    kind: PhantomData<fn(O) -> I>,
}

impl<I: Set, O: Set> Cycle<I, O> {
    pub(crate) fn new(core: &Arc<Core>, first: u32, path: &'static str) -> Self {
        Cycle {
            core: Arc::clone(core),
            first,
            path,
            link: 0,
            addresses: Vec::new(),
            words: Vec::new(),
            plain: 0,
            group: None,
            opened: false,
            kind: PhantomData,
        }
    }

    /// Twice does nothing. `UL_MISMATCH`: the values are behind several links.
    pub fn open(&mut self) -> Result<()> {
        if self.opened {
            return Ok(());
        }
        let (outputs, inputs) = (self.places::<O>(), self.places::<I>());
        let mut links = outputs.all().chain(inputs.all()).map(|(_, value)| usize::from(value.link));
        self.link = links.next().unwrap_or(0);
        if links.any(|link| link != self.link) {
            return Err(Error::new(
                sys::UL_MISMATCH,
                self.path,
                format_args!("its values are behind several links, and a cycle has one; make a cycle for each"),
            ));
        }
        self.addresses.clear();
        let written = set::layout(&self.core, outputs, true, &mut self.addresses);
        let read = set::layout(&self.core, inputs, false, &mut self.addresses);
        self.plain = written.len();
        self.words = vec![0; self.addresses.len()];
        if !self.words.is_empty() {
            self.group = self.core.links[self.link].define_exchange(&written, &read, self.path)?;
        }
        self.opened = true;
        Ok(())
    }

    /// Nothing is sent if an output is out of its limits.
    pub fn exchange(&mut self, outputs: &O) -> Result<I> {
        self.open()?;
        let out = set::encode(&self.core, self.first, outputs)?;
        let written = self.places::<O>();
        set::commit(&self.core, written, out.as_ref(), self.path)?;
        let mut at = 0;
        for (number, value) in written.all().filter(|(_, value)| value.memory < 0) {
            value.split(self.core.data_bits(value), out.as_ref()[number], &mut self.words[at..]);
            at += usize::from(value.words);
        }
        let link = &self.core.links[self.link];
        let (plain, read) = self.words.split_at_mut(self.plain);
        match self.group {
            Some(group) => link.exchange(group, plain, read, self.path)?,
            None if plain.is_empty() && read.is_empty() => {}
            None => {
                let (to, at) = self.addresses.split_at(self.plain);
                link.transfer(to, plain, at, read, self.core.framed[self.link], &how_once(), self.path)?;
            }
        }
        let mut raws = I::RAWS;
        let mut used = 0;
        for (number, value) in Places::of(&self.core, self.first, I::PLACES).all() {
            raws.as_mut()[number] = value.join(self.core.data_bits(value), &read[used..]);
            used += usize::from(value.words);
        }
        set::decode(&self.core, self.first, &raws)
    }

    fn places<S: Set>(&self) -> Places {
        Places::of(&self.core, self.first, S::PLACES)
    }
}

impl<I, O> Drop for Cycle<I, O> {
    fn drop(&mut self) {
        if let Some(group) = self.group {
            self.core.links[self.link].release_exchange(group);
        }
    }
}
