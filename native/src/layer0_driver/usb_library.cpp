// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/usb_library.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <string>

namespace unitylink::usb {

Outcome Library::load(std::shared_ptr<Library>& library) {
  const char* const told = std::getenv("UNITYLINK_LIBUSB");
  const std::string file = told != nullptr ? told : "libusb-1.0.so.0";
  auto made = std::make_shared<Library>();
  made->file_ = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (made->file_ == nullptr) {
    return {Status::not_found, file + " is missing; on Debian or Ubuntu: sudo apt-get install libusb-1.0-0"};
  }
  std::string missing;
  const auto find = [&](auto& function, const char* name) {
    void* const symbol = ::dlsym(made->file_, (std::string("libusb_") + name).c_str());
    if (symbol == nullptr) {
      missing = name;
    }
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbol);
  };
  find(made->init, "init");
  find(made->exit, "exit");
  find(made->get_device_list, "get_device_list");
  find(made->free_device_list, "free_device_list");
  find(made->get_device_descriptor, "get_device_descriptor");
  find(made->get_max_packet_size, "get_max_packet_size");
  find(made->open, "open");
  find(made->close, "close");
  find(made->get_string_descriptor_ascii, "get_string_descriptor_ascii");
  find(made->set_auto_detach_kernel_driver, "set_auto_detach_kernel_driver");
  find(made->claim_interface, "claim_interface");
  find(made->release_interface, "release_interface");
  find(made->control_transfer, "control_transfer");
  find(made->bulk_transfer, "bulk_transfer");
  find(made->alloc_transfer, "alloc_transfer");
  find(made->free_transfer, "free_transfer");
  find(made->submit_transfer, "submit_transfer");
  find(made->cancel_transfer, "cancel_transfer");
  find(made->handle_events_timeout, "handle_events_timeout");
  find(made->error_name, "error_name");
  if (!missing.empty()) {
    return {Status::not_found,
            file + " has no libusb_" + missing + ": it is not libusb-1.0, or it is older than 1.0.16"};
  }
  library = std::move(made);
  return {};
}

Library::~Library() {
  if (file_ != nullptr) {
    ::dlclose(file_);
  }
}

}  // namespace unitylink::usb
