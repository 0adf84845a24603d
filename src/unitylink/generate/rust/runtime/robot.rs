// SPDX-License-Identifier: BSD-3-Clause

//! What is behind the objects of a robot: its tables, its links, and its committed memory.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use unitylink_sys as sys;

use crate::link::how;
use crate::value::{Facts, FRAMES};
use crate::{Error, Link, Result};

/// What the spec says about a link of the robot.
#[derive(Debug)]
pub struct LinkFacts {
    pub name: &'static str,
    pub data_bits: u32,
    pub address_bits: u32,
    /// The wire hashes that gateware of this spec may have.
    pub gateware: &'static [u64],
}

/// Memory whose outputs take effect by a commit. The commit swaps two buffers without copying, so it needs all outputs.
#[derive(Debug)]
pub struct MemoryFacts {
    /// The links of the data, and of commits and status.
    pub link: usize,
    pub control: usize,
    /// The address of the commit; on TosNet also of the status word.
    pub commit: u32,
    /// Bits of the status word; 0: there is no status word.
    pub pending: u32,
    pub aborted: u32,
    pub online: u32,
    pub halted: u32,
    /// All outputs, then the commit.
    pub addresses: &'static [u32],
}

impl MemoryFacts {
    fn outputs(&self) -> usize {
        self.addresses.len() - 1
    }
}

/// The tables of a robot.
#[derive(Debug)]
pub struct RobotFacts {
    /// Of the public constructor.
    pub name: &'static str,
    /// The file name of the spec.
    pub spec: &'static str,
    pub values: &'static [Facts],
    pub links: &'static [LinkFacts],
    pub memories: &'static [MemoryFacts],
}

/// The words of a committed memory, all outputs and then the commit. `shadow`: as last committed, if `known`.
pub(crate) struct Memory {
    number: usize,
    shadow: Vec<u32>,
    pub(crate) next: Vec<u32>,
    known: bool,
    settled: bool, // no commit of ours can be pending
    generation: u64,
}

/// What all objects of a robot share.
#[doc(hidden)]
pub struct Core {
    pub(crate) facts: &'static RobotFacts,
    pub(crate) links: Vec<Link>,
    pub(crate) framed: Vec<bool>,
    memories: Vec<Mutex<Memory>>,
    unverified: String,
}

impl Core {
    /// Checks that the boards behind the links are those of the spec.
    #[doc(hidden)]
    pub fn new(facts: &'static RobotFacts, links: Vec<Link>) -> Result<Arc<Core>> {
        let mut framed = Vec::new();
        let mut unverified = String::new();
        for (number, (link, wanted)) in links.iter().zip(facts.links).enumerate() {
            framed.push(link.protocol() == "framed");
            let why = check_link(facts, number, link, wanted)?;
            if !why.is_empty() {
                unverified = why;
            }
        }
        let memories = facts.memories.iter().enumerate().map(|(number, one)| Mutex::new(Memory::new(number, one)));
        Ok(Arc::new(Core { facts, links, framed, memories: memories.collect(), unverified }))
    }

    #[doc(hidden)]
    pub fn unverified(&self) -> &str {
        &self.unverified
    }

    pub(crate) fn data_bits(&self, value: &Facts) -> u32 {
        self.facts.links[usize::from(value.link)].data_bits
    }

