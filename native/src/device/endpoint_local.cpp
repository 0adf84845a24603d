// SPDX-License-Identifier: BSD-3-Clause
// An endpoint for a board in steps: a line in memory, for a link in this process.
#include <cerrno>
#include <cstring>
#include <memory>
#include <sys/eventfd.h>
#include <utility>

#include "device/endpoints.hpp"
#include "layer0_driver/local_line.hpp"

namespace unitylink::device {

namespace {

class LocalEndpoint final : public Endpoint {
 public:
  ~LocalEndpoint() override { LocalEndpoint::dismiss(); }

  // The descriptor only stands for the line. So it has a number that nothing else in this process has.
  std::string url() override {
    if (line_ == nullptr || left()) {
      Descriptor ticket(::eventfd(0, EFD_CLOEXEC));
      if (!ticket.open()) {
        throw EndpointError(std::string("no descriptor for a line: ") + std::strerror(errno));
      }
      dismiss();
      line_ = std::make_shared<LocalLine>();
      line_->listen(LocalLine::board, member_);
      LocalLine::offer(ticket.get(), line_);
      number_ = ticket.release();  // the link closes it
      fresh_ = true;
    }
    return "fd:" + std::to_string(number_);
  }

  [[nodiscard]] bool has_client() const noexcept override { return line_ != nullptr; }
  [[nodiscard]] int client() const noexcept override { return -1; }
  bool admit(bool) override { return std::exchange(fresh_, false); }

  bool listen(Lockstep::Member* member) override {
    member_ = member;
    if (line_ != nullptr) {
      line_->listen(LocalLine::board, member_);
    }
    return true;
  }

  void dismiss() override {
    if (line_ != nullptr) {
      line_->listen(LocalLine::board, nullptr);
      line_->close(LocalLine::board);
      line_ = nullptr;
    }
  }

  Transfer receive(std::span<std::uint8_t> room) override { return outcome(line_->receive(LocalLine::board, room)); }
  Transfer send(std::span<const std::uint8_t> bytes) override { return outcome(line_->send(LocalLine::board, bytes)); }

 private:
  [[nodiscard]] bool left() const noexcept { return line_->receive(LocalLine::board, {}).status == Status::closed; }

  Transfer outcome(unitylink::Transfer moved) {
    if (moved.status == Status::closed) {
      dismiss();
      return {Result::gone, 0};
    }
    return {moved.count > 0 ? Result::done : Result::nothing, moved.count};
  }

  std::shared_ptr<LocalLine> line_;
  Lockstep::Member* member_ = nullptr;
  int number_ = -1;
  bool fresh_ = false;
};

}  // namespace

std::unique_ptr<Endpoint> make_local_endpoint() { return std::make_unique<LocalEndpoint>(); }

}  // namespace unitylink::device
