// SPDX-License-Identifier: BSD-3-Clause
// A device gives the host's answers about motions and every part's witness, to the bit.
#include "support/brute_pairs.hpp"
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/device.cuh>
#include <clearance/motion_clearance.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace motion_clearance_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span;

namespace {

template <class V, class P>
void like_the_host() {
  verdict v;
  const device on{};
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto there = model.on(on);
    const placed<point_span> cloud{point_span(s.points), s.cloud_pose};
    const auto minima = ask(host{}, model, s.poses, cloud, clearance::min_distance_per_part{}).parts;
    const auto expected = ask(host{}, model, s.poses, cloud, clearance::part_witnesses{minima}),
               found = ask(on, there, s.poses, cloud, clearance::part_witnesses{minima});
    for (std::size_t k = 0; k < expected.size(); ++k)
      v.require(same_witness(found[k], expected[k]), s.name, ": the witness of part", k);
    std::vector<Eigen::Isometry3d> to;
    for (const auto& pose : s.poses)
      to.push_back(shifted(0.2 * s.size, 0, 0) * pose * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
    const clearance::straight_motion motion(s.poses, to);
    const clearance::motion_clearance_options options{.tolerance = 0.01 * s.size, .most_queries = 21};
    const auto a = motion_clearance(host{}, model, motion, cloud, options),
               b = motion_clearance(on, there, motion, cloud, options);
    v.require(a.state == b.state && same_bits(a.lower, b.lower) && same_bits(a.upper, b.upper) && a.part == b.part &&
                  a.queries == b.queries && (a.time == b.time || a.state == clearance::state::no_data) &&
                  a.nearest.point == b.nearest.point,
              s.name, ": lower", a.lower, " and", b.lower);
  }
}

}  // namespace

TEST_CASE("Motions and witnesses on a device are the host's: spheres") {
  like_the_host<clearance::aabb, inner_sphere>();
}
TEST_CASE("Motions and witnesses on a device are the host's: triangles") {
  like_the_host<clearance::sphere, triangle>();
}

}  // namespace motion_clearance_test
