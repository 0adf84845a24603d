// SPDX-License-Identifier: BSD-3-Clause

//! Several values of a robot at once: read together, written together. One value is a set of one.

use unitylink_sys as sys;

use crate::link::how;
use crate::robot::Core;
use crate::value::{Facts, CHECKED, READ_AGAIN, WRITE_AGAIN};
use crate::{Result, Value};

/// A generated struct of values that are read, written or published together.
pub trait Set: Sized {
    /// Raw numbers, one for each value.
    #[doc(hidden)]
    type Raws: AsRef<[u64]> + AsMut<[u64]>;
    /// Two words for each word of the values.
    #[doc(hidden)]
    type Room: AsMut<[u32]>;
    #[doc(hidden)]
    const RAWS: Self::Raws;
    #[doc(hidden)]
    const ROOM: Self::Room;
    /// The places of all values in the robot's table, counted from the first one of the part.
    #[doc(hidden)]
    const PLACES: &'static [u16];
    #[doc(hidden)]
    fn decode(from: &mut Decoder) -> Result<Self>;
    #[doc(hidden)]
    fn encode(&self, to: &mut Encoder) -> Result<()>;
}

/// The places of values, with their facts.
#[derive(Clone, Copy)]
pub(crate) struct Places {
    pub(crate) values: &'static [Facts],
    pub(crate) first: usize,
    pub(crate) places: &'static [u16],
}

impl Places {
    pub(crate) fn of(core: &Core, first: u32, places: &'static [u16]) -> Self {
        Places { values: core.facts.values, first: first as usize, places }
    }

    pub(crate) fn facts(self, number: usize) -> &'static Facts {
        &self.values[self.first + usize::from(self.places[number])]
    }

    pub(crate) fn all(self) -> impl Iterator<Item = (usize, &'static Facts)> {
        (0..self.places.len()).map(move |number| (number, self.facts(number)))
    }
}

/// Gives the values of a set, in order.
#[doc(hidden)]
pub struct Decoder<'a> {
    places: Places,
    raws: &'a [u64],
    at: usize,
}

impl Decoder<'_> {
    pub fn value<T: Value>(&mut self) -> Result<T> {
        let value = T::decode(self.places.facts(self.at), self.raws[self.at]);
        self.at += 1;
        value
    }
}

/// Takes the values of a set, in order.
#[doc(hidden)]
pub struct Encoder<'a> {
    places: Places,
    raws: &'a mut [u64],
    at: usize,
}

impl Encoder<'_> {
    pub fn value<T: Value>(&mut self, value: T) -> Result<()> {
        self.raws[self.at] = value.encode(self.places.facts(self.at))?;
        self.at += 1;
        Ok(())
    }
}

pub(crate) fn decode<S: Set>(core: &Core, first: u32, raws: &S::Raws) -> Result<S> {
    S::decode(&mut Decoder { places: Places::of(core, first, S::PLACES), raws: raws.as_ref(), at: 0 })
}

pub(crate) fn encode<S: Set>(core: &Core, first: u32, set: &S) -> Result<S::Raws> {
    let mut raws = S::RAWS;
    set.encode(&mut Encoder { places: Places::of(core, first, S::PLACES), raws: raws.as_mut(), at: 0 })?;
    Ok(raws)
}

/// Reads the raw numbers. `atomic`: those of a link are of one moment, or it is `UL_MISMATCH`.
pub(crate) fn read(
    core: &Core,
    places: Places,
    atomic: bool,
    room: &mut [u32],
    raws: &mut [u64],
    path: &'static str,
) -> Result<()> {
    let half = room.len() / 2;
    let (addresses, words) = room.split_at_mut(half);
    for (number, link) in core.links.iter().enumerate() {
        let (mut checked, mut again, mut taken) = (false, true, 0);
        let behind = || places.all().filter(|(_, value)| usize::from(value.link) == number);
        for (_, value) in behind() {
            checked |= value.is(CHECKED);
            again &= value.is(READ_AGAIN);
            taken += named(value, &mut addresses[taken..]);
        }
        let how = how(checked, again);
        link.read_words(core.framed[number], &addresses[..taken], &mut words[..taken], atomic, &how, path)?;
        let mut used = 0;
        for (i, value) in behind() {
            raws[i] = value.join(core.data_bits(value), &words[used..]);
            used += usize::from(value.words);
        }
    }
    Ok(())
}

