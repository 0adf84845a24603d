// SPDX-License-Identifier: BSD-3-Clause
// The table of schemes. Each opener is in the file of its driver.
#include "layer0_driver/schemes.hpp"

#include <algorithm>

namespace unitylink {

Opener open_serial, open_ftdi, open_rs485, open_spi, open_socket, open_serve, open_mmap, open_descriptor;

namespace {

constexpr Scheme table[] = {
    {.name = "serial",
     .form = "serial:/dev/ttyUSB0?baud=3000000",
     .what = "a serial port",
     .options = "baud",
     .open = &open_serial},
    {.name = "ftdi",
     .form = "ftdi:SERIAL?channel=A",
     .what = "an FTDI chip, also as a FIFO, without the kernel's driver",
     .place = Place::name,
     .options = "channel mode baud latency event",
     .open = &open_ftdi},
    {.name = "rs485",
     .form = "rs485:/dev/ttyUSB0?node=3&baud=3000000",
     .what = "one of many nodes on an RS-485 pair",
     .options = "node baud poll silence",
     .open = &open_rs485,
     .framed_only = true},
    {.name = "spi",
     .form = "spi:/dev/spidev0.0?speed_hz=10000000",
     .what = "an SPI port of the kernel's, the master",
     .options = "speed_hz poll waiting",
     .open = &open_spi},
    {.name = "tcp",
     .form = "tcp://HOST:PORT",
     .what = "a board on the network, or `unitylink simulate`",
     .place = Place::host,
     .open = &open_socket},
    {.name = "udp",
     .form = "udp://HOST:PORT",
     .what = "the same over UDP",
     .place = Place::host,
     .open = &open_socket,
     .loses_order = true},
    {.name = "serve",
     .form = "serve://HOST:PORT/BOARD",
     .what = "a board behind `unitylink serve`, which many programs share",
     .place = Place::board,
     .options = "token_file tls_ca tls_cert tls_key",
     .open = &open_serve,
     .framed_only = true},
    {.name = "mmap",
     .form = "mmap:/dev/uio0",
     .what = "registers that are memory: UIO, a PCIe BAR",
     .options = "offset size address_bytes base_hz",
     .open = &open_mmap,
     .stream = false},
    {.name = "fd",
     .form = "fd:NUMBER",
     .what = "an open descriptor, which the link takes over",
     .place = Place::number,
     .open = &open_descriptor,
     .once = true},
};

// Made at its first use. This may be an AddedScheme in another file, before the static objects of this file are made.
std::vector<const Scheme*>& rows() {
  static std::vector<const Scheme*> all = [] {
    std::vector<const Scheme*> built_in;
    for (const Scheme& scheme : table) {
      built_in.push_back(&scheme);
    }
    return built_in;
  }();
  return all;
}

}  // namespace

std::vector<std::string_view> Scheme::option_names() const {
  std::vector<std::string_view> names;
  for (std::string_view rest = options; !rest.empty();) {
    names.push_back(rest.substr(0, rest.find(' ')));
    rest.remove_prefix(std::min(names.back().size() + 1, rest.size()));
  }
  return names;
}

bool Scheme::takes(std::string_view option) const {
  const std::vector<std::string_view> names = option_names();
  return std::ranges::find(names, option) != names.end();
}

const std::vector<const Scheme*>& schemes() { return rows(); }

const Scheme* find_scheme(std::string_view name) {
  const auto found = std::ranges::find(rows(), name, &Scheme::name);
  return found == rows().end() ? nullptr : *found;
}

AddedScheme::AddedScheme(const Scheme& scheme) { rows().push_back(&scheme); }

}  // namespace unitylink
