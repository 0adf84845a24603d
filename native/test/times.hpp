// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace unitylink::test {

inline constexpr std::uint64_t ms = 1'000'000;  // ns

}  // namespace unitylink::test
