// SPDX-License-Identifier: BSD-3-Clause
#include "own_question.hpp"

#include <clearance/chunked_query.hpp>
#include <clearance/deadline.hpp>

int main() {
  using namespace own_question;
  const auto robot = clearance::make_model<clearance::sphere>(links());
  const std::vector<clearance::vec3> points = cloud();
  // [forms]
  int failures = wrong("once", clearance::ask(clearance::host{}, robot, poses(), points, nearness{}));

  clearance::query prepared(clearance::host{}, robot, nearness{});  // then in every frame:
  failures += wrong("prepared", prepared(poses(), points));

  clearance::chunked chunks(clearance::point_span(points), 4096);  // as if they were too many for memory
  clearance::chunked_query by_chunks(clearance::host{}, robot, nearness{});
  failures += wrong("chunks", by_chunks(poses(), chunks));

  const auto known = clearance::ask_by(prepared, poses(), points, std::chrono::seconds(60), nearness{});
  failures += wrong("deadline", known.result) + (known.unseen != 0);
  // [forms]
  return failures;
}
