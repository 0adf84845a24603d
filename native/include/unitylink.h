/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The C ABI of Unity-Link: the interface for C, and for every other language but Python.
 *
 *     ul_link* link;
 *     uint32_t value;
 *     if (ul_open("serial:/dev/ttyUSB0?baud=3000000", &link) != UL_OK) { puts(ul_last_error_text()); return 1; }
 *     if (ul_read(link, 0x20, &value, NULL) == UL_OK) printf("%08x\n", value);
 *     ul_free(link);
 *
 * A whole program is in examples/c_reader. docs/command-line.md describes link URLs and their options.
 * Threads: every function may be called from any thread at any time. Only ul_free must be the last call with its link.
 * After fork() the link belongs to the parent alone. The child makes no call with it, not even ul_free.
 * Errors: every function returns a ul_status and never throws. ul_last_error and ul_last_error_text tell what failed
 * and why. They hold the last failure of the calling thread. UL_ARGUMENT: a required pointer is NULL, or the size of a
 * struct is unknown. Structs: each has a member `size`, so that it can grow. Set it to sizeof of the struct you were
 * compiled with. A program and a library of different versions share the members that both know. Members that only the
 * program knows are 0 when it gets them. If it sets one, it is refused with UL_ARGUMENT.
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
  UL_TIMEOUT = 1,        /* no reply in time */
  UL_UNKNOWN = 2,        /* sent, but the reply was lost: it may or may not have been executed */
  UL_CLOSED = 3,         /* the port is closed, gone, or was unplugged */
  UL_BUSY = 4,           /* another program holds the port or the board */
  UL_NOT_FOUND = 5,      /* no such port, host or file */
  UL_PERMISSION = 6,     /* the operating system refuses the port */
  UL_BUS_ERROR = 7,      /* the device's bus refused or did not answer the address */
  UL_PROTOCOL_ERROR = 8, /* the device broke the protocol, or refused the command */
  UL_MISMATCH = 9,       /* the device cannot do what is asked */
  UL_RANGE = 10,         /* a value, address or count that cannot be sent; nothing was sent */
  UL_BAD_URL = 11,       /* a link URL that cannot be understood */
  UL_CANCELLED = 12,     /* another request of the same call failed: this one was not sent, or its read was given up */
  UL_ARGUMENT = 13,      /* a NULL pointer or a struct of unknown size */
  UL_NO_MEMORY = 14,
  UL_DENIED = 15,    /* the dead-man has tripped: no write is executed before ul_arm */
  UL_DOWN = 16,      /* reconnect=1: the line is gone and is being opened again; nothing was sent */
  UL_REFUSED = 17,   /* a server (serve:) does not let this client do that; nothing was sent to the board */
  UL_LEASE_HELD = 18 /* another client of the server has the write lease; nothing was sent to the board */
};

typedef struct ul_link ul_link;

/* Options of one call. NULL stands for the defaults below. */
typedef struct {
  uint32_t size;
  int32_t checked;     /* 1: with checksum, 0: without, -1: as the URL says (default) */
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
  uint32_t group_size; /* as advertised */
  uint32_t usable_group_size;
  uint32_t rate_bytes;
  uint32_t discovered; /* 1: told by the device, 0: by the URL */
  uint64_t base_hz;
} ul_configuration;

typedef struct {
  uint32_t size;
  uint32_t divisor;  /* publish every so many base periods; 0: not by time */
  uint32_t on_event; /* 1: publish when the group's event input says so */
  uint32_t verify; /* 1: read each address once first, because gateware of 2012 (the first published) repeats a publish
                      for ever if an address never answers */
  uint32_t ring;   /* publishes kept until they are drained; then the oldest are overwritten */
} ul_subscription_options;

typedef struct {
  uint32_t size;
  uint32_t reserved;
  uint64_t requests, replies, device_errors, retries, timeouts, fences, checksum_errors, malformed_messages,
      datalink_errors;
  uint64_t stale_replies, garbage_bytes, publishes, unclaimed_publishes, mismatched_publishes, overruns;
  uint64_t bytes_sent, bytes_received;
  uint64_t posts, missing_publishes, sessions; /* framed protocol */
  uint64_t restarts; /* framed: the device was reset, or another program used it: its outputs may differ from what was
                        written */
  uint64_t reconnections; /* reconnect=1: how often the line came back */
} ul_statistics;

typedef struct {
  uint32_t size;
  ul_status status;
  int32_t has_address;
  uint32_t address;    /* the word address of the failure */
  uint32_t index;      /* the request of a vector call that failed */
  uint32_t attempts;   /* how often the request was sent */
  uint64_t elapsed_ns; /* from the first attempt to the failure */
} ul_error;

/* The library's version, "0.1.0". */
UL_API const char* ul_version(void);
/* One sentence for a status; never NULL. */
UL_API const char* ul_status_text(ul_status status);
/* The last failure of the calling thread in words. Valid until its next failure. "" before the first. */
UL_API const char* ul_last_error_text(void);
/* The last failure of the calling thread in numbers. UL_ARGUMENT */
UL_API ul_status ul_last_error(ul_error* error);