    /// Begins a burst: the words as last committed are in `next`, to be changed. A running robot does not jump: what is
    /// not known is read. Nobody else writes this memory until the guard is dropped.
    pub(crate) fn begin(&self, number: usize, path: &'static str) -> Result<MutexGuard<'_, Memory>> {
        let facts = &self.facts.memories[number];
        // a panic of another thread leaves a memory that is not settled, so it is looked at again
        let mut memory = self.memories[number].lock().unwrap_or_else(PoisonError::into_inner);
        let generation = self.generation(facts);
        if generation != memory.generation {
            memory.known = false;
            memory.settled = false;
            memory.generation = generation;
        }
        if !memory.settled {
            self.settle(facts, false, None, path)?;
        }
        if !memory.known {
            let outputs = facts.outputs();
            let (link, framed) = (&self.links[facts.link], self.framed[facts.link]);
            let (at, to) = (&facts.addresses[..outputs], &mut memory.shadow[..outputs]);
            link.read_words(framed, at, to, false, &how(false, true), path)?;
            memory.known = true;
        }
        let Memory { shadow, next, .. } = &mut *memory;
        next.copy_from_slice(shadow);
        if let Some(commit) = next.last_mut() {
            *commit = 1;
        }
        Ok(memory)
    }

    /// Writes `next` and commits it. A commit is never repeated.
    pub(crate) fn commit(&self, memory: &mut Memory, path: &'static str) -> Result<()> {
        let facts = &self.facts.memories[memory.number];
        let outputs = facts.outputs();
        let (link, control) = (&self.links[facts.link], &self.links[facts.control]);
        let at_once = link.same(control) && self.framed[facts.link];
        let mut word = [0];
        memory.settled = false; // whatever happens from here on, look before the next burst
        let done = if at_once {
            let (to, from) = (facts.addresses, &memory.next[..]);
            link.transfer(to, from, &[facts.commit], &mut word, false, &how_once(), path)
        } else {
            let (to, from) = (&facts.addresses[..outputs], &memory.next[..outputs]);
            link.write_words(false, to, from, &how(false, true), path)
                .and_then(|()| control.write_words(false, &[facts.commit], &[1], &how_once(), path))
        };
        match &done {
            Err(error) if error.status() != sys::UL_UNKNOWN => {
                memory.known = false; // a burst that failed half-way has left other words in the hidden buffer
            }
            _ => {
                let Memory { shadow, next, .. } = &mut *memory;
                shadow[..outputs].copy_from_slice(&next[..outputs]);
            }
        }
        done?;
        self.settle(facts, true, if at_once { Some(word[0]) } else { None }, path)?;
        memory.settled = true;
        Ok(())
    }

    /// Changes each time a device of the memory may have lost what was written to it.
    fn generation(&self, facts: &MemoryFacts) -> u64 {
        let (link, control) = (&self.links[facts.link], &self.links[facts.control]);
        let counted = |link: &Link| link.statistics().map_or(0, |told| told.restarts + told.reconnections);
        let other = if link.same(control) { 0 } else { counted(control) };
        counted(link) + other + 1 // 0 stands for a memory that was never looked at
    }

    /// Waits until no commit is pending. After a commit of our own it checks that the network has not dropped it.
    fn settle(&self, facts: &MemoryFacts, committed: bool, word: Option<u32>, path: &'static str) -> Result<()> {
        if facts.pending == 0 {
            return Ok(());
        }
        let failed = |status, why: &str| Err(Error::new(status, path, format_args!("{why}")));
        let end = Instant::now() + Duration::from_millis(500);
        let mut told = word;
        let word = loop {
            let word = match told.take() {
                Some(word) => word,
                None => {
                    let mut read = [0];
                    let control = &self.links[facts.control];
                    control.read_words(false, &[facts.commit], &mut read, false, &how_default(), path)?;
                    read[0]
                }
            };
            if word & facts.halted != 0 {
                return failed(sys::UL_MISMATCH, "the TosNet network is halted until its reset");
            }
            if word & facts.online == 0 {
                return failed(sys::UL_MISMATCH, "the TosNet network is offline; outputs take no effect");
            }
            if word & facts.pending == 0 {
                break word;
            }
            if Instant::now() > end {
                return failed(
                    sys::UL_TIMEOUT,
                    "a commit is still pending after 0.5 s; the network does not cycle",
                );
            }
        };
        if committed && word & facts.aborted != 0 {
            return failed(
                sys::UL_PROTOCOL_ERROR,
                "the commit was aborted: another program wrote while it was pending. Write again",
            );
        }
        Ok(())
    }
}

impl Memory {
    fn new(number: usize, facts: &MemoryFacts) -> Self {
        let words = vec![0; facts.addresses.len()];
        Memory { number, shadow: words.clone(), next: words, known: false, settled: false, generation: 0 }
    }
}

/// As the URL says, and sent once.
pub(crate) fn how_once() -> sys::ul_options {
    how(false, false)
}

/// As the URL says; a read may be sent again.
fn how_default() -> sys::ul_options {
    how(false, true)
}

fn check_link(facts: &RobotFacts, number: usize, link: &Link, wanted: &LinkFacts) -> Result<String> {
    let has = link.configuration().map_err(|why| Error::new(why.status(), facts.name, format_args!("{why}")))?;
    let unverified = link.check_spec(facts.spec, wanted.gateware, facts.name)?;
    let (data_bits, address_bits) = (has.data_bytes * 8, has.address_bytes * 8);
    if data_bits != wanted.data_bits || address_bits < wanted.address_bits {
        return Err(Error::new(
            sys::UL_MISMATCH,
            facts.name,
            format_args!(
                "the device has words of {data_bits} and addresses of {address_bits} bits, and {} needs {} and {}: \
                 this is not its board",
                facts.spec, wanted.data_bits, wanted.address_bits
            ),
        ));
    }
    let notice = link.notice();
    let framed_only = |value: &&Facts| usize::from(value.link) == number && value.is(FRAMES);
    match facts.values.iter().find(framed_only) {
        Some(value) if !notice.is_empty() => Err(Error::new(
            sys::UL_MISMATCH,
            value.path,
            format_args!(
                "it needs the framed protocol, and the link has fallen back to the classic one: {notice}. Use \
                 gateware with the framed protocol, or add protocol=classic to the URL if you want that"
            ),
        )),
        _ => Ok(unverified),
    }
}
