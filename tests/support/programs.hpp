// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>

namespace testing {

/// A program that has become a part of another one, which runs it by its number.
struct program {
  using main_type = std::function<int(int, char**)>;

  program(int number, int (*its_main)()) {
    all()[number] = [its_main](int, char**) { return its_main(); };
  }
  program(int number, int (*its_main)(int, char**)) { all()[number] = its_main; }

  static std::map<int, main_type>& all() {
    static std::map<int, main_type> programs;
    return programs;
  }
};

}  // namespace testing