/* Opens the port, resynchronises with the device and asks for its configuration. A connection (tcp) takes at most
 * attempts * timeout. The rest takes at most 4 * attempts * timeout, 0.2 s to leave a device, and the time of its bytes
 * on a slow line. UL_BAD_URL UL_NOT_FOUND UL_PERMISSION UL_BUSY UL_TIMEOUT UL_CLOSED UL_MISMATCH UL_PROTOCOL_ERROR
 * UL_ARGUMENT UL_NO_MEMORY */
UL_API ul_status ul_open(const char* url, ul_link** link);
/* Ends the link. A call that waits in another thread returns UL_CLOSED. The handle stays valid. Closing twice does
 * nothing. */
UL_API ul_status ul_close(ul_link* link);
/* Closes and frees. No other call with this link may be under way or follow. NULL is allowed. */
UL_API void ul_free(ul_link* link);

/* UL_ARGUMENT */
UL_API ul_status ul_get_configuration(ul_link* link, ul_configuration* configuration);
UL_API ul_status ul_get_statistics(ul_link* link, ul_statistics* statistics);

/* Waits until the link accepts requests. Returns at once, unless the line is gone and is being opened again
 * (reconnect=1 in the URL). UL_DOWN: it is not back within `timeout_ns`; ul_last_error_text says why. UL_CLOSED
 * UL_MISMATCH: the link has ended. */
UL_API ul_status ul_wait_up(ul_link* link, uint64_t timeout_ns);

/* Reads and writes one word. The errors of all requests are UL_TIMEOUT UL_CLOSED UL_DOWN UL_BUSY UL_BUS_ERROR
 * UL_PROTOCOL_ERROR UL_MISMATCH UL_RANGE UL_ARGUMENT UL_NO_MEMORY, and for writes also UL_UNKNOWN. Buffers belong to
 * the caller and are not used after the call has returned. */
UL_API ul_status ul_read(ul_link* link, uint32_t address, uint32_t* value, const ul_options* options);
UL_API ul_status ul_write(ul_link* link, uint32_t address, uint32_t value, const ul_options* options);
/* Reads words in as few messages as the device allows. `atomic` 1: in one message with the bus held, or UL_MISMATCH. */
UL_API ul_status ul_read_many(ul_link* link, const uint32_t* addresses, size_t count, uint32_t* values, int32_t atomic,
                              const ul_options* options);
/* Reads words with one request each. As many requests are under way as the buffers of the device allow. */
UL_API ul_status ul_read_each(ul_link* link, const uint32_t* addresses, size_t count, uint32_t* values,
                              const ul_options* options);
/* Writes words in order. After a failure no further word is sent, and ul_error.index says which one failed. */
UL_API ul_status ul_write_many(ul_link* link, const uint32_t* addresses, const uint32_t* values, size_t count,
                               const ul_options* options);

/* Which protocol the device speaks: "framed" or "classic"; "memory" behind mmap:, where there is none. Never NULL.
 * docs/protocol.md */
UL_API const char* ul_protocol(ul_link* link);
/* A warning if the link speaks the classic protocol although the URL does not ask for it. Then it has none of the
 * promises of the framed protocol. "": no warning. Never NULL. Valid as long as the link. ul_statistics.restarts shows
 * whether the device was reset since the link was opened. */
UL_API const char* ul_notice(ul_link* link);
/* Checks that the gateware was built from the spec whose wire hash is one of `hashes`. `spec` is its name in the error.
 * UL_MISMATCH: the gateware reports another hash, and the URL has no spec_hash=any. `unverified`, if not NULL, gets the
 * reason why this is not known or is overridden, and "" if it was verified. The text is valid until the next call, or
 * until the link is freed. */
UL_API ul_status ul_check_spec(ul_link* link, const char* spec, const uint64_t* hashes, size_t count,
                               const char** unverified);
/* Writes, then reads. Framed: in one message each way if the buffers of the device allow. Each is done once, or the
 * status is UL_UNKNOWN: the device was reset meanwhile. `atomic` 1: with the bus held from the first word to the last,
 * or UL_MISMATCH. */
UL_API ul_status ul_transfer(ul_link* link, const uint32_t* write_addresses, const uint32_t* write_values,
                             size_t writes, const uint32_t* addresses, uint32_t* values, size_t reads, int32_t atomic,
                             const ul_options* options);
/* Executes any operations, in order. Each read fills the next word of `values`, which has room for `room` words.
 * Framed: in one message if the buffers of the device allow, else in several that stay in order. `atomic` 1: in one
 * message with the bus held, or UL_MISMATCH. On a classic link: reads and writes, one after the other. */
