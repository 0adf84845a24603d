// SPDX-License-Identifier: BSD-3-Clause
#include "device/address_map.hpp"

#include <algorithm>

#include "device/double_buffer.hpp"
#include "device/fifo.hpp"
#include "device/memory.hpp"

namespace unitylink::device {

namespace {

bool among(const std::vector<std::uint32_t>& words, std::uint32_t address) noexcept {
  return std::binary_search(words.begin(), words.end(), address);
}

bool within(const std::vector<AddressRange>& ranges, std::uint32_t address) noexcept {
  return std::any_of(ranges.begin(), ranges.end(),
                     [address](const AddressRange& range) { return range.first <= address && address <= range.last; });
}

}  // namespace

AddressMap::AddressMap(const DeviceConfiguration& configuration, const EventSink& sink)
    : errors_(configuration.bus_error_ranges),
      silent_(configuration.silent_ranges),
      flags_(configuration.flag_words),
      strobes_(configuration.strobe_words),
      address_mask_(configuration.address_mask()),
      data_mask_(configuration.data_mask()) {
  const auto add = [this](std::uint32_t base, std::uint32_t size, std::unique_ptr<Bus> slave) {
    regions_.push_back({{base, base + (size - 1)}, std::move(slave)});
  };
  if (configuration.tosnet.present) {
    auto tosnet = std::make_unique<Tosnet>(configuration.tosnet, sink);
    tosnet_ = tosnet.get();
    timed_.push_back(tosnet_);
    add(configuration.tosnet.base, 1u << protocol::tosnet::address_bits, std::move(tosnet));
  }
  for (const FifoConfiguration& fifo : configuration.fifos) {
    auto slave = std::make_unique<Fifo>(fifo, sink);
    timed_.push_back(slave.get());
    add(fifo.base, 3, std::move(slave));
  }
  for (const DoubleBufferConfiguration& buffer : configuration.double_buffers) {
    add(buffer.base, buffer.size + 1, std::make_unique<DoubleBuffer>(buffer.size));
  }
  for (const ComponentConfiguration& one : configuration.components) {
    std::unique_ptr<Component> model = make_component(one);
    components_.push_back(model.get());
    if (model) {
      model->send_events_to(sink);
      timed_.push_back(model.get());
      if (one.node) {
        node_parts_.add(one, std::move(model));
        continue;
      }
      add(one.base, one.words, std::move(model));
      regions_.back().is_component = true;
    }
  }
  for (std::size_t number = 0; number < components_.size(); ++number) {
    for (const ConnectionConfiguration& lead : configuration.components[number].connections) {
      Component* source = components_[lead.component];
      if (source != nullptr && components_[number] != nullptr) {
        source->connect(lead.output, *components_[number], lead.input);
      }
    }
  }
  if (tosnet_ != nullptr && !node_parts_.empty()) {
    tosnet_->attach([this](Clock now) {
      if (before_components_) {
        before_components_(now);
      }
      node_parts_.exchange(*tosnet_, now);
    });
  }
  regions_.push_back({{0, address_mask_}, std::make_unique<Memory>(configuration.bench_memory, data_mask_)});
}

AddressMap::Region& AddressMap::region(std::uint32_t address, Clock now) {
  Region& found = *std::find_if(regions_.begin(), regions_.end(), [address](const Region& candidate) {
    return candidate.range.first <= address && address <= candidate.range.last;
  });
  if (found.is_component && before_components_) {
    before_components_(now);
  }
  return found;
}

BusStatus AddressMap::refusal(std::uint32_t address) const noexcept {
  return within(errors_, address) ? BusStatus::error : within(silent_, address) ? BusStatus::silent : BusStatus::ok;
}

BusReply AddressMap::read(std::uint32_t address, Clock now) {
  if (const BusStatus status = refusal(address); status != BusStatus::ok) {
    return {status, 0};
  }
  Region& at = region(address, now);
  BusReply reply = at.slave->read(address - at.range.first, now);
  reply.value &= data_mask_;
  return reply;
}

BusStatus AddressMap::write(std::uint32_t address, std::uint32_t value, Clock now) {
  if (const BusStatus status = refusal(address); status != BusStatus::ok) {
    return status;
  }
  Region& at = region(address, now);
  const std::uint32_t word = value & data_mask_;
  BusStatus status = BusStatus::ok;
  if (at.is_component) {
    status = at.slave->write(address - at.range.first, word, now);
  } else if (among(flags_, address)) {
    status =
        at.slave->write(address - at.range.first, at.slave->read(address - at.range.first, now).value & ~word, now);
  } else if (!among(strobes_, address)) {
    status = at.slave->write(address - at.range.first, word, now);
  }
  if (observer_ && status == BusStatus::ok) {
    observer_(address, word);
  }
  return status;
}

void AddressMap::block(bool held, Clock now) {
  if (before_components_) {
    before_components_(now);
  }
  for (Region& at : regions_) {
    at.slave->block(held, now);
  }
}

Clock AddressMap::settles(std::uint32_t address) const noexcept {
  for (const Region& at : regions_) {
    if (at.range.first <= address && address <= at.range.last) {
      return at.slave->settles(address - at.range.first);
    }
  }
  return never;
}

Clock AddressMap::next_clock() const noexcept {
  Clock next = never;
  for (const Bus* slave : timed_) {
    next = std::min(next, slave->next_clock());
  }
  return next;
}

void AddressMap::advance(Clock now) {
  if (before_components_) {
    before_components_(now);  // a component that catches up has seen all levels until then
  }
  for (Bus* slave : timed_) {
    if (slave->next_clock() <= now) {  // the others may still be told of levels before `now`
      slave->advance(now);
    }
  }
}

BusReply AddressMap::get(std::uint32_t address, Clock now) {
  if (address > address_mask_) {
    return {BusStatus::error, 0};
  }
  Region& at = region(address, now);
  BusReply reply = at.slave->get(address - at.range.first, now);
  reply.value &= data_mask_;
  return reply;
}

BusStatus AddressMap::set(std::uint32_t address, std::uint32_t value, Clock now) {
  if (address > address_mask_) {
    return BusStatus::error;
  }
  Region& at = region(address, now);
  return at.slave->set(address - at.range.first, value & data_mask_, now);
}

BusStatus AddressMap::preset(std::uint32_t address, std::uint32_t value, Clock now) {
  if (address > address_mask_) {
    return BusStatus::error;
  }
  Region& at = region(address, now);
  return at.slave->preset(address - at.range.first, value & data_mask_, now);
}

}  // namespace unitylink::device
