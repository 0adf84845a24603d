// SPDX-License-Identifier: BSD-3-Clause
// Structs of the C ABI that grow. Each begins with `size`, which the caller sets to the size that it was compiled with.
// So a program and a library of different versions share the members that both know.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "unitylink.h"

namespace unitylink::abi {

// The size of a struct in the first version that had it.
template <class Struct>
inline constexpr std::uint32_t first_size = sizeof(Struct);
template <>
inline constexpr std::uint32_t first_size<ul_statistics> = offsetof(ul_statistics, posts);

// A larger `size` was never set: it is what the memory held before.
inline constexpr std::uint32_t largest_size = 4096;

template <class Struct>
bool known(const Struct* given) {
  return given != nullptr && given->size >= first_size<Struct> && given->size <= largest_size;
}

// Fills in the members that both know. Those that only a newer caller knows become 0.
template <class Struct>
void give(Struct* given, Struct ours) {
  ours.size = given->size;
  auto* to = reinterpret_cast<unsigned char*>(given);
  const std::size_t shared = std::min<std::size_t>(ours.size, sizeof ours);
  std::memset(to + shared, 0, ours.size - shared);
  std::memcpy(to, &ours, shared);
}

// Takes the members that both know into `ours`, whose others keep their defaults. False: the struct is not known, or a
// newer caller asks for what this version does not have.
template <class Struct>
bool take(const Struct* given, Struct& ours) {
  if (!known(given)) {
    return false;
  }
  const auto* from = reinterpret_cast<const unsigned char*>(given);
  const std::size_t shared = std::min<std::size_t>(given->size, sizeof ours);
  std::memcpy(&ours, from, shared);
  return std::all_of(from + shared, from + given->size, [](unsigned char byte) { return byte == 0; });
}

}  // namespace unitylink::abi