enum {
  UL_READ = 0x01,
  UL_READ_FIFO = 0x03, /* like UL_READ, for many words of one address: the message names it once */
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
UL_API ul_status ul_list(ul_link* link, const ul_list_word* words, size_t count, uint32_t* values, size_t room,
                         int32_t atomic, const ul_options* options);
/* Writes without replies, in order, at the full rate of the line. The words of one call are sent together.
 * If one fails, those after it in its message are not executed. On a classic link these are ordinary writes. */
UL_API ul_status ul_post(ul_link* link, const uint32_t* addresses, const uint32_t* values, size_t count,
                         const ul_options* options);
/* Returns when all posts have been executed. UL_BUS_ERROR: some failed since the last call. UL_UNKNOWN: the device was
 * reset before it confirmed them. */
UL_API ul_status ul_sync(ul_link* link, const ul_options* options);
/* Reads `count` control registers of the device, from `address` on. UL_MISMATCH on a classic link, UL_PROTOCOL_ERROR if
 * there is no such register. */
UL_API ul_status ul_read_control(ul_link* link, uint32_t address, uint32_t* values, size_t count,
                                 const ul_options* options);
UL_API ul_status ul_write_control(ul_link* link, uint32_t address, uint32_t value, const ul_options* options);
/* Exchange groups: words are named once. Then only their data is sent, each in its own number of bytes (1 to
 * data_bytes). `group` stands for the words from then on, also after a reset of the device. UL_MISMATCH: the device has
 * no group left, or none so large. On a classic link the library keeps the group, and ul_exchange is writes and reads.
 */
typedef struct {
  uint32_t address;
  uint32_t bytes;
} ul_exchange_word;
UL_API ul_status ul_define_exchange(ul_link* link, const ul_exchange_word* outputs, size_t output_count,
                                    const ul_exchange_word* inputs, size_t input_count, uint32_t* group);
/* Writes all outputs, then reads all inputs, with the bus held, once. UL_UNKNOWN: the device was reset meanwhile. */
UL_API ul_status ul_exchange(ul_link* link, uint32_t group, const uint32_t* outputs, size_t output_count,
                             uint32_t* inputs, size_t input_count, const ul_options* options);
/* Frees the group. Twice does nothing. */
UL_API ul_status ul_release_exchange(ul_link* link, uint32_t group);
/* Sets the dead-man: after `silence_ns` without a sign of life from this program, the gateware makes the outputs safe.
 * Later writes get UL_DENIED. The library sends signs of life by itself. 0: never. UL_MISMATCH: the gateware has no
 * dead-man. */
UL_API ul_status ul_set_dead_man(ul_link* link, uint64_t silence_ns, const ul_options* options);
/* Allows writes again after the dead-man has tripped, and starts it again if this link had set it. If it tripped in the
 * open session, that session is ended and another begun. */
UL_API ul_status ul_arm(ul_link* link, const ul_options* options);
/* From now on the link gives the line up if ul_alive is not called for `patience_ns`. Then nothing is sent to the
 * device, and a running dead-man trips. So the dead-man also notices a program that hangs, not only a process that has
 * ended. With reconnect=1 the line comes back when ul_alive is called again, else the link ends. 0: never. UL_RANGE:
 * more than an hour. */
UL_API ul_status ul_watch_program(ul_link* link, uint64_t patience_ns);
/* Says that the program works. Does not lock, wait or allocate. */
UL_API void ul_alive(ul_link* link);

/* Lets the device publish the words at `addresses` together. `subscription` is the number of the subscription. No
 * number is used twice. Errors are those of requests. UL_MISMATCH also: no group is left, none is so large, or the line
 * is too slow. */
UL_API ul_status ul_subscribe(ul_link* link, const uint32_t* addresses, size_t count,
                              const ul_subscription_options* options, uint32_t* subscription);
/* Stops the publishes of a subscription. Those sent before can be drained until another subscription gets its group.
 * Twice does nothing. */
UL_API ul_status ul_unsubscribe(ul_link* link, uint32_t subscription);
/* Takes the oldest publishes out, up to `room`. `taken` says how many. Each has a time (s, CLOCK_MONOTONIC) and `count`
 * words, one publish after the other: `times_s` has room for `room` times, `values` for room * count words. */
UL_API ul_status ul_drain(ul_link* link, uint32_t subscription, double* times_s, uint32_t* values, size_t room,
                          size_t* taken);
/* UL_OK: something to drain. UL_TIMEOUT: nothing came in time. UL_CLOSED: link or subscription ended. */
UL_API ul_status ul_wait_publish(ul_link* link, uint32_t subscription, uint64_t timeout_ns);
/* Publishes overwritten before they were drained. */
UL_API ul_status ul_lost(ul_link* link, uint32_t subscription, uint64_t* lost);
/* Publishes lost on the line. Always 0 on a classic link, which cannot tell. */
UL_API ul_status ul_missing(ul_link* link, uint32_t subscription, uint64_t* missing);

#ifdef __cplusplus
}
#endif

#endif
