// SPDX-License-Identifier: BSD-3-Clause
// Points within a distance are those of a plain loop over all points and primitives, in order.
#include "support/brute_within.hpp"
#include "support/frames.hpp"

#include <clearance/make_model.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace within_test {

using namespace testing;
using clearance::host, clearance::placed, clearance::point_span, clearance::within;

namespace {

template <class V, class P>
void all_scenes() {
  verdict v;
  std::size_t found = 0;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const real radius : {real(-0.02), real(0), real(0.1), clearance::infinity}) {
      std::vector<real> own(s.parts.size(), radius * real(s.size));
      const std::string what = s.name + ", within " + std::to_string(radius);
      require_same(ask(host{}, model, s.poses, two, within{{own[0]}}), brute_within(s, two, own), v, what);
      own[0] *= 2;
      const auto r = ask(host{1}, model, s.poses, two, within{{own.begin(), own.end()}});
      require_same(r, brute_within(s, two, own), v, what + ", one a part");
      found += r.pairs.size();
    }
  }
  CHECK(found > 10000);
}

}  // namespace

TEST_CASE("Points within a distance of inner spheres are all of them, in order") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("Points within a distance of triangles are all of them, in order") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("A list longer than its first room is whole, and one of the caller's says that it was cut") {
  const auto s = two_balls();
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const std::vector cloud{placed{point_span(s.points)}};
  const auto all = ask(host{}, model, s.poses, cloud, within{{10}});
  CHECK(all.pairs.size() == 100000);
  std::vector<clearance::pair_distance> pairs(100);
  unsigned long long count = 0;
  clearance::point_counts counts;
  enqueue(host{}, model, s.poses, cloud, within{{10, 10}}, {pairs.data(), pairs.size(), &count, &counts});
  CHECK((count == 100000 && counts.valid == 50000 && pairs[99].distance > 0));
  CHECK_THROWS_AS(ask(host{}, model, s.poses, cloud, within{{clearance::not_a_number}}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, model, s.poses, cloud, within{{1, 1, 1}}), std::invalid_argument);
}

TEST_CASE("A prepared list says in every frame what one call says, and goes on after one that is refused") {
  verdict v;
  moving_frames f(5, 112);
  const auto model = f.model();
  clearance::query query(host{}, model, within{{0.0}});
  std::size_t listed = 0;
  for (; f.there(); f.next()) {
    // That of frame 4 is a longer list than there is room for at first.
    const within question{std::vector<double>(f.number % 2 ? 5 : 1, f.number == 4 ? 10 : 0.3f)};
    const auto expected = ask(host{}, model, f.s.poses, f.here(), question);
    listed = std::max(listed, expected.pairs.size());
    const std::string what = "frame " + std::to_string(f.number);
    require_same(query(f.s.poses, f.here(), question), expected, v, what);
    std::vector<clearance::pair_distance> pairs(expected.pairs.size());
    unsigned long long count = 77;
    clearance::point_counts counts;
    query.enqueue(f.s.poses, f.here(), question, {pairs.data(), pairs.size(), &count, &counts});
    require_listed(pairs, count, expected, v, what + ", enqueued");
    CHECK(counts.valid == expected.counts.valid);
    CHECK_THROWS_AS(query(f.s.poses, f.here(), {{clearance::not_a_number}}), std::invalid_argument);
    CHECK_THROWS_AS(query(f.s.poses, f.here(), {{1, 1, 1}}), std::invalid_argument);
  }
  CHECK(listed > 1 << 16);
}

}  // namespace within_test
