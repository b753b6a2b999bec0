// SPDX-License-Identifier: BSD-3-Clause
#include "own_visitor.hpp"

int main() {
  // [host]
  const auto tree = clearance::build<clearance::sphere>(spheres());
  std::vector<three_nearest::result_type> answers;
  for (const clearance::vec3 point : points()) {
    three_nearest query;
    clearance::near_first{}(tree.view(), point, query);
    answers.push_back(query.result());
  }
  // [host]
  return check(answers);
}
