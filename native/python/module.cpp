// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"

NB_MODULE(_native, module) {
  nanobind::set_leak_warnings(false);  // a program may end with an open link
  module.doc() = "The native core of Unity-Link; use the layers above it.";
  unitylink::python::bind_driver(module);
  unitylink::python::bind_stream(module);
  unitylink::python::bind_link(module);
  unitylink::python::bind_board_device(module);
  unitylink::python::bind_board(module);
  unitylink::python::bind_bus(module);
  unitylink::python::bind_component(module);
  unitylink::python::bind_faults(module);
  unitylink::python::bind_server(module);
  unitylink::python::bind_samples(module);
}
