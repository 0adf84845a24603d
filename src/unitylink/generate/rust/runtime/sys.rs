// SPDX-License-Identifier: BSD-3-Clause

//! The C ABI of Unity-Link (unitylink.h), as it is. `tools/rust_sys.py` makes this from the header.
//! The crate `unitylink` has the same without `unsafe`.

#![allow(non_camel_case_types)]

use std::os::raw::c_char;

/// What a call gives.
pub type ul_status = i32;

pub mod status {
    pub const UL_OK: super::ul_status = 0;
    pub const UL_TIMEOUT: super::ul_status = 1;
    pub const UL_UNKNOWN: super::ul_status = 2;
    pub const UL_CLOSED: super::ul_status = 3;
    pub const UL_BUSY: super::ul_status = 4;
    pub const UL_NOT_FOUND: super::ul_status = 5;
    pub const UL_PERMISSION: super::ul_status = 6;
    pub const UL_BUS_ERROR: super::ul_status = 7;
    pub const UL_PROTOCOL_ERROR: super::ul_status = 8;
    pub const UL_MISMATCH: super::ul_status = 9;
    pub const UL_RANGE: super::ul_status = 10;
    pub const UL_BAD_URL: super::ul_status = 11;
    pub const UL_CANCELLED: super::ul_status = 12;
    pub const UL_ARGUMENT: super::ul_status = 13;
    pub const UL_NO_MEMORY: super::ul_status = 14;
    pub const UL_DENIED: super::ul_status = 15;
    pub const UL_DOWN: super::ul_status = 16;
    pub const UL_REFUSED: super::ul_status = 17;
    pub const UL_LEASE_HELD: super::ul_status = 18;
}
pub use status::*;

pub const UL_READ: u32 = 0x01;
pub const UL_READ_FIFO: u32 = 0x03;
pub const UL_WRITE: u32 = 0x11;
pub const UL_WRITE_FIFO: u32 = 0x13;
pub const UL_WRITE_MASKED: u32 = 0x14;
pub const UL_ADD: u32 = 0x15;

