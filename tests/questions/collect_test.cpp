// SPDX-License-Identifier: BSD-3-Clause
// An answer gets every pair within reach once, as all points with all primitives say, in every bit.
#include "solid/shapes.hpp"
#include "support/product.hpp"
#include "support/tallied.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace collect_test {

using namespace testing;
using clearance::collect, clearance::host, clearance::placed, clearance::point_span;

namespace {

template <class V, class P>
void collect_all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    for (const real farthest : {real(-0.1), real(0), real(0.3), real(5), clearance::infinity}) {
      tally_of_pairs expected, found, of_two, one_thread;
      brute_tally(s, s.points, s.cloud_pose, 0, farthest, nothing_inside, expected);
      const placed cloud{point_span(s.points), s.cloud_pose};
      const std::string what = s.name + ", within " + std::to_string(farthest);
      const auto counts = clearance::ask(host{}, model, s.poses, cloud, collect{tallied{farthest, found.words}});
      v.require(found == expected, what, ": other pairs than brute force's");
      const auto r = clearance::ask(host{}, model, s.poses, cloud, clearance::min_distance{});
      v.require(counts.seen == r.seen && counts.valid == r.valid && std::ranges::equal(counts.dropped, r.dropped), what,
                ": other counts");
      clearance::ask(host{1}, model, s.poses, cloud, collect{tallied{farthest, one_thread.words}});
      v.require(one_thread == expected, what, ": other pairs with one thread");
      clearance::query query(host{}, model, collect{tallied{farthest, found.words}});
      for (int frame = 0; frame < 2; ++frame) {
        tally_of_pairs prepared, enqueued;
        clearance::point_counts seen;
        v.require(query(s.poses, cloud, {{farthest, prepared.words}}).valid == counts.valid && prepared == expected,
                  what, ": other pairs, prepared");
        query.enqueue(s.poses, cloud, {{farthest, enqueued.words}}, {&seen});
        v.require(seen.valid == counts.valid && enqueued == expected, what, ": other pairs, enqueued");
      }
      brute_tally(s, s.points, s.cloud_pose, 1, farthest, nothing_inside, expected);
      clearance::ask(host{}, model, s.poses, std::vector(2, cloud), collect{tallied{farthest, of_two.words}});
      v.require(of_two == expected, what, ": other pairs of two clouds");
    }
  }
}

}  // namespace

TEST_CASE("Every pair of a point and inner spheres within reach comes to an answer once") {
  collect_all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("Every pair of a point and triangles within reach comes to an answer once") {
  collect_all_scenes<clearance::obb, triangle>();
}

TEST_CASE("A point inside a solid is a pair of distance 0 without a primitive") {
  const auto model = clearance::make_model<clearance::aabb>(
      std::vector<clearance::closed_mesh>{clearance::close_mesh(shapes::cube(1))});
  scene<triangle> s;
  const auto& tree = model.parts()[0].tree;
  s.parts.emplace_back(tree.primitives.size());
  for (std::size_t k = 0; k < tree.primitives.size(); ++k) s.parts[0][tree.ids[k]] = tree.primitives[k];
  dice d(91);
  s.poses = {d.pose(0.2)};
  s.points = d.points(3000, 2.5);
  s.cloud_pose = d.pose(0.1);
  for (const real farthest : {real(-1), real(0), real(0.5)}) {
    tally_of_pairs expected, found;
    const auto interior = model.parts()[0].interior.view();
    brute_tally(
        s, s.points, s.cloud_pose, 0, farthest, [&](std::uint32_t, vec3 q) { return interior.inside(q); }, expected);
    clearance::ask(host{}, model, s.poses, placed{point_span(s.points), s.cloud_pose},
                   collect{tallied{farthest, found.words}});
    CHECK(found == expected);
    CHECK((farthest < 0 || found.words[0] > 100));
  }
}

}  // namespace collect_test
