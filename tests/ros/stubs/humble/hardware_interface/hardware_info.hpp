// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "hardware_interface/component_info.hpp"
