/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The C ABI of Unity-Link: the contract for every language but Python.
 *
 *     ul_link* link;
 *     uint32_t value;
 *     if (ul_open("serial:/dev/ttyUSB0?baud=3000000", &link) != UL_OK) { puts(ul_last_error_text()); return 1; }
 *     if (ul_read(link, 0x20, &value, NULL) == UL_OK) printf("%08x\n", value);
 *     ul_free(link);
 *
 * A whole program: examples/c_reader. Link URLs and their options: docs/command-line.md.
 * Threads: every function may be called from any thread at any time, except ul_free, which must be the last call with its link.
 * After fork() a link is the parent's alone: the child makes no call with it, not even ul_free.
 * Errors: every function returns a ul_status and never throws; what failed and why is told, per thread, by ul_last_error and
 * ul_last_error_text, until that thread's next failure. UL_ARGUMENT: a required pointer is NULL or a struct's size unknown.
 * Structs carry their own size, so that they can grow: set it to sizeof of the struct you were compiled with.
 */
#ifndef UNITYLINK_H
#define UNITYLINK_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define UL_API
#else
#define UL_API __attribute__((visibility("default")))
#endif

typedef int32_t ul_status;
enum {
  UL_OK = 0,
  UL_TIMEOUT = 1,        /* the device did not answer in time */
  UL_UNKNOWN = 2,        /* sent, answer lost: it may or may not have been executed */
  UL_CLOSED = 3,         /* the port is closed, gone, or was unplugged */
  UL_BUSY = 4,           /* another program holds the port or the board */
  UL_NOT_FOUND = 5,      /* no such port, host or file */
  UL_PERMISSION = 6,     /* the operating system refuses the port */
  UL_BUS_ERROR = 7,      /* the device's bus refused or did not answer the address */
  UL_PROTOCOL_ERROR = 8, /* the device answered outside the protocol, or refused the command */
  UL_MISMATCH = 9,       /* the device cannot do what is asked */
  UL_RANGE = 10,         /* a value, address or count that cannot be sent; nothing was */
  UL_BAD_URL = 11,       /* a link URL that cannot be understood */
  UL_CANCELLED = 12,     /* not sent, or a read given up, because another request of the same call failed */
  UL_ARGUMENT = 13,      /* a NULL pointer or a struct of unknown size */
  UL_NO_MEMORY = 14,
  UL_DENIED = 15,        /* the dead-man has tripped: nothing is written before ul_arm */
  UL_DOWN = 16           /* reconnect=1: the line is gone and is being opened again; nothing was sent */
};

typedef struct ul_link ul_link;

/* How one call asks. NULL in its place: the defaults below. */
typedef struct {
  uint32_t size;
  int32_t checked;     /* 1 with checksum, 0 without, -1 as the URL says (default) */
  int32_t repeat;      /* 1: sending it twice does no harm. Default: 1 for reads, 0 for writes */
  uint32_t reserved;   /* 0 */
  uint64_t timeout_ns; /* per attempt; 0: as the URL says (default) */
} ul_options;

typedef struct {
  uint32_t size;
  uint32_t address_bytes;
  uint32_t data_bytes;
  uint32_t read_many;    /* words in one message, 0: none */
  uint32_t publish_mode; /* 0 none, 1 requests first, 2 publishes first */
  uint32_t groups;
  uint32_t group_size;   /* as advertised */
  uint32_t usable_group_size;
  uint32_t rate_bytes;
  uint32_t discovered;   /* 1: told by the device, 0: by the URL */
  uint64_t base_hz;
} ul_configuration;

typedef struct {
  uint32_t size;
  uint32_t divisor;  /* publish every so many base periods; 0: not by time */
  uint32_t on_event; /* 1: publish when the group's event input says so */
  uint32_t verify;   /* 1: read every address once before; 2012 gateware publishes a silent one for ever */
  uint32_t ring;     /* publishes kept until drained; then the newest win */
} ul_subscription_options;

typedef struct {
  uint32_t size;
  uint32_t reserved;
  uint64_t requests, replies, device_errors, retries, timeouts, fences, checksum_errors, malformed_messages, datalink_errors;
  uint64_t stale_replies, garbage_bytes, publishes, unclaimed_publishes, mismatched_publishes, overruns;
  uint64_t bytes_sent, bytes_received;
  uint64_t posts, missing_publishes, sessions; /* of the framed protocol; left out where size ends before them */
  uint64_t restarts;      /* framed: the device was reset, or another program has had it: its outputs are its own */
  uint64_t reconnections; /* reconnect=1: the line was gone, and is back */
} ul_statistics;

typedef struct {
  uint32_t size;
  ul_status status;
  int32_t has_address;
  uint32_t address;    /* the word address it was about */
  uint32_t index;      /* which request of a vector call */
  uint32_t attempts;   /* how often an answer was asked for */
  uint64_t elapsed_ns; /* from the first attempt to the verdict */
} ul_error;

