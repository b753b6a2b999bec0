// SPDX-License-Identifier: BSD-3-Clause
// Every part's distance to every point is that of a plain loop, and the least of them is the point's distance.
#include "support/brute_per_part.hpp"
#include "support/question_laws.hpp"

#include <clearance/make_model.hpp>
#include <clearance/volume/sphere.hpp>

namespace distances_per_part_test {

using namespace testing;
using clearance::distances_per_part, clearance::host;

TEST_CASE("Every part's distance to every point is brute force's, to the bit, and their least that of distances") {
  per_part_cases cases;
  hold_in_all_scenes<clearance::sphere, inner_sphere>(cases, host{});
  CHECK((cases.near > 1000 && cases.far > 1000));
  verdict v;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const distances_per_part& q : cases.of_scene(s)) {
      const std::string what = s.name + ", d_max " + std::to_string(q.d_max);
      const auto found = ask(host{}, model, s.poses, two, q);
      const auto least = ask(host{}, model, s.poses, two, clearance::distances{q.d_max});
      for (std::size_t i = 0; i < found.points; ++i) {
        real nearest = found.of(0)[i];
        for (std::size_t k = 1; k < s.parts.size(); ++k) nearest = found.of(k)[i] < nearest ? found.of(k)[i] : nearest;
        v.require(nearest != nearest ? least.distance[i] != least.distance[i] : nearest == least.distance[i], what,
                  ": the least of point", i, " is", nearest, " and not", least.distance[i]);
      }
      v.require(same_bits(found.certain.lower(1), least.certain.lower(1)), what, ": another certainty");
    }
  }
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
  per_part_cases cases;
  hold_in_every_frame(cases, host{}, 5, 116);
}

}  // namespace distances_per_part_test
