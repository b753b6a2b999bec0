// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which mutant is on: see switches.py.
#include <cstdlib>

namespace clearance_mutants {
inline int on = [] {
  const char* const given = std::getenv("CLEARANCE_MUTANT");
  return given ? std::atoi(given) : 0;
}();
}  // namespace clearance_mutants

/// A template, so that what is constexpr may call it; where only a constant may stand, the compiler says so.
template <int number>
constexpr bool mutant() {
  return clearance_mutants::on == number;
}
