// SPDX-License-Identifier: BSD-3-Clause
// What this process has open, to find what a test has not closed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace unitylink::test {

inline std::size_t open_files() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

// The number of mappings of this file.
inline std::size_t mappings_of(const std::string& path) {
  std::ifstream maps("/proc/self/maps");
  std::size_t found = 0;
  for (std::string line; std::getline(maps, line);) {
    found += line.find(path) != std::string::npos ? 1 : 0;
  }
  return found;
}

}  // namespace unitylink::test