/* The library's version, "0.1.0". */
UL_API const char* ul_version(void);
/* One sentence for a status; never NULL. */
UL_API const char* ul_status_text(ul_status status);
/* The calling thread's last failure in words; valid until its next failure; "" before the first. */
UL_API const char* ul_last_error_text(void);
/* The same in numbers. UL_ARGUMENT. */
UL_API ul_status ul_last_error(ul_error* error);

/* Opens the port, resynchronises with the device and asks for its configuration. Blocks at most 2 * attempts * timeout, one more for tcp.
 * UL_BAD_URL UL_NOT_FOUND UL_PERMISSION UL_BUSY UL_TIMEOUT UL_CLOSED UL_MISMATCH UL_PROTOCOL_ERROR UL_ARGUMENT UL_NO_MEMORY */
UL_API ul_status ul_open(const char* url, ul_link** link);
/* Ends the link: whoever waits in another thread gets UL_CLOSED. The handle stays valid. Closing twice does nothing. */
UL_API ul_status ul_close(ul_link* link);
/* Closes and frees. No other call with this link may be under way or follow. NULL is allowed. */
UL_API void ul_free(ul_link* link);

/* UL_ARGUMENT */
UL_API ul_status ul_get_configuration(ul_link* link, ul_configuration* configuration);
UL_API ul_status ul_get_statistics(ul_link* link, ul_statistics* statistics);

/* Until requests are taken: at once, unless the line is gone and is being opened again (reconnect=1 in the URL). UL_DOWN: not within
 * `timeout_ns`; ul_last_error_text says why. UL_CLOSED UL_MISMATCH: it has ended. */
UL_API ul_status ul_wait_up(ul_link* link, uint64_t timeout_ns);

/* All requests: UL_TIMEOUT UL_CLOSED UL_DOWN UL_BUSY UL_BUS_ERROR UL_PROTOCOL_ERROR UL_MISMATCH UL_RANGE UL_ARGUMENT UL_NO_MEMORY;
 * writes also UL_UNKNOWN. Buffers are the caller's and are not used after the call has returned. */
UL_API ul_status ul_read(ul_link* link, uint32_t address, uint32_t* value, const ul_options* options);
UL_API ul_status ul_write(ul_link* link, uint32_t address, uint32_t value, const ul_options* options);
/* In as few messages as the device allows; `atomic` 1: in one, read under one bus lock, or UL_MISMATCH. */
UL_API ul_status ul_read_many(ul_link* link, const uint32_t* addresses, size_t count, uint32_t* values, int32_t atomic,
                              const ul_options* options);
/* One request each, as many on their way as the device's buffers allow. */
UL_API ul_status ul_read_each(ul_link* link, const uint32_t* addresses, size_t count, uint32_t* values, const ul_options* options);
/* In order; after one has failed no further one is sent, and ul_error.index says which. */
UL_API ul_status ul_write_many(ul_link* link, const uint32_t* addresses, const uint32_t* values, size_t count,
                               const ul_options* options);

/* Which protocol the device speaks: "framed" or "classic". Never NULL. docs/protocol.md */
UL_API const char* ul_protocol(ul_link* link);
/* What a user has to know of how the link has begun: that it was taken for a classic one, without the promises of frames, because the device answers classic questions only.
 * "": nothing, as where the URL says protocol=classic. Never NULL; valid as long as the link. That the device was reset since is in ul_statistics.restarts. */
UL_API const char* ul_notice(ul_link* link);
/* Was the gateware built from `spec` (what the error calls it), whose wire hash is one of `hashes`? UL_MISMATCH: it says that it was not, and the URL has no
 * spec_hash=any. `unverified`, if not NULL, gets why that is not known, or is overridden: "" where it was; until the next call, or the link is freed. */
UL_API ul_status ul_check_spec(ul_link* link, const char* spec, const uint64_t* hashes, size_t count, const char** unverified);
/* Writes, then reads; framed: in one message each way where the device's buffers allow. Each is done once, or the status is UL_UNKNOWN: the
 * device was reset meanwhile. `atomic` 1: with the bus held from the first word to the last, or UL_MISMATCH. */
UL_API ul_status ul_transfer(ul_link* link, const uint32_t* write_addresses, const uint32_t* write_values, size_t writes,
                             const uint32_t* addresses, uint32_t* values, size_t reads, int32_t atomic, const ul_options* options);
/* Any operations, in order. Each read gives the next of `values`, which has room for `room` words. Framed: in one message where the device's buffers allow, else in
 * several that stay in order; `atomic` 1: in one, with the bus held, or UL_MISMATCH. On a classic link: reads and writes, one after the other. */
