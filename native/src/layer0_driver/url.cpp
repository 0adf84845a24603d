// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/url.hpp"

#include <charconv>

namespace unitylink {
namespace {

std::string expected() {
  std::string forms;
  for (const Scheme* scheme : schemes()) {
    forms += (forms.empty() ? "" : scheme == schemes().back() ? " or " : ", ") + std::string(scheme->form);
  }
  return "expected " + forms + ", each with ?option=value&… behind it";
}

Outcome wrong(std::string_view text, const std::string& why) {
  return {Status::bad_url, "link URL '" + std::string(text) + "': " + why};
}

// Replaces %41 by A, as in every URL, so that a file name can contain an &. False: a % has no two hex digits after it,
// or stands for a NUL.
bool unescape(std::string_view text, std::string& plain) {
  plain.clear();
  for (std::size_t index = 0; index < text.size(); ++index) {
    char character = text[index];
    if (character == '%') {
      unsigned code = 0;
      const char* const begin = text.data() + index + 1;
      const char* const end = text.size() - index > 2 ? begin + 2 : begin;
      if (std::from_chars(begin, end, code, 16).ptr != begin + 2 || code == 0) {
        return false;
      }
      character = static_cast<char>(code);
      index += 2;
    }
    plain.push_back(character);
  }
  return true;
}

Outcome split_options(std::string_view text, std::string_view query, Url& url) {
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view item = query.substr(0, end);
    query = end == std::string_view::npos ? std::string_view{} : query.substr(end + 1);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == item.size()) {
      return wrong(text, "'" + std::string(item) + "' is not option=value");
    }
    const std::string name(item.substr(0, equals));
    if (url.option(name) != nullptr) {
      return wrong(text, "option '" + name + "' is given twice");
    }
    std::string value;
    if (!unescape(item.substr(equals + 1), value)) {
      return wrong(text, "option '" + name + "': a % needs two hex digits behind it (%25 is %)");
    }
    url.options.emplace_back(name, std::move(value));
  }
  return {};
}

Outcome split_host(std::string_view text, std::string_view place, Url& url) {
  if (!place.starts_with("//")) {
    return wrong(text, url.scheme + ": needs '//' before the host, as in " + url.scheme + "://127.0.0.1:5555");
  }
  place.remove_prefix(2);
  if (const std::size_t slash = place.find('/'); url.row->place == Place::board && slash != std::string_view::npos) {
    url.path = place.substr(slash + 1);
    place = place.substr(0, slash);
  }
  const std::size_t colon = place.rfind(':');
  if (colon == std::string_view::npos || colon == 0) {
    return wrong(text, "a host and a port are needed, as in " + url.scheme + "://127.0.0.1:5555");
  }
  url.host = place.substr(0, colon);
  url.port = place.substr(colon + 1);
  if (url.host.size() > 2 && url.host.front() == '[' && url.host.back() == ']') {  // an IPv6 address
    url.host = url.host.substr(1, url.host.size() - 2);
  }
  std::uint64_t number = 0;
  if (!parse_number(url.port, 65535, number) || number == 0) {
    return wrong(text, "port '" + url.port + "' is not a number from 1 to 65535");
  }
  url.port = std::to_string(number);
  return {};
}

}  // namespace

Outcome wrong_url(const Url& url, const std::string& why) { return wrong(url.text, why); }

const std::string* Url::option(std::string_view name) const noexcept {
  for (const auto& [key, value] : options) {
    if (key == name) {
      return &value;
    }
  }
  return nullptr;
}

bool parse_number(std::string_view text, std::uint64_t maximum, std::uint64_t& value) noexcept {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    text.remove_prefix(2);
    base = 16;
  }
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  return error == std::errc{} && stop == end && !text.empty() && value <= maximum;
}

bool parse_seconds(std::string_view text, std::uint64_t& ns) noexcept {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || stop != text.data() + text.size() || !(value >= 1e-6 && value <= 3600)) {
    return false;
  }
  ns = static_cast<std::uint64_t>(value * 1e9);
  return true;
}

Outcome parse_url(std::string_view text, Url& url) {
  url = Url{};
  url.text = text;
  if (text.find('\0') != std::string_view::npos) {
    return wrong(text.substr(0, text.find('\0')), "has a NUL byte in it");
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) {
    return wrong(text, expected());
  }
  url.scheme = text.substr(0, colon);
  const std::size_t question = text.find('?', colon);
  std::string_view place = text.substr(colon + 1, question == std::string_view::npos ? question : question - colon - 1);
  if (question != std::string_view::npos) {
    if (Outcome outcome = split_options(text, text.substr(question + 1), url); !outcome.ok()) {
      return outcome;
    }
  }
  url.row = find_scheme(url.scheme);
  if (url.row == nullptr) {
    return wrong(text, "no scheme '" + url.scheme + "'; " + expected());
  }
  if (url.row->place == Place::host || url.row->place == Place::board) {
    return split_host(text, place, url);
  }
  std::uint64_t number = 0;
  if (url.row->place == Place::file && place.empty()) {
    return wrong(text, "the device file is missing, as in " + std::string(url.row->form));
  }
  if (url.row->place == Place::number && !parse_number(place, 1u << 20, number)) {
    return wrong(text, "'" + std::string(place) + "' is not a descriptor number");
  }
  url.path = place;
  return {};
}

}  // namespace unitylink
