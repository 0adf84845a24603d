// SPDX-License-Identifier: BSD-3-Clause
// Opens the driver that a URL names, and the capture beside it.
#include "layer0_driver/capturing_driver.hpp"
#include "layer0_driver/driver.hpp"

namespace unitylink {

DriverSource::DriverSource(Url url, std::uint64_t timeout_ns) : url_(std::move(url)), timeout_ns_(timeout_ns) {}
DriverSource::~DriverSource() = default;

Outcome DriverSource::open(std::unique_ptr<Driver>& driver, int cancelled) {
  const std::string* const trace = url_.option("trace");
  // opened before the port, so that a file that cannot be written is reported before the board gets a connection
  if (trace != nullptr && capture_ == nullptr) {
    std::unique_ptr<Capture> made;
    if (Outcome outcome = Capture::create(*trace, url_.text, made); !outcome.ok()) {
      return outcome;
    }
    capture_ = std::move(made);
  }
  Outcome outcome = url_.row->open(url_, {.timeout_ns = timeout_ns_, .cancelled = cancelled}, driver);
  // An empty file is deleted, because the next attempt to open the link would refuse a file that exists.
  if (!outcome.ok() && capture_ != nullptr && capture_->empty()) {
    capture_->discard();
    capture_.reset();
  }
  if (outcome.ok() && capture_ != nullptr) {
    driver = std::make_unique<CapturingDriver>(std::move(driver), capture_);
  }
  return outcome;
}

void DriverSource::close() noexcept {
  if (capture_ != nullptr) {
    capture_->close();
  }
}

void DriverSource::disown() noexcept {
  if (capture_ != nullptr) {
    capture_->disown();
  }
}

Outcome open_driver(const Url& url, std::uint64_t timeout_ns, std::unique_ptr<Driver>& driver) {
  if (!url.row->stream) {
    return wrong_url(url, std::string(url.row->what) + " has no bytes, only registers");
  }
  return DriverSource(url, timeout_ns).open(driver);
}

}  // namespace unitylink
