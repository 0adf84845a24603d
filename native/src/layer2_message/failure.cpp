// SPDX-License-Identifier: BSD-3-Clause
#include "layer2_message/failure.hpp"

#include <algorithm>
#include <cstdio>

#include "layer2_message/shapes.hpp"

namespace unitylink {
namespace {

std::string_view meaning_of(std::string_view error) noexcept {
  namespace codes = protocol::application_error;
  if (error == codes::incomplete_command) return "this gateware has no such command";
  if (error == codes::missing_address) return "address bytes missing";
  if (error == codes::missing_data) return "data bytes missing";
  if (error == codes::invalid_block_size) return "more words in one message than the gateware takes";
  if (error == codes::invalid_group_size) return "more addresses in one group than the gateware takes";
  if (error == codes::invalid_group) return "no such subscription group";
  if (error == codes::bus_error_read) return "its bus refused the read";
  if (error == codes::bus_error_write) return "its bus refused the write";
  if (error == codes::bus_timeout) return "nothing on its bus answered";
  if (error == "bus_error") return "its bus refused";
  if (error == "bus_timeout") return "nothing on its bus answered";
  if (error == "bad_address") return "it has no such control register";
  if (error == "denied") return "its dead-man has tripped and its outputs are safe; arm() lets them be written again";
  if (error == "invalid") return "this gateware was built without that";
  if (error == "too_long") return "the reply would not fit into its buffers";
  if (error == "not_allowed")
    return "this server lets your token read here, but not do that; ask who runs it for the scope";
  if (error == "lease_held") return "another client has the write lease of it, or its outputs are being made safe";
  if (error == "stopped_since")
    return "the robot was stopped after this was asked for, or is being stopped; if it may move, arm it again";
  if (error == "no_group") return "no such group, or more words than one holds";
  return "an error of the gateware";
}

constexpr unsigned overrun = 4;  // bit of a physical error

std::string_view meaning_of(std::uint8_t code) noexcept {
  namespace codes = protocol::datalink_error;
  switch (code) {
    case codes::message_too_long: return "message too long for its receive buffer";
    case codes::format: return "wrong format";
    case codes::odd_digits: return "odd number of hex digits";
    case codes::invalid_character: return "invalid character";
    case codes::checksum:
      return "wrong checksum; is polynomial= right? polynomial=none is for gateware without checksums";
    default: break;
  }
  return code >= codes::physical + overrun
             ? "more requests came than its receive FIFO holds; say its depth in bytes in the URL, fifo="
             : "error of its physical layer; is the baud rate right?";
}

std::string code_text(std::uint8_t code) {
  char text[8];
  std::snprintf(text, sizeof text, "?%02x", code);
  return std::string(text) + " (" + std::string(meaning_of(code)) + ")";
}

// The address of a failed exchange. For a read of a block, the word at which it ended.
bool address_of(const Exchange& exchange, std::uint32_t& address) noexcept {
  switch (exchange.operation) {
    case Operation::read:
    case Operation::write: address = exchange.address; return true;
    case Operation::list:
      address = exchange.steps[exchange.words < exchange.steps.size() ? exchange.words : 0].address;
      return true;
    case Operation::read_many:
    case Operation::transfer: {
      const std::size_t writes = exchange.write_addresses.size();
      const std::size_t words = writes + exchange.addresses.size();
      const std::size_t word = exchange.words < words ? exchange.words : 0;
      if (words == 0) {
        return false;
      }
      address = word < writes ? exchange.write_addresses[word] : exchange.addresses[word - writes];
      return true;
    }
    default: return false;
  }
}

std::string name_of(const Exchange& exchange, std::uint32_t address_bytes) {
  std::uint32_t address = 0;
  const bool has_address = address_of(exchange, address);
  switch (exchange.operation) {
    case Operation::transfer:
      return (exchange.write_addresses.empty()
                  ? ""
                  : "write of " + std::to_string(exchange.write_addresses.size()) + " words") +
             (exchange.write_addresses.empty() || exchange.addresses.empty() ? "" : " and ") +
             (exchange.addresses.empty() ? "" : "read of " + std::to_string(exchange.addresses.size()) + " words") +
             (has_address ? " (at " + hex_address(address, address_bytes) + ")" : "");
    case Operation::list:
      return "list of " + std::to_string(exchange.steps.size()) + " operations (at " +
             hex_address(address, address_bytes) + ")";
    case Operation::define_group: return "definition of group " + std::to_string(exchange.address);
    case Operation::define_exchange: return "definition of exchange group " + std::to_string(exchange.address);
    case Operation::exchange: return "exchange of group " + std::to_string(exchange.address);
    case Operation::read_control: return "read of control register " + hex_address(exchange.address, 2);
    case Operation::write_control:
      if (exchange.address == protocol::control::arm || exchange.address == protocol::serve::dated_arm) {
        return "arm";
      }
      return "write of control register " + hex_address(exchange.address, 2);
    case Operation::synchronise: return "the question about the posts";
    case Operation::close_session: return "the end of the session";
    case Operation::resynchronise: return "resynchronisation with the device";
    case Operation::empty_message: return "the question whether the gateware is corrected";
    case Operation::read: return "read of " + hex_address(address, address_bytes);
    case Operation::write: return "write of " + hex_address(address, address_bytes);
    case Operation::read_many:
      return "read of " + std::to_string(exchange.addresses.size()) + " words" +
             (has_address ? " (at " + hex_address(address, address_bytes) + ")" : "");
    case Operation::write_group_addresses:
    case Operation::write_group_rate:
    case Operation::read_group:
      return std::string(letters_of(exchange.operation).command) + " of group " + std::to_string(exchange.address);
    default: return std::string(letters_of(exchange.operation).command);
  }
}

std::string last_answer(const Exchange& exchange, const FailureContext& context) {
  if (context.last_answer_ns == 0) {
    return "the device has never answered; is it powered, is it the right port and baud rate?";
  }
  const std::uint64_t ago = exchange.ended_ns > context.last_answer_ns ? exchange.ended_ns - context.last_answer_ns : 0;
  return "the device last answered " + duration_text(ago) + " ago";
}

std::string attempts_text(const Exchange& exchange) {
  return std::to_string(exchange.attempts) + (exchange.attempts == 1 ? " attempt in " : " attempts in ") +
         duration_text(exchange.ended_ns - exchange.begun_ns);
}

std::string refused_text(const Exchange& exchange, const std::string& name) {
  std::string text =
      name + ": the device answered " + std::string(exchange.error) + ": " + std::string(meaning_of(exchange.error));
  if (exchange.stray_cycle && exchange.writes()) {
    text +=
        "; 2012 gateware may now have written 0 to address 0 or, where nothing answers there, will write 0 to the "
        "address that "
        "its next read or write names: reset it, or write that word once more afterwards";
  } else if (exchange.stray_cycle) {
    text +=
        "; where nothing answers at address 0 either, 2012 gateware loses the next write: read a word that answers "
        "before it";
  }
  return text;
}

constexpr const char* spoiled_text =
    " was answered, but after a bus timeout, and 2012 gateware may then do something else at its address";

std::string sentence(const Exchange& exchange, const FailureContext& context) {
  const std::string name = name_of(exchange, context.address_bytes);
  const std::string heard = exchange.datalink_code != 0 ? "; it said " + code_text(exchange.datalink_code) : "";
  const std::string because = context.reason.empty() ? std::string() : " (" + std::string(context.reason) + ")";
  switch (exchange.status) {
    case Status::timeout:
      if (!exchange.sent && exchange.expired(exchange.ended_ns)) {
        return name + " not sent: its time was over" + heard;
      }
      return name + (exchange.writes() && !exchange.sent ? " not sent: resynchronisation" : "") + " unanswered after " +
             attempts_text(exchange) + heard + "; " + last_answer(exchange, context);
    case Status::unknown:
      if (exchange.stray_cycle) {
        return name + spoiled_text + ": it may or may not have been executed; read it back before going on";
      }
      return name + " was sent but its answer lost" + because + heard +
             ": it may or may not have been executed; read it back before going on";
    case Status::closed: return name + ": the link is closed" + because;
    case Status::down: return name + ": the line is gone" + because + " and is being opened again; nothing was sent";
    case Status::busy: return name + ": the board serves another program; close that one first";
    case Status::mismatch: return name + ": another device now answers on this port; connect again";
    case Status::denied:
    case Status::refused:
    case Status::lease_held:
    case Status::bus_error: return refused_text(exchange, name);
    case Status::cancelled: return name + ": given up, because another request of the same call failed";
    case Status::protocol_error:
      return !exchange.error.empty() ? refused_text(exchange, name)
             : exchange.stray_cycle
                 ? name + spoiled_text + "; read it again"
                 : name + " not answered correctly after " + attempts_text(exchange) +
                       (heard.empty() ? "; its replies were malformed or had a wrong checksum" : heard);
    default: return name + ": " + status_text(exchange.status);
  }
}

}  // namespace

std::string hex_address(std::uint32_t address, std::uint32_t address_bytes) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%0*x", static_cast<int>(address_bytes == 0 ? 1 : 2 * address_bytes),
                static_cast<unsigned>(address));
  return text;
}

