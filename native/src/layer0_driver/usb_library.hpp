// SPDX-License-Identifier: BSD-3-Clause
// libusb-1.0. It is loaded only for an `ftdi:` link, because no other link needs it. Its ABI has not changed since 1.0,
// so this file declares what we use of it. The environment variable UNITYLINK_LIBUSB names another file to load.
#pragma once

#include <cstdint>
#include <memory>

#include "layer0_driver/status.hpp"

namespace unitylink::usb {

struct Context;
struct Device;
struct Handle;

struct DeviceDescriptor {
  std::uint8_t bLength, bDescriptorType;
  std::uint16_t bcdUSB;
  std::uint8_t bDeviceClass, bDeviceSubClass, bDeviceProtocol, bMaxPacketSize0;
  std::uint16_t idVendor, idProduct, bcdDevice;
  std::uint8_t iManufacturer, iProduct, iSerialNumber, bNumConfigurations;
};

enum : int {
  error_io = -1,
  error_access = -3,
  error_no_device = -4,
  error_busy = -6,
  error_timeout = -7,
  error_interrupted = -10,
  error_no_memory = -11,
};
enum class TransferStatus : int { completed, error, timed_out, cancelled, stall, no_device, overflow };

struct Transfer {
  Handle* handle;
  std::uint8_t flags;
  unsigned char endpoint;
  unsigned char type;
  unsigned int timeout_ms;
  TransferStatus status;
  int length;
  int actual_length;
  void (*callback)(Transfer*);
  void* user_data;
  unsigned char* buffer;
  int num_iso_packets;
};
inline constexpr unsigned char bulk = 2;

struct Interval {  // timeval
  long seconds;
  long microseconds;
};

class Library {
 public:
  // Errors: not_found if it is missing; the text says how to install it.
  [[nodiscard]] static Outcome load(std::shared_ptr<Library>& library);
  Library() = default;
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library();

  int (*init)(Context**) = nullptr;
  void (*exit)(Context*) = nullptr;
  std::intptr_t (*get_device_list)(Context*, Device***) = nullptr;
  void (*free_device_list)(Device**, int) = nullptr;
  int (*get_device_descriptor)(Device*, DeviceDescriptor*) = nullptr;
  int (*get_max_packet_size)(Device*, unsigned char) = nullptr;
  int (*open)(Device*, Handle**) = nullptr;
  void (*close)(Handle*) = nullptr;
  int (*get_string_descriptor_ascii)(Handle*, std::uint8_t, unsigned char*, int) = nullptr;
  int (*set_auto_detach_kernel_driver)(Handle*, int) = nullptr;
  int (*claim_interface)(Handle*, int) = nullptr;
  int (*release_interface)(Handle*, int) = nullptr;
  int (*control_transfer)(Handle*, std::uint8_t, std::uint8_t, std::uint16_t, std::uint16_t, unsigned char*,
                          std::uint16_t, unsigned int) = nullptr;
  int (*bulk_transfer)(Handle*, unsigned char, unsigned char*, int, int*, unsigned int) = nullptr;
  Transfer* (*alloc_transfer)(int) = nullptr;
  void (*free_transfer)(Transfer*) = nullptr;
  int (*submit_transfer)(Transfer*) = nullptr;
  int (*cancel_transfer)(Transfer*) = nullptr;
  int (*handle_events_timeout)(Context*, Interval*) = nullptr;
  const char* (*error_name)(int) = nullptr;

 private:
  void* file_ = nullptr;
};

}  // namespace unitylink::usb
