// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#define HARDWARE_INTERFACE_VERSION_MAJOR (6)
#define HARDWARE_INTERFACE_VERSION_MINOR (10)
#define HARDWARE_INTERFACE_VERSION_PATCH (1)
#define HARDWARE_INTERFACE_VERSION_GTE(major, minor, patch) \
  ((major < HARDWARE_INTERFACE_VERSION_MAJOR)   ? true      \
   : (major > HARDWARE_INTERFACE_VERSION_MAJOR) ? false     \
   : (minor < HARDWARE_INTERFACE_VERSION_MINOR) ? true      \
   : (minor > HARDWARE_INTERFACE_VERSION_MINOR) ? false     \
                                                : (patch <= HARDWARE_INTERFACE_VERSION_PATCH))