std::string duration_text(std::uint64_t ns) {
  char text[32];
  const double seconds = static_cast<double>(ns) * 1e-9;
  if (seconds < 1e-3) {
    std::snprintf(text, sizeof text, "%.0f us", seconds * 1e6);
  } else if (seconds < 1) {
    std::snprintf(text, sizeof text, "%.1f ms", seconds * 1e3);
  } else {
    std::snprintf(text, sizeof text, "%.1f s", seconds);
  }
  return text;
}

Outcome behind_writes(Outcome outcome) {
  if (outcome.status == Status::down) {
    outcome.status = Status::unknown;
    outcome.text = in_words([&] { return outcome.text + "; what the call had written before was executed"; });
  }
  return outcome;
}

std::size_t first_failed(std::span<const Exchange> exchanges) noexcept {
  const auto first = [exchanges](auto failed) {
    return static_cast<std::size_t>(std::find_if(exchanges.begin(), exchanges.end(), failed) - exchanges.begin());
  };
  const std::size_t cause =
      first([](const Exchange& e) { return e.status != Status::ok && e.status != Status::cancelled; });
  return cause < exchanges.size() ? cause : first([](const Exchange& e) { return e.status != Status::ok; });
}

Outcome describe(const Exchange& exchange, const FailureContext& context) {
  Outcome outcome;
  outcome.status = exchange.status;
  if (exchange.status == Status::ok) {
    return outcome;
  }
  outcome.has_address = address_of(exchange, outcome.address);
  outcome.attempts = exchange.attempts;
  outcome.elapsed_ns = exchange.ended_ns - exchange.begun_ns;
  outcome.text = in_words([&] { return sentence(exchange, context); });
  return outcome;
}

}  // namespace unitylink
