// SPDX-License-Identifier: BSD-3-Clause
// The options of a link URL that layer 2 uses, after they were checked.
#pragma once

#include <cstdint>
#include <optional>

#include "layer0_driver/status.hpp"
#include "layer0_driver/url.hpp"
#include "layer2_message/classic_engine.hpp"

namespace unitylink {

enum class Gateware : std::uint8_t { automatic, published_2012, corrected };

enum class Protocol : std::uint8_t { automatic, classic, framed };

struct LinkOptions {
  EngineSettings engine;  // timeout= fifo= window= polynomial=
  Protocol protocol = Protocol::automatic;
  double deadman_s = 0;                    // deadman=; 0: the dead-man is not set
  std::optional<std::uint64_t> spec_hash;  // spec_hash=HEX: the wire hash of the caller's spec
  bool any_spec = false;                   // spec_hash=any: the user knows that spec and gateware belong together
  std::uint32_t attempts = 3;
  bool checked = false;       // crc=
  bool reconnect = false;     // reconnect=: a lost line is opened again
  std::uint64_t wait_ns = 0;  // wait=: a read waits for so long while the line is gone
  // spin=: a caller checks for its reply for so long before it sleeps; 0: it sleeps at once
  std::uint64_t spin_ns = 200'000;
  bool publish_checked = true;  // publish_crc=
  Gateware gateware = Gateware::automatic;
  // For a device without RLC. A device with RLC must report the same values.
  std::optional<std::uint32_t> address_bytes, data_bytes, read_many, publish_mode, base_hz, groups, group_size,
      rate_bytes;
};

// Reads and checks all options. bad_url: an option is unknown, or has a value that is not allowed.
[[nodiscard]] Outcome parse_options(const Url& url, LinkOptions& options);

// The device's configuration, or the URL's if the device reports none. mismatch if they differ or a width is missing.
[[nodiscard]] Outcome settle_configuration(const LinkOptions& options, const std::optional<Configuration>& reported,
                                           Configuration& configuration);

}  // namespace unitylink
