// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a door says to a wrong member.

#include "support/laws.hpp"

#include <stdexcept>

namespace testing {

/// Asks with a member as it should be, and with it wrong: the first must pass, and the second be refused by a sentence.
class refused_doors {
 public:
  /// `ask(value)` with a copy of `right` in which `spoil(value)` has put what is wrong.
  template <class T, class Ask, class Spoil>
  void check(const char* what, const T& right, const Ask& ask, const Spoil& spoil) {
    try {
      ask(right);
    } catch (const std::exception& e) {
      v_.require(false, what, ": refused though it is right: ", std::string(e.what()));
    }
    T wrong = right;
    spoil(wrong);
    std::string said = "not refused";
    try {
      ask(wrong);
    } catch (const std::invalid_argument& e) {
      said = e.what();
    } catch (const std::exception& e) {
      said = std::string("another exception, ") + e.what();
    }
    v_.require((said.starts_with("clearance") || said.starts_with("the robot")) && said.size() > 30, what, ": ", said);
    ++checked_;
  }
  std::size_t checked() const { return checked_; }

 private:
  verdict v_;
  std::size_t checked_ = 0;
};

}  // namespace testing
