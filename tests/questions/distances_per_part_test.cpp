// SPDX-License-Identifier: BSD-3-Clause
// Every part's distance to every point is that of a plain loop, and the least of them is the point's distance.
#include "support/brute_per_part.hpp"
#include "support/frames.hpp"

#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>

namespace distances_per_part_test {

using namespace testing;
using clearance::distances_per_part, clearance::host;

TEST_CASE("Every part's distance to every point is brute force's, to the bit, and their least that of distances") {
  verdict v;
  std::size_t near = 0, far = 0;
  for (auto s : scenes<inner_sphere>()) {
    if (s.points.size() > 3) s.points[1].x = clearance::not_a_number, s.points[3].z = clearance::infinity;
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const real d_max : {real(0), real(0.2 * s.size), clearance::infinity}) {
      const std::string what = s.name + ", d_max " + std::to_string(d_max);
      const auto found = ask(host{}, model, s.poses, two, distances_per_part{d_max});
      require_same(found, brute_per_part(s, two, d_max, nothing_inside), v, what);
      const auto least = ask(host{}, model, s.poses, two, clearance::distances{d_max});
      for (std::size_t i = 0; i < found.points; ++i) {
        real nearest = found.of(0)[i];
        for (std::size_t k = 1; k < s.parts.size(); ++k) nearest = found.of(k)[i] < nearest ? found.of(k)[i] : nearest;
        v.require(nearest != nearest ? least.distance[i] != least.distance[i] : nearest == least.distance[i], what,
                  ": the least of point", i, " is", nearest, " and not", least.distance[i]);
        near += nearest <= d_max, far += nearest == clearance::infinity;
      }
      v.require(same_bits(found.certain.lower(1), least.certain.lower(1)), what, ": another certainty");
    }
  }
  CHECK((near > 1000 && far > 1000));
}

TEST_CASE("No point, no part in reach, and d_max that is no number") {
  const std::vector<std::vector<inner_sphere>> bodies{{{{0, 0, 0}, 1}}, {{{9, 0, 0}, 1}}};
  const auto model = clearance::make_model<clearance::sphere>(bodies);
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  CHECK(ask(host{}, model, poses, std::vector<vec3>{}, distances_per_part{}).distance.empty());
  const auto one = ask(host{}, model, poses, std::vector<vec3>{{3, 0, 0}}, distances_per_part{2.5f});
  CHECK((one.of(0)[0] == 2 && one.of(1)[0] == clearance::infinity && one.counts.valid == 1));
  CHECK_THROWS_AS(ask(host{}, model, poses, std::vector<vec3>{{3, 0, 0}}, distances_per_part{clearance::not_a_number}),
                  std::invalid_argument);
}

TEST_CASE("Prepared, every part's distances are in every frame what one call says, and after one that is refused") {
  verdict v;
  moving_frames f(5, 116);
  const auto model = f.model();
  clearance::query query(host{}, model, distances_per_part{});
  for (; f.there(); f.next()) {
    const real d_max = f.number % 2 ? 0.3f : clearance::infinity;
    const auto expected = ask(host{}, model, f.s.poses, f.here(), distances_per_part{d_max});
    const std::string what = "frame " + std::to_string(f.number);
    require_same(query(f.s.poses, f.here(), {d_max}), expected, v, what);
    clearance::part_distances enqueued = expected;
    std::fill(enqueued.distance.begin(), enqueued.distance.end(), real(-1)), enqueued.counts = {};
    query.enqueue(f.s.poses, f.here(), {d_max}, {enqueued.distance.data(), &enqueued.counts});
    require_same(enqueued, expected, v, what + ", enqueued");
    CHECK_THROWS_AS(query(f.s.poses, f.here(), {clearance::not_a_number}), std::invalid_argument);
  }
}

}  // namespace distances_per_part_test
