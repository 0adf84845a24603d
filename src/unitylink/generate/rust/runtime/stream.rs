// SPDX-License-Identifier: BSD-3-Clause

//! What the gateware publishes, by poll or by callback.

use std::marker::PhantomData;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use unitylink_sys as sys;

use crate::robot::Core;
use crate::set::{self, Places, Set};
use crate::value::READ_AGAIN;
use crate::{Error, Result};

const PUBLISHES_KEPT: u32 = 4096;

struct State {
    core: Arc<Core>,
    path: &'static str,
    divisor: u32, // of the base rate; 0: published on an event
    link: usize,
    subscription: Mutex<Option<u32>>,
}

impl State {
    fn subscription(&self) -> MutexGuard<'_, Option<u32>> {
        self.subscription.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn running(&self) -> Result<u32> {
        self.subscription().ok_or_else(|| {
            Error::new(
                sys::UL_ARGUMENT,
                self.path,
                format_args!("its publishes were not started; call start first"),
            )
        })
    }

    fn stop(&self) {
        if let Some(number) = self.subscription().take() {
            self.core.links[self.link].unsubscribe(number);
        }
    }
}

impl Drop for State {
    fn drop(&mut self) {
        self.stop();
    }
}

/// One group of publishes. A clone is the same stream.
pub struct Stream<S> {
    state: Arc<State>,
    kind: PhantomData<fn() -> S>,
}

impl<S> Clone for Stream<S> {
    fn clone(&self) -> Self {
        Stream { state: Arc::clone(&self.state), kind: PhantomData }
    }
}

impl<S: Set> Stream<S> {
    #[doc(hidden)]
    pub fn new(core: &Arc<Core>, path: &'static str, divisor: u32) -> Self {
        let first = Places::of(core, 0, S::PLACES).all().next();
        let link = first.map_or(0, |(_, value)| usize::from(value.link));
        let state = State { core: Arc::clone(core), path, divisor, link, subscription: Mutex::new(None) };
        Stream { state: Arc::new(state), kind: PhantomData }
    }

    /// Lets the device publish. The newest 4096 publishes are kept until they are polled. Twice does nothing.
    pub fn start(&self) -> Result<()> {
        self.start_with(PUBLISHES_KEPT)
    }

    /// The same, and `ring` publishes are kept.
    pub fn start_with(&self, ring: u32) -> Result<()> {
        let mut subscription = self.state.subscription();
        if subscription.is_some() {
            return Ok(());
        }
        let core = &self.state.core;
        let mut addresses = Vec::new();
        let mut verify = true; // but not where a read takes something out
        for (_, value) in Places::of(core, 0, S::PLACES).all() {
            verify &= value.is(READ_AGAIN);
            addresses.extend((0..u32::from(value.words)).map(|word| value.address + word));
        }
        let options = sys::ul_subscription_options {
            size: std::mem::size_of::<sys::ul_subscription_options>() as u32,
            divisor: self.state.divisor,
            on_event: (self.state.divisor == 0).into(),
            verify: verify.into(),
            ring,
        };
        *subscription = Some(core.links[self.state.link].subscribe(&addresses, &options, self.state.path)?);
        Ok(())
    }

    /// Calls `callback(time_s, values)` for each publish that has come, oldest first, in this thread. Does not wait.
    /// Gives how many. The time is that of `CLOCK_MONOTONIC`.
    pub fn poll(&self, mut callback: impl FnMut(f64, &S)) -> Result<usize> {
        let State { core, path, link, .. } = &*self.state;
        let number = self.state.running()?;
        let mut count = 0;
        loop {
            let mut room = S::ROOM;
            let half = room.as_mut().len() / 2;
            let words = &mut room.as_mut()[..half];
            let time_s = match core.links[*link].drain(number, words, path)? {
                Some(time_s) => time_s,
                None => return Ok(count),
            };
            let mut raws = S::RAWS;
            let mut used = 0;
            for (i, value) in Places::of(core, 0, S::PLACES).all() {
                raws.as_mut()[i] = value.join(core.data_bits(value), &words[used..]);
                used += usize::from(value.words);
            }
            callback(time_s, &set::decode(core, 0, &raws)?);
            count += 1;
        }
    }

    /// Waits for a publish. False: none came in time.
    pub fn wait(&self, timeout: Duration) -> Result<bool> {
        let number = self.state.running()?;
        self.state.core.links[self.state.link].wait_publish(number, timeout, self.state.path)
    }

    /// Publishes that were overwritten before they were polled, or lost on the line.
    pub fn lost(&self) -> u64 {
        let number = *self.state.subscription();
        number.map_or(0, |number| self.state.core.links[self.state.link].lost(number))
    }

    pub fn stop(&self) {
        self.state.stop();
    }
}

/// Calls `callback(time_s, values)` for each publish in a thread of its own, until it is dropped or the link ends.
pub struct Listener {
    ended: Arc<AtomicBool>,
    error: Arc<Mutex<Option<Error>>>,
    thread: Option<JoinHandle<()>>,
}

impl Listener {
    /// The stream must have been started.
    pub fn new<S: Set + 'static>(stream: &Stream<S>, mut callback: impl FnMut(f64, &S) + Send + 'static) -> Self {
        let (stream, ended, error) = (stream.clone(), Arc::default(), Arc::default());
        let (end, told): (Arc<AtomicBool>, Arc<Mutex<Option<Error>>>) = (Arc::clone(&ended), Arc::clone(&error));
        let listen = move || {
            while !end.load(Ordering::Acquire) {
                let come = stream.wait(Duration::from_millis(50));
                if let Err(why) = come.and_then(|_| stream.poll(&mut callback)) {
                    *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
                    return;
                }
            }
        };
        Listener { ended, error, thread: Some(thread::spawn(listen)) }
    }

    /// The error that has ended the calls, if one has.
    pub fn error(&self) -> Option<Error> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // a callback that panicked has said so already
            let _ = thread.join();
        }
    }
}
