// SPDX-License-Identifier: BSD-3-Clause
// Prepared questions through many frames: right, refused where they must be, and in the same memory.
#include "forms/soak.hpp"
#include "support/catch.hpp"

namespace soak_test {

using namespace testing;
using clearance::host;

namespace {

/// A source that throws at one of its points.
struct broken_points {
  clearance::point_span points;
  std::size_t at;

  std::size_t size() const { return points.size(); }
  clearance::sample operator[](std::size_t i) const {
    if (i == at) throw std::runtime_error("the sensor is gone");
    return points[i];
  }
};
static_assert(clearance::point_source<broken_points>);

}  // namespace

TEST_CASE("Frame after frame answers are right and memory stays") {
  verdict v;
  dice d(41);
  moving_frames robot(4, 17);
  const auto model = robot.model();
  const clearance::min_distance least_of_all;
  const clearance::zones some_zones{.thresholds = {0.1, 0.4}};
  clearance::query least(host{2}, model, least_of_all);
  clearance::query zones(host{2}, model, some_zones);
  std::size_t thrown = 0;
  const auto failing = [&](const soak_frame& f) {  // a source that throws, then the same points
    if (f.refused || f.points.empty() || f.points[0].empty()) return;
    const clearance::point_span whole(f.points[0]);
    const broken_points broken{whole, d.below(unsigned(whole.size()))};
    try {
      least(f.s.poses, broken, f.here()[0].pose);
    } catch (const std::runtime_error&) {
      ++thrown;
    }
    try {
      zones(f.s.poses, broken, f.here()[0].pose);
    } catch (const std::runtime_error&) {
      ++thrown;
    }
    v.require(same_answer(least(f.s.poses, f.here()), ask(host{1}, model, f.s.poses, f.here(), least_of_all)),
              "after a source that throws, the least distance");
    v.require(same_answer(zones(f.s.poses, f.here()), ask(host{1}, model, f.s.poses, f.here(), some_zones)),
              "after a source that throws, zones");
  };
  const soak_counts n = soak(host{2}, soak_seconds(), 17, v, failing);
  print(n, soak_seconds());
  std::printf("%zu sources threw\n", thrown);
  CHECK(thrown > 0);
  CHECK(n.refused > 0);
  CHECK(n.by_brute_force > 0);
  CHECK(n.end.allocated - n.begin.allocated < 4e6);
  CHECK((keeps_freed_memory || n.end.resident - n.begin.resident < 48e6));
}

}  // namespace soak_test
