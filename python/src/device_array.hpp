// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Arrays in a device's memory, for Python.

#include "device_door.hpp"
#include "seen_array.hpp"

#include <nanobind/nanobind.h>

#include <memory>
#include <string>
#include <vector>

namespace nb = nanobind;

/// Memory of a device that arrays view, and who writes it.
struct device_memory {
  std::shared_ptr<void> bytes, writer;
  void* stream = nullptr;  ///< In which it is written.
};

/// What Python's DeviceArray holds.
struct device_array {
  std::byte* data = nullptr;
  std::vector<std::size_t> shape;
  std::vector<std::int64_t> strides;  // bytes
  nb::object dtype;
  int device = 0;
  std::shared_ptr<device_memory> memory;
};

/// "cuda:0"; "cpu" is on_the_host. Throws std::invalid_argument for another text.
int device_number(const std::string& device);
std::string device_name(int device);

/// Memory for `count` values.
device_array make_device_array(nb::object dtype, std::size_t count, int device, void* stream,
                               std::shared_ptr<void> writer);

/// The memory of an array of Python that a device may write. Throws std::invalid_argument, which names the array,
/// unless it lies there, without gaps, and has `count` values of this dtype; if `any_count`, `count` becomes how many.
std::byte* writable_there(nb::handle given, const std::string& argument, nb::handle dtype, std::size_t& count,
                          bool any_count, int device);

void bind_device_array(nb::module_& m);
