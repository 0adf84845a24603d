// SPDX-License-Identifier: BSD-3-Clause
// The schemes of link URLs. A scheme is the word before the colon. Each is one row of the table in schemes.cpp, and one
// driver, which the row opens. The parsing of URLs and options, error messages, Python's `connect` and the help of the
// commands use the rows.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "layer0_driver/status.hpp"

namespace unitylink {

class Driver;
struct Url;

// How long opening may take, and what ends it early.
struct Patience {
  std::uint64_t timeout_ns = 0;
  int cancelled = -1;  // a descriptor: when it becomes readable, opening ends with closed. -1: never
};

// Opens what the URL names. Errors: bad_url, not_found, permission, busy, mismatch, timeout and closed.
using Opener = Outcome(const Url& url, const Patience& patience, std::unique_ptr<Driver>& driver);

// What stands between the colon and the options.
enum class Place : std::uint8_t {
  file,    // a device file
  name,    // a name, or nothing
  host,    // //host:port
  board,   // //host:port/NAME, or without /NAME
  number,  // a descriptor
};

struct Scheme {
  std::string_view name;
  std::string_view form;  // an example of its URLs
  std::string_view what;  // what it is a link to, in a few words
  Place place = Place::file;
  // the scheme's own options, with spaces between them; layer2_message/link_options.cpp has those of every link
  std::string_view options = {};
  Opener* open = nullptr;
  // it carries bytes; false: it is memory of this machine, so the options of the protocols are refused
  bool stream = true;
  bool once = false;         // cannot be opened a second time
  bool framed_only = false;  // cannot carry the text of the classic protocol
  bool loses_order = false;  // bytes may arrive in another order, or twice, so every frame gets the longer checksum

  // The words of `options`.
  [[nodiscard]] std::vector<std::string_view> option_names() const;
  // Whether `options` has this word.
  [[nodiscard]] bool takes(std::string_view option) const;
};

// All rows, in the order of messages and help texts.
[[nodiscard]] const std::vector<const Scheme*>& schemes();
// nullptr: there is no scheme of this name.
[[nodiscard]] const Scheme* find_scheme(std::string_view name);

// Adds a row from outside the core, for a program that is linked with it. Make it before the first link is opened.
// `scheme` must not be destroyed.
//   const Scheme loop{.name = "loop", .form = "loop:", .what = "a wire back", .place = Place::name,
//                     .open = &open_loop};
//   const AddedScheme added(loop);
struct AddedScheme {
  explicit AddedScheme(const Scheme& scheme);
};

}  // namespace unitylink
