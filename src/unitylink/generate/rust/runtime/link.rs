// SPDX-License-Identifier: BSD-3-Clause

//! An open link: the calls of the C ABI, without pointers.

use std::ffi::{CStr, CString};
use std::mem::size_of;
use std::ptr;
use std::sync::Arc;
use std::time::Duration;

use unitylink_sys as sys;

use crate::{Error, Result};

const LINK: &str = "link";

struct Handle(*mut sys::ul_link);

// SAFETY: unitylink.h promises that every function may be called from any thread at any time, and that only ul_free
// must be the last call. `Drop` of the one owner is the last one, as each call borrows it.
unsafe impl Send for Handle {}
unsafe impl Sync for Handle {}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: the handle came from ul_open, and nobody has it after this.
        unsafe { sys::ul_free(self.0) }
    }
}

/// An open link. docs/command-line.md describes the URLs. A clone is the same link, which is freed with its last clone.
/// After a fork() it belongs to the parent: the child must end without dropping it (`_exit` or `exec`).
#[derive(Clone)]
pub struct Link {
    handle: Arc<Handle>,
}

/// How requests are made: `checked` with a checksum, `again`: sending them twice does no harm.
pub(crate) fn how(checked: bool, again: bool) -> sys::ul_options {
    sys::ul_options {
        size: size_of::<sys::ul_options>() as u32,
        checked: if checked { 1 } else { -1 },
        repeat: again.into(),
        reserved: 0,
        timeout_ns: 0,
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

fn told(status: sys::ul_status, path: &'static str) -> Result<()> {
    if status == sys::UL_OK {
        Ok(())
    } else {
        Err(Error::of_link(status, path))
    }
}

impl Link {
    /// Opens a link.
    pub fn open(url: &str) -> Result<Link> {
        let text = CString::new(url).map_err(|_| {
            Error::new(sys::UL_BAD_URL, LINK, format_args!("the URL has a NUL character; remove it"))
        })?;
        let mut link = ptr::null_mut();
        // SAFETY: both pointers are valid for the call.
        told(unsafe { sys::ul_open(text.as_ptr(), &mut link) }, LINK)?;
        Ok(Link { handle: Arc::new(Handle(link)) })
    }

    fn raw(&self) -> *mut sys::ul_link {
        self.handle.0
    }

    /// Ends the link. A call that waits in another thread gets `UL_CLOSED`.
    pub fn close(&self) {
        // SAFETY: the handle is open as long as `self`. The same holds below.
        unsafe { sys::ul_close(self.raw()) };
    }

    /// After this silence of the program the gateware makes the outputs safe. Zero: never.
    pub fn set_dead_man(&self, silence: Duration) -> Result<()> {
        told(unsafe { sys::ul_set_dead_man(self.raw(), nanoseconds(silence), ptr::null()) }, LINK)
    }

    /// Allows writes again after the dead-man has tripped.
    pub fn arm(&self) -> Result<()> {
        told(unsafe { sys::ul_arm(self.raw(), ptr::null()) }, LINK)
    }

    /// From now on `alive` must be called within this time, or the dead-man trips. Zero: never.
    pub fn watch_program(&self, patience: Duration) -> Result<()> {
        told(unsafe { sys::ul_watch_program(self.raw(), nanoseconds(patience)) }, LINK)
    }

    /// Says that the program works. Does not lock, wait or allocate.
    pub fn alive(&self) {
        unsafe { sys::ul_alive(self.raw()) }
    }

    /// With reconnect=1 in the URL: waits until the line is there.
    pub fn wait_up(&self, timeout: Duration) -> Result<()> {
        told(unsafe { sys::ul_wait_up(self.raw(), nanoseconds(timeout)) }, LINK)
    }

    /// "framed", "classic" or "memory".
    pub fn protocol(&self) -> &str {
        // SAFETY: never NULL, and a constant of the library.
        unsafe { CStr::from_ptr(sys::ul_protocol(self.raw())) }.to_str().unwrap_or("")
    }

    /// A warning if the link has fallen back to the classic protocol, else "".
    pub fn notice(&self) -> String {
        // SAFETY: never NULL, and valid as long as the link.
        unsafe { CStr::from_ptr(sys::ul_notice(self.raw())) }.to_string_lossy().into_owned()
    }

    /// Reads the word at an address.
    pub fn read(&self, address: u32) -> Result<u32> {
        let mut word = 0;
        told(unsafe { sys::ul_read(self.raw(), address, &mut word, ptr::null()) }, LINK)?;
        Ok(word)
    }

    /// Writes the word at an address.
    pub fn write(&self, address: u32, word: u32) -> Result<()> {
        told(unsafe { sys::ul_write(self.raw(), address, word, ptr::null()) }, LINK)
    }

    /// What the device told about itself.
    pub fn configuration(&self) -> Result<sys::ul_configuration> {
        // SAFETY: a struct of numbers, for which zeros are valid.
        let mut has: sys::ul_configuration = unsafe { std::mem::zeroed() };
        has.size = size_of::<sys::ul_configuration>() as u32;
        told(unsafe { sys::ul_get_configuration(self.raw(), &mut has) }, LINK)?;
        Ok(has)
    }

    /// What the link has counted.
    pub fn statistics(&self) -> Result<sys::ul_statistics> {
        // SAFETY: as above.
        let mut counted: sys::ul_statistics = unsafe { std::mem::zeroed() };
        counted.size = size_of::<sys::ul_statistics>() as u32;
        told(unsafe { sys::ul_get_statistics(self.raw(), &mut counted) }, LINK)?;
        Ok(counted)
    }

    pub(crate) fn same(&self, other: &Link) -> bool {
        Arc::ptr_eq(&self.handle, &other.handle)
    }

    /// Returns why it is not known that the gateware has this spec, or "".
    pub(crate) fn check_spec(&self, spec: &str, hashes: &[u64], path: &'static str) -> Result<String> {
        let spec = CString::new(spec).unwrap_or_default();
        let mut text = ptr::null();
        let status =
            unsafe { sys::ul_check_spec(self.raw(), spec.as_ptr(), hashes.as_ptr(), hashes.len(), &mut text) };
        told(status, path)?;
        if text.is_null() {
            return Ok(String::new());
        }
        // SAFETY: valid until the next call.
        Ok(unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
    }

    /// Reads words. `atomic`: of one moment, or `UL_MISMATCH`.
    pub(crate) fn read_words(
        &self,
        framed: bool,
        addresses: &[u32],
        words: &mut [u32],
        atomic: bool,
        how: &sys::ul_options,
        path: &'static str,
    ) -> Result<()> {
        let count = addresses.len();
        assert_eq!(count, words.len());
        let (at, to) = (addresses.as_ptr(), words.as_mut_ptr());
        // SAFETY: both have `count` words, here and below.
        let status = match count {
            0 => sys::UL_OK,
            1 => unsafe { sys::ul_read(self.raw(), addresses[0], to, how) },
            _ if framed => return self.transfer(&[], &[], addresses, words, atomic, how, path),
            _ => unsafe { sys::ul_read_many(self.raw(), at, count, to, atomic.into(), how) },
        };
        told(status, path)
    }

    pub(crate) fn write_words(
        &self,
        framed: bool,
        addresses: &[u32],
        words: &[u32],
        how: &sys::ul_options,
        path: &'static str,
    ) -> Result<()> {
        let count = addresses.len();
        assert_eq!(count, words.len());
        let (at, from) = (addresses.as_ptr(), words.as_ptr());
        let status = match count {
            0 => sys::UL_OK,
            1 => unsafe { sys::ul_write(self.raw(), addresses[0], words[0], how) },
            _ if framed => return self.transfer(addresses, words, &[], &mut [], false, how, path),
            _ => unsafe { sys::ul_write_many(self.raw(), at, from, count, how) },
        };
        told(status, path)
    }

    #[allow(clippy::too_many_arguments)]
    pub(crate) fn transfer(
        &self,
        write_addresses: &[u32],
        written: &[u32],
        addresses: &[u32],
        words: &mut [u32],
        atomic: bool,
        how: &sys::ul_options,
        path: &'static str,
    ) -> Result<()> {
        assert!(write_addresses.len() == written.len() && addresses.len() == words.len());
        let (writes, reads) = (written.len(), words.len());
        let (to, from) = (write_addresses.as_ptr(), written.as_ptr());
        let (at, into) = (addresses.as_ptr(), words.as_mut_ptr());
        let status =
            unsafe { sys::ul_transfer(self.raw(), to, from, writes, at, into, reads, atomic.into(), how) };
        told(status, path)
    }

    /// Names the words of an exchange. `None`: the device has no room for them.
    pub(crate) fn define_exchange(
        &self,
        outputs: &[sys::ul_exchange_word],
        inputs: &[sys::ul_exchange_word],
        path: &'static str,
    ) -> Result<Option<u32>> {
        let mut group = 0;
        let (out, read) = (outputs.as_ptr(), inputs.as_ptr());
        let status = unsafe {
            sys::ul_define_exchange(self.raw(), out, outputs.len(), read, inputs.len(), &mut group)
        };
        if status == sys::UL_MISMATCH {
            return Ok(None);
        }
        told(status, path)?;
        Ok(Some(group))
    }

    pub(crate) fn exchange(
        &self,
        group: u32,
        outputs: &[u32],
        inputs: &mut [u32],
        path: &'static str,
    ) -> Result<()> {
        let (out, read) = (outputs.as_ptr(), inputs.as_mut_ptr());
        let status = unsafe {
            sys::ul_exchange(self.raw(), group, out, outputs.len(), read, inputs.len(), ptr::null())
        };
        told(status, path)
    }

    pub(crate) fn release_exchange(&self, group: u32) {
        unsafe { sys::ul_release_exchange(self.raw(), group) };
    }

    pub(crate) fn subscribe(
        &self,
        addresses: &[u32],
        options: &sys::ul_subscription_options,
        path: &'static str,
    ) -> Result<u32> {
        let mut number = 0;
        let at = addresses.as_ptr();
        told(unsafe { sys::ul_subscribe(self.raw(), at, addresses.len(), options, &mut number) }, path)?;
        Ok(number)
    }

    pub(crate) fn unsubscribe(&self, subscription: u32) {
        unsafe { sys::ul_unsubscribe(self.raw(), subscription) };
    }

    /// Takes the oldest publish out, which has as many words as `words`. `None`: there is none.
    pub(crate) fn drain(&self, subscription: u32, words: &mut [u32], path: &'static str) -> Result<Option<f64>> {
        let (mut time_s, mut taken) = (0.0, 0);
        let to = words.as_mut_ptr();
        // SAFETY: one publish has the words that were subscribed, which are as many.
        told(unsafe { sys::ul_drain(self.raw(), subscription, &mut time_s, to, 1, &mut taken) }, path)?;
        Ok(if taken > 0 { Some(time_s) } else { None })
    }

    pub(crate) fn wait_publish(&self, subscription: u32, timeout: Duration, path: &'static str) -> Result<bool> {
        match unsafe { sys::ul_wait_publish(self.raw(), subscription, nanoseconds(timeout)) } {
            sys::UL_TIMEOUT => Ok(false),
            status => told(status, path).map(|()| true),
        }
    }

    /// Publishes that were overwritten, or lost on the line.
    pub(crate) fn lost(&self, subscription: u32) -> u64 {
        let (mut lost, mut missing) = (0, 0);
        unsafe {
            sys::ul_lost(self.raw(), subscription, &mut lost);
            sys::ul_missing(self.raw(), subscription, &mut missing);
        }
        lost + missing
    }
}