enum {
  UL_READ = 0x01,
  UL_READ_FIFO = 0x03,    /* like UL_READ; the same address again and again is named once */
  UL_WRITE = 0x11,
  UL_WRITE_FIFO = 0x13,
  UL_WRITE_MASKED = 0x14, /* word := old and not mask, or value and mask */
  UL_ADD = 0x15           /* word := old + value */
};
typedef struct {
  uint32_t operation;
  uint32_t address;
  uint32_t value;
  uint32_t mask;
} ul_list_word;
UL_API ul_status ul_list(ul_link* link, const ul_list_word* words, size_t count, uint32_t* values, size_t room, int32_t atomic,
                         const ul_options* options);
/* Writes without answers, in order, at the full rate of the line. The words of one call go out together:
 * where one fails, those behind it in its message are not executed. On a classic link they are ordinary writes. */
UL_API ul_status ul_post(ul_link* link, const uint32_t* addresses, const uint32_t* values, size_t count, const ul_options* options);
/* Returns when all posts have been executed. UL_BUS_ERROR: some failed since the last call. UL_UNKNOWN: the device was reset before it had
 * confirmed them. */
UL_API ul_status ul_sync(ul_link* link, const ul_options* options);
/* The device's own registers, `count` from `address` on. UL_MISMATCH on a classic link, UL_PROTOCOL_ERROR where there is none. */
UL_API ul_status ul_read_control(ul_link* link, uint32_t address, uint32_t* values, size_t count, const ul_options* options);
UL_API ul_status ul_write_control(ul_link* link, uint32_t address, uint32_t value, const ul_options* options);
/* Exchange groups: words named once, which then travel as bare data, each in its own number of bytes (1 to data_bytes). `group` stands for
 * the words from then on, also after the device was reset. UL_MISMATCH where it has no group left, or none so large. On a classic link it is kept here,
 * and ul_exchange is writes and reads. */
typedef struct {
  uint32_t address;
  uint32_t bytes;
} ul_exchange_word;
UL_API ul_status ul_define_exchange(ul_link* link, const ul_exchange_word* outputs, size_t output_count, const ul_exchange_word* inputs,
                                    size_t input_count, uint32_t* group);
/* Writes all outputs, then reads all inputs, with the bus held, once; or UL_UNKNOWN: the device was reset meanwhile. */
UL_API ul_status ul_exchange(ul_link* link, uint32_t group, const uint32_t* outputs, size_t output_count, uint32_t* inputs,
                             size_t input_count, const ul_options* options);
/* Frees the group. Twice does nothing. */
UL_API ul_status ul_release_exchange(ul_link* link, uint32_t group);
/* From now on `silence_ns` without a sign of life from this program make the outputs safe (UL_DENIED for what is written then); the library
 * gives such signs by itself. 0: never. UL_MISMATCH where the gateware has no dead-man. */
UL_API ul_status ul_set_dead_man(ul_link* link, uint64_t silence_ns, const ul_options* options);
/* Lets outputs be written again after the dead-man has tripped, and starts it again if this link had set it. Where it tripped in the session that is open, that
 * session is ended and another begun. */
UL_API ul_status ul_arm(ul_link* link, const ul_options* options);
/* From now on the line is given up where ul_alive is not called for `patience_ns`: then nothing goes to the device, and a dead-man that runs trips. So it tells that the
 * program works, not only that its process lives. With reconnect=1 the line comes back when ul_alive is called again, else the link ends. 0: never.
 * UL_RANGE: more than an hour. */
UL_API ul_status ul_watch_program(ul_link* link, uint64_t patience_ns);
/* The program works. Neither locks, waits nor allocates. */
UL_API void ul_alive(ul_link* link);

/* The words at `addresses` together, published by the device. `subscription` names it from then on; the number never comes back.
 * Errors as requests; UL_MISMATCH also when no group is left, none is so large, or the line too slow. */
UL_API ul_status ul_subscribe(ul_link* link, const uint32_t* addresses, size_t count, const ul_subscription_options* options,
                              uint32_t* subscription);
/* Stops its publishes. What the device sent before it stopped can be drained until another subscription gets its group. Twice does nothing. */
UL_API ul_status ul_unsubscribe(ul_link* link, uint32_t subscription);
/* Takes the oldest publishes out, as many as there are up to `room`; `taken` says how many. For each a time (s, CLOCK_MONOTONIC) and
 * `count` words, one publish after the other: `times_s` has room for `room`, `values` for room * count of them. */
UL_API ul_status ul_drain(ul_link* link, uint32_t subscription, double* times_s, uint32_t* values, size_t room, size_t* taken);
/* UL_OK: something to drain. UL_TIMEOUT: nothing came in time. UL_CLOSED: link or subscription ended. */
UL_API ul_status ul_wait_publish(ul_link* link, uint32_t subscription, uint64_t timeout_ns);
/* Publishes overwritten before they were drained. */
UL_API ul_status ul_lost(ul_link* link, uint32_t subscription, uint64_t* lost);
/* Publishes lost on the way; always 0 on a classic link, where nothing tells. */
UL_API ul_status ul_missing(ul_link* link, uint32_t subscription, uint64_t* missing);

#ifdef __cplusplus
}
#endif

#endif
