// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Arrays of NumPy, torch, CuPy, JAX: by DLPack, __cuda_array_interface__ and __array_interface__.

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace nb = nanobind;

inline constexpr int on_the_host = -1;

/// An array of any library as it lies in memory.
struct seen_array {
  const std::byte* data = nullptr;
  std::vector<std::size_t> shape;
  std::vector<std::int64_t> strides;  // bytes
  char kind = 'f';                    // as NumPy's
  std::size_t item = 0;               // bytes
  int device = on_the_host;
  nb::object kept;
};

/// Throws std::invalid_argument, "`argument` is `wanted`, not ...", for what is no array.
seen_array array_seen(nb::handle given, const char* argument, const char* wanted);
/// From __array_interface__ or __cuda_array_interface__.
seen_array from_interface(nb::handle given, const nb::dict& interface, int device, const char* argument);
