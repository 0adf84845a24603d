// SPDX-License-Identifier: BSD-3-Clause
// The number of bytes in a payload before its words, for each kind of frame (docs/protocol.md, sections 3 to 6).
#pragma once

#include <cstddef>

namespace unitylink::frame_head {

inline constexpr std::size_t reply = 4;                // id, posts
inline constexpr std::size_t list_reply = 6;           // id, posts, done
inline constexpr std::size_t publish = 7;              // group, sequence, clock
inline constexpr std::size_t list = 5;                 // id, the post number of a barrier, flags
inline constexpr std::size_t operation = 2;            // of a list: operation and count
inline constexpr std::size_t group_definition = 9;     // id, group, divisor, flags, count
inline constexpr std::size_t exchange_definition = 5;  // id, group, two counts
inline constexpr std::size_t exchange = 5;             // id, the post number of a barrier, group

}  // namespace unitylink::frame_head
