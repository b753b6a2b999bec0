// SPDX-License-Identifier: BSD-3-Clause
// Runs one of many programs that were compiled together: its number, then its own arguments.
#include "programs.hpp"

#include <cstdio>
#include <cstdlib>

int main(int count, char** arguments) {
  const auto& all = testing::program::all();
  const auto found = all.find(count > 1 ? std::atoi(arguments[1]) : 0);
  if (found != all.end()) return found->second(count - 1, arguments + 1);
  std::fprintf(stderr, "the first argument is a number from 1 to %zu\n", all.size());
  return 1;
}
