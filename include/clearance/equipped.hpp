// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot that was given cells or fields, and why some of its parts go without.

#include <clearance/concepts.hpp>

#include <exception>
#include <new>
#include <string>

namespace clearance {

/// A robot whose parts have what was asked for, and for each part that cannot have it a sentence that says why; else it
/// is empty.
template <class Model>
struct equipped {
  Model model;
  std::vector<std::string> without;
};

namespace detail {

/// Did memory end, on the host or where `on` runs?
template <backend B>
bool out_of_memory(const B& on, const std::exception& error) {
  if constexpr (requires { on.out_of_memory(error); })
    if (on.out_of_memory(error)) return true;
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
}

}  // namespace detail

}  // namespace clearance
