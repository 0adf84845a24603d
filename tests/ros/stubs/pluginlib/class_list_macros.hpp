// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#define PLUGINLIB_EXPORT_CLASS(Derived, Base) static_assert(std::is_base_of_v<Base, Derived>);
