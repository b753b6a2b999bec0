// SPDX-License-Identifier: BSD-3-Clause
// search CASES [SEED] [PART]: prints a line for each search whose name contains PART. Built by
// tests/bounds/search-bounds.
#include "bounds/rows.hpp"

#include <cstdlib>

int main(int count, char** words) {
  if (count < 2) return std::fprintf(stderr, "usage: search CASES [SEED] [PART]\n"), 2;
  const std::uint64_t cases = std::strtoull(words[1], nullptr, 10),
                      seed = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1;
  const std::string part = count > 3 ? words[3] : "";
  bool broken = false;
  bounds::each_row(cases, seed, [&](const std::string& name, auto run) {
    if (name.find(part) == std::string::npos) return;
    const bounds::row r = run();
    std::printf("%-32s %12llu %10llu %10.2f  law %d  at%s\n", name.c_str(), (unsigned long long)r.cases,
                (unsigned long long)r.broken, r.least, r.law, r.broken != 0 ? r.at.c_str() : " -");
    std::fflush(stdout);
    broken = broken || r.broken != 0;
  });
  return broken;
}