#[repr(C)]
pub struct ul_link {
    _private: [u8; 0],
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_options {
    pub size: u32,
    pub checked: i32,
    pub repeat: i32,
    pub reserved: u32,
    pub timeout_ns: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_configuration {
    pub size: u32,
    pub address_bytes: u32,
    pub data_bytes: u32,
    pub read_many: u32,
    pub publish_mode: u32,
    pub groups: u32,
    pub group_size: u32,
    pub usable_group_size: u32,
    pub rate_bytes: u32,
    pub discovered: u32,
    pub base_hz: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_subscription_options {
    pub size: u32,
    pub divisor: u32,
    pub on_event: u32,
    pub verify: u32,
    pub ring: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_statistics {
    pub size: u32,
    pub reserved: u32,
    pub requests: u64,
    pub replies: u64,
    pub device_errors: u64,
    pub retries: u64,
    pub timeouts: u64,
    pub fences: u64,
    pub checksum_errors: u64,
    pub malformed_messages: u64,
    pub datalink_errors: u64,
    pub stale_replies: u64,
    pub garbage_bytes: u64,
    pub publishes: u64,
    pub unclaimed_publishes: u64,
    pub mismatched_publishes: u64,
    pub overruns: u64,
    pub bytes_sent: u64,
    pub bytes_received: u64,
    pub posts: u64,
    pub missing_publishes: u64,
    pub sessions: u64,
    pub restarts: u64,
    pub reconnections: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_error {
    pub size: u32,
    pub status: ul_status,
    pub has_address: i32,
    pub address: u32,
    pub index: u32,
    pub attempts: u32,
    pub elapsed_ns: u64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_list_word {
    pub operation: u32,
    pub address: u32,
    pub value: u32,
    pub mask: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ul_exchange_word {
    pub address: u32,
    pub bytes: u32,
}

extern "C" {
    pub fn ul_version() -> *const c_char;
    pub fn ul_status_text(status: ul_status) -> *const c_char;
    pub fn ul_last_error_text() -> *const c_char;
    pub fn ul_last_error(error: *mut ul_error) -> ul_status;
    pub fn ul_open(url: *const c_char, link: *mut *mut ul_link) -> ul_status;
    pub fn ul_close(link: *mut ul_link) -> ul_status;
    pub fn ul_free(link: *mut ul_link);
    pub fn ul_get_configuration(link: *mut ul_link, configuration: *mut ul_configuration) -> ul_status;
    pub fn ul_get_statistics(link: *mut ul_link, statistics: *mut ul_statistics) -> ul_status;
    pub fn ul_wait_up(link: *mut ul_link, timeout_ns: u64) -> ul_status;
    pub fn ul_read(link: *mut ul_link, address: u32, value: *mut u32, options: *const ul_options) -> ul_status;
    pub fn ul_write(link: *mut ul_link, address: u32, value: u32, options: *const ul_options) -> ul_status;
    pub fn ul_read_many(link: *mut ul_link, addresses: *const u32, count: usize, values: *mut u32, atomic: i32, options: *const ul_options) -> ul_status;
    pub fn ul_read_each(link: *mut ul_link, addresses: *const u32, count: usize, values: *mut u32, options: *const ul_options) -> ul_status;
    pub fn ul_write_many(link: *mut ul_link, addresses: *const u32, values: *const u32, count: usize, options: *const ul_options) -> ul_status;
    pub fn ul_protocol(link: *mut ul_link) -> *const c_char;
    pub fn ul_notice(link: *mut ul_link) -> *const c_char;
    pub fn ul_check_spec(link: *mut ul_link, spec: *const c_char, hashes: *const u64, count: usize, unverified: *mut *const c_char) -> ul_status;
    pub fn ul_transfer(link: *mut ul_link, write_addresses: *const u32, write_values: *const u32, writes: usize, addresses: *const u32, values: *mut u32, reads: usize, atomic: i32, options: *const ul_options) -> ul_status;
    pub fn ul_list(link: *mut ul_link, words: *const ul_list_word, count: usize, values: *mut u32, room: usize, atomic: i32, options: *const ul_options) -> ul_status;
    pub fn ul_post(link: *mut ul_link, addresses: *const u32, values: *const u32, count: usize, options: *const ul_options) -> ul_status;
    pub fn ul_sync(link: *mut ul_link, options: *const ul_options) -> ul_status;
    pub fn ul_read_control(link: *mut ul_link, address: u32, values: *mut u32, count: usize, options: *const ul_options) -> ul_status;
    pub fn ul_write_control(link: *mut ul_link, address: u32, value: u32, options: *const ul_options) -> ul_status;
    pub fn ul_define_exchange(link: *mut ul_link, outputs: *const ul_exchange_word, output_count: usize, inputs: *const ul_exchange_word, input_count: usize, group: *mut u32) -> ul_status;
    pub fn ul_exchange(link: *mut ul_link, group: u32, outputs: *const u32, output_count: usize, inputs: *mut u32, input_count: usize, options: *const ul_options) -> ul_status;
    pub fn ul_release_exchange(link: *mut ul_link, group: u32) -> ul_status;
    pub fn ul_set_dead_man(link: *mut ul_link, silence_ns: u64, options: *const ul_options) -> ul_status;
    pub fn ul_arm(link: *mut ul_link, options: *const ul_options) -> ul_status;
    pub fn ul_watch_program(link: *mut ul_link, patience_ns: u64) -> ul_status;
    pub fn ul_alive(link: *mut ul_link);
    pub fn ul_subscribe(link: *mut ul_link, addresses: *const u32, count: usize, options: *const ul_subscription_options, subscription: *mut u32) -> ul_status;
    pub fn ul_unsubscribe(link: *mut ul_link, subscription: u32) -> ul_status;
    pub fn ul_drain(link: *mut ul_link, subscription: u32, times_s: *mut f64, values: *mut u32, room: usize, taken: *mut usize) -> ul_status;
    pub fn ul_wait_publish(link: *mut ul_link, subscription: u32, timeout_ns: u64) -> ul_status;
    pub fn ul_lost(link: *mut ul_link, subscription: u32, lost: *mut u64) -> ul_status;
    pub fn ul_missing(link: *mut ul_link, subscription: u32, missing: *mut u64) -> ul_status;
}
