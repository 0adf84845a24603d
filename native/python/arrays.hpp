// SPDX-License-Identifier: BSD-3-Clause
// Memory that becomes a numpy array without a copy.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <initializer_list>
#include <memory>

namespace unitylink::python {

template <class T>
[[nodiscard]] nanobind::object array_of(std::unique_ptr<T[]> memory, std::initializer_list<std::size_t> shape) {
  T* data = memory.release();
  nanobind::capsule owner(data, [](void* pointer) noexcept { delete[] static_cast<T*>(pointer); });
  return nanobind::cast(nanobind::ndarray<nanobind::numpy, T>(data, shape, owner));
}

}  // namespace unitylink::python
