// SPDX-License-Identifier: BSD-3-Clause
// The schemes of link URLs: what may stand before the colon. A scheme is one row of the table in schemes.cpp, and one
// driver, which the row opens. URLs, options, error messages, Python's `connect` and the help of the commands go by the
// rows.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "layer0_driver/status.hpp"

namespace unitylink {

class Driver;
struct Url;

// How long opening may take.
struct Patience {
  std::uint64_t timeout_ns = 0;
  int cancelled = -1;  // a descriptor: opening ends with closed as soon as it is readable. -1: never
};

// Opens what the URL names; the errors are bad_url, not_found, permission, busy, mismatch, timeout and closed.
using Opener = Outcome(const Url& url, const Patience& patience, std::unique_ptr<Driver>& driver);

// What stands between the colon and the options.
enum class Place : std::uint8_t {
  file,    // a device file
  name,    // a name, or nothing
  host,    // //host:port
  number,  // a descriptor
};

struct Scheme {
  std::string_view name;
  std::string_view form;  // an example of its URLs
  std::string_view what;  // where it leads, in a few words
  Place place = Place::file;
  // its own, with a space between two; those of every link are in layer2_message/link_options.cpp
  std::string_view options = {};
  Opener* open = nullptr;
  // bytes go there; else it is memory of this machine, and an option of a protocol means nothing
  bool stream = true;
  bool once = false;         // cannot be opened a second time
  bool framed_only = false;  // carries no classic text
  bool loses_order = false;  // bytes may come in another order, or twice: every frame gets the longer checksum

  // `options`, one by one.
  [[nodiscard]] std::vector<std::string_view> option_names() const;
  // Whether an option is the scheme's own.
  [[nodiscard]] bool takes(std::string_view option) const;
};

// All rows, in the order in which they are told.
[[nodiscard]] const std::vector<const Scheme*>& schemes();
// nullptr: there is none of this name.
[[nodiscard]] const Scheme* find_scheme(std::string_view name);

// A row from outside of the core, for a program that is linked with it. To be made before the first link is opened;
// `scheme` must stay:
//   const Scheme loop{.name = "loop", .form = "loop:", .what = "a wire back", .place = Place::name,
//                     .open = &open_loop};
//   const AddedScheme added(loop);
struct AddedScheme {
  explicit AddedScheme(const Scheme& scheme);
};

}  // namespace unitylink
