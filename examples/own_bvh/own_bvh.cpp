// SPDX-License-Identifier: BSD-3-Clause
#include "own_bvh.hpp"

#include <clearance/backends/host.hpp>

int main() {
  std::vector<theirs::node> memory(600);
  return example(clearance::host{}, memory);
}
