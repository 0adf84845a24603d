// SPDX-License-Identifier: BSD-3-Clause
// The bus master of the gateware of 2012, with its defects (docs/classic-protocol.md, section 7). A twin with it tests
// hosts.
//
// - A request without an acknowledge in time ends in E_BAT, but its cycle goes on at address 0. A read reads there, and
//   a write writes 0 there. If no slave answers at 0 either, the cycle waits for the next access. It takes the address
//   of this access, but keeps its own direction. So a write that timed out writes 0 where the next request reads. A
//   read that timed out reads where the next request writes.
// - The word of a write is taken from the wrong end of 32 bits. A word of 32 bits is right. A word of 24 bits keeps its
//   top 16, and one of 16 or fewer bits is 0.
#pragma once

#include "device/bus.hpp"

namespace unitylink::device {

class BusMaster2012 final : public Bus {
 public:
  BusMaster2012(Bus& bus, std::uint32_t data_bits) : bus_(bus), data_bits_(data_bits) {}

  BusReply read(std::uint32_t address, Clock now) override { return access(address, Cycle::read, 0, now); }
  BusStatus write(std::uint32_t address, std::uint32_t value, Clock now) override {
    return access(address, Cycle::write, value >> (32 - data_bits_), now).status;
  }
  void block(bool held, Clock now) override { bus_.block(held, now); }
  BusReply get(std::uint32_t address, Clock now) override { return bus_.get(address, now); }
  BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) override {
    return bus_.set(address, value, now);
  }

 private:
  enum class Cycle : std::uint8_t { none, read, write };

  BusReply cycle(Cycle cycle, std::uint32_t address, std::uint32_t value, Clock now) {
    return cycle == Cycle::write ? BusReply{bus_.write(address, value, now), 0} : bus_.read(address, now);
  }

  BusReply access(std::uint32_t address, Cycle wanted, std::uint32_t value, Clock now) {
    const Cycle done = left_ != Cycle::none ? left_ : wanted;
    const BusReply reply = cycle(done, address, left_ != Cycle::none ? 0 : value, now);
    left_ =
        reply.status == BusStatus::silent && cycle(done, 0, 0, now).status == BusStatus::silent ? done : Cycle::none;
    return reply;
  }

  Bus& bus_;
  std::uint32_t data_bits_;
  Cycle left_ = Cycle::none;  // the bus cycle that is still open after a timeout
};

}  // namespace unitylink::device
