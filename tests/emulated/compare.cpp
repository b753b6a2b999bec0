// SPDX-License-Identifier: BSD-3-Clause
// compare QUESTIONS FIRST LAST: asks them on the host and, by each schedule from FIRST to LAST, with kernels. Each
// answer must have the same bits.
#include "emulated/block.hpp"
#include "emulated/record.hpp"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>

namespace {

/// Returns how many answers differ, and says which are the first.
int differences(const emulated::record& host, const emulated::record& kernels) {
  const auto &a = host.answers(), &b = kernels.answers();
  if (a.size() != b.size()) {
    std::printf("the host has %zu answers, kernels have %zu\n", a.size(), b.size());
    return 1;
  }
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].to == b[i].to && a[i].bytes == b[i].bytes) continue;
    if (++count > 5) continue;
    std::size_t at = 0;
    while (at < a[i].bytes.size() && at < b[i].bytes.size() && a[i].bytes[at] == b[i].bytes[at]) ++at;
    std::printf("%s: differs at byte %zu of %zu (kernels: %s, %zu)\n", a[i].to.c_str(), at, a[i].bytes.size(),
                b[i].to.c_str(), b[i].bytes.size());
  }
  return count;
}

}  // namespace

int main(int count, char** arguments) try {
  const auto its = count == 4 ? emulated::askers().find(arguments[1]) : emulated::askers().end();
  if (its == emulated::askers().end()) {
    std::printf("usage: compare QUESTIONS FIRST LAST, and questions are:");
    for (const auto& [name, asker] : emulated::askers()) std::printf(" %s", name.c_str());
    std::printf("\n");
    return 2;
  }
  const auto [on_host, by_kernels] = its->second;
  if (on_host == nullptr || by_kernels == nullptr) throw std::logic_error("these questions were not compiled twice");
  emulated::record host;
  on_host(host);
  int all = 0;
  for (unsigned seed = unsigned(std::atoi(arguments[2])); seed <= unsigned(std::atoi(arguments[3])); ++seed) {
    emulated::schedule(seed);
    emulated::record kernels;
    by_kernels(kernels);
    const int its_own = differences(host, kernels);
    std::printf("schedule %u: %zu answers, %d differ\n", seed, host.answers().size(), its_own);
    all += its_own;
  }
  return all != 0 || host.answers().empty();
} catch (const std::exception& e) {
  std::printf("%s\n", e.what());
  return 1;
}
