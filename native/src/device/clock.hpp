// SPDX-License-Identifier: BSD-3-Clause
// The device clock: every time in this folder is a count of clock cycles since reset.
#pragma once

#include <cstdint>
#include <limits>

namespace unitylink::device {

using Clock = std::uint64_t;
inline constexpr Clock never = std::numeric_limits<Clock>::max();

// Delays of the 2012 gateware, in clock cycles, taken from recorded simulations (docs/classic-protocol.md, timing).
namespace timing {
inline constexpr Clock receive_character = 3;  // a letter or framing character in the datalink receiver
inline constexpr Clock receive_first_digit = 2;
inline constexpr Clock receive_second_digit = 3;
inline constexpr Clock receive_separator = 2;
inline constexpr Clock receive_skipped = 3;    // a byte between messages
inline constexpr Clock receive_misplaced = 2;  // a framing character that caused a datalink error
inline constexpr Clock receive_invalid = 5;    // any other byte that caused a datalink error
inline constexpr Clock physical_error = 2;     // error of the physical layer -> datalink error
inline constexpr Clock checksum_verdict = 1;   // more for a checked message
inline constexpr Clock message_ready = 3;      // end of message taken -> the application may start
// end of a request -> its message buffer is free, and the other is in use
inline constexpr Clock buffer_swap = 1;
inline constexpr Clock reply_head = 2;        // start of the application -> head in the transmit FIFO
inline constexpr Clock bus_cycle = 3;         // request -> acknowledged, one wait state
inline constexpr Clock publish_decision = 5;  // strobe or event -> the application may start
inline constexpr Clock transmit_latency = 4;  // word in the transmit FIFO -> first character out
inline constexpr Clock transmit_character = 2;
inline constexpr Clock error_latency = 7;          // datalink error -> '?' out
inline constexpr std::size_t transmit_words = 17;  // application FIFO (16) and the register behind it
inline constexpr std::size_t error_codes = 4;
}  // namespace timing

}  // namespace unitylink::device