/// Writes plain words in one burst for each link, then committed memory.
pub(crate) fn write(
    core: &Core,
    places: Places,
    raws: &[u64],
    room: &mut [u32],
    path: &'static str,
) -> Result<()> {
    let half = room.len() / 2;
    let (addresses, words) = room.split_at_mut(half);
    for (number, link) in core.links.iter().enumerate() {
        let (mut checked, mut again, mut taken) = (false, true, 0);
        for (i, value) in places.all().filter(|(_, one)| usize::from(one.link) == number && one.memory < 0) {
            checked |= value.is(CHECKED);
            again &= value.is(WRITE_AGAIN);
            value.split(core.data_bits(value), raws[i], &mut words[taken..]);
            taken += named(value, &mut addresses[taken..]);
        }
        let how = how(checked, again);
        link.write_words(core.framed[number], &addresses[..taken], &words[..taken], &how, path)?;
    }
    commit(core, places, raws, path)
}

/// Writes the outputs that lie in committed memory: one burst and one commit for each memory.
pub(crate) fn commit(core: &Core, places: Places, raws: &[u64], path: &'static str) -> Result<()> {
    for number in 0..core.facts.memories.len() {
        let mut burst = None;
        for (i, value) in places.all().filter(|(_, one)| one.memory == number as i16) {
            let memory = match &mut burst {
                Some(memory) => memory,
                None => burst.insert(core.begin(number, path)?),
            };
            value.split(core.data_bits(value), raws[i], &mut memory.next[usize::from(value.slot)..]);
        }
        if let Some(memory) = &mut burst {
            core.commit(memory, path)?;
        }
    }
    Ok(())
}

fn named(value: &Facts, addresses: &mut [u32]) -> usize {
    for (word, address) in addresses.iter_mut().take(value.words.into()).enumerate() {
        *address = value.address + word as u32;
    }
    value.words.into()
}

const VALUE_WORDS_MAX: usize = 8; // 64 bits on a bus of 8

pub(crate) fn read_one<T: Value>(core: &Core, index: u32) -> Result<T> {
    let places = Places::of(core, index, &[0]);
    let value = places.facts(0);
    let words = usize::from(value.words);
    let (mut room, mut raws) = ([0; 2 * VALUE_WORDS_MAX], [0]);
    read(core, places, words > 1, &mut room[..2 * words], &mut raws, value.path)?;
    T::decode(value, raws[0])
}

pub(crate) fn write_one<T: Value>(core: &Core, index: u32, wanted: T) -> Result<()> {
    let places = Places::of(core, index, &[0]);
    let value = places.facts(0);
    let raws = [wanted.encode(value)?];
    let mut room = [0; 2 * VALUE_WORDS_MAX];
    write(core, places, &raws, &mut room[..2 * usize::from(value.words)], value.path)
}

/// The words of the values, and in how many bytes each comes.
pub(crate) fn layout(core: &Core, places: Places, outputs: bool, addresses: &mut Vec<u32>) -> Vec<sys::ul_exchange_word> {
    let mut words = Vec::new();
    for (_, value) in places.all().filter(|(_, value)| !outputs || value.memory < 0) {
        let data_bytes = core.data_bits(value) / 8;
        let mut left = (u32::from(value.width) + 7) / 8;
        for word in 0..u32::from(value.words) {
            let bytes = left.min(data_bytes);
            let address = value.address + word;
            addresses.push(address);
            words.push(sys::ul_exchange_word { address, bytes });
            left -= bytes;
        }
    }
    words
}
