// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace nb = nanobind;

/// What Python's str() says.
inline std::string text_of(nb::handle object) { return nb::steal<nb::str>(PyObject_Str(object.ptr())).c_str(); }

/// "an array of shape (3, 4) and dtype float64", or the name of its type.
std::string shape_and_type(nb::handle given);

/// Numbers from Python. Throw std::invalid_argument, which names the argument.
double number_of(nb::handle given, const char* argument);
std::size_t count_of(nb::handle given, const char* argument);
/// The same for the number of something in an answer: IndexError if it is negative or beyond all numbers, TypeError if
/// it is none.
std::size_t index_of(nb::handle given, const char* argument);
std::array<double, 3> three_of(nb::handle given, const char* argument);
/// A file's name, from a string or a path.
std::string file_of(nb::handle given, const char* argument);

/// A NumPy array that owns values.
template <class T>
nb::object own_array(std::vector<T> values, const std::vector<std::size_t>& shape) {
  auto* const kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), shape.size(), shape.data(), owner));
}
