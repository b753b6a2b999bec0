// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a user asks for by its number.

#include <cstddef>
#include <stdexcept>
#include <string>

namespace clearance {

/// Throws std::out_of_range with a sentence, unless there is a number `i` of `count` things; `what` names one of them.
inline void check_number(const char* what, std::size_t i, std::size_t count) {
  if (i >= count)
    throw std::out_of_range("clearance: there is no " + std::string(what) + ' ' + std::to_string(i) + ": there " +
                            (count == 1 ? "is 1" : "are " + std::to_string(count)) + ", numbered from 0");
}

}  // namespace clearance
