// SPDX-License-Identifier: BSD-3-Clause
// Is a point within a margin, and which is the first? As a loop over all points and primitives says.
#include "support/brute_distances.hpp"
#include "support/frames.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace in_collision_test {

using namespace testing;
using clearance::host, clearance::in_collision, clearance::placed, clearance::point_span, clearance::state;

namespace {

/// The first pair (point, part) that is certainly within its margin, and the first that may be.
template <class P>
clearance::collision_result brute(const scene<P>& s, const clouds& all, const std::vector<double>& margins) {
  const auto error = error_of(s, all);
  clearance::collision_result r;
  for (const auto& cloud : all)
    for (std::size_t i = 0; i < cloud.source.size(); ++i) r.counts.valid += cloud.source[i].valid();
  if (r.counts.valid != 0) r.state = state::free;
  for_each_pair(s, all, [&](const clearance::pair_distance& pair) {
    const long double d = pair.distance, off = error.here + (long double)(error.per_metre) * std::abs(d);
    const state its = d + off <= margins[pair.part]   ? state::collision
                      : d - off <= margins[pair.part] ? state::possible
                                                      : state::free;
    if (its == state::free || r.state == state::collision || its == r.state) return;
    r.state = its, r.cloud = pair.cloud, r.point = pair.point, r.part = pair.part;
  });
  return r;
}

template <class V, class P>
void all_scenes() {
  verdict v;
  std::size_t states[4] = {};
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const double margin : {-0.1, 0.0, 1e-7, 0.02, 0.3}) {
      std::vector<double> margins(s.parts.size(), margin * s.size);
      for (const bool own : {false, true}) {
        if (own) margins[0] = 2 * margin * s.size;
        const auto expected = brute(s, two, margins);
        for (const unsigned threads : {0u, 1u}) {
          const auto r = own ? ask(host{threads}, model, s.poses, two, in_collision{{margins}})
                             : ask(host{threads}, model, s.poses, two, in_collision{{margins[0]}});
          v.require(r.state == expected.state && r.cloud == expected.cloud && r.point == expected.point &&
                        r.part == expected.part && r.counts.valid == expected.counts.valid,
                    s.name, ", margin ", margin, own ? ", one a part" : "", ": ", to_string(r.state), " and not ",
                    to_string(expected.state), ", point ", r.point, " and not ", expected.point, ", part ", r.part,
                    " and not ", expected.part);
        }
        ++states[int(expected.state)];
      }
    }
  }
  CHECK((states[int(state::free)] > 5 && states[int(state::collision)] > 5));
}

}  // namespace

TEST_CASE("A point within a margin of inner spheres is found, the first that is certain") {
  all_scenes<clearance::sphere, inner_sphere>();
}
TEST_CASE("A point within a margin of triangles is found, the first that is certain") {
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("What rounding leaves open of a depth is possible, too") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 4}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  verdict v;
  dice d(96);
  for (const vec3 p : d.points(200, 2)) {
    const std::vector<vec3> point{p};
    const double computed = ball[0].distance(p);
    const auto error = clearance::ask(host{}, robot, poses, point_span(point), clearance::distances{}).certain.error;
    const double off = error.at(real(computed));
    const auto ask = [&](double margin) {
      return clearance::ask(host{}, robot, poses, point_span(point), in_collision{{margin}}).state;
    };
    for (const double part : {0.2, 0.9, 0.999}) {
      v.require(ask(computed - part * off) == state::possible, computed, " m deep, margin less by ", part,
                " of its error: ", to_string(ask(computed - part * off)));
      v.require(ask(computed + part * off) == state::possible, computed, " m deep, margin more by ", part,
                " of its error");
    }
    v.require(ask(computed - 1.1 * off) == state::free && ask(computed + 1.1 * off) == state::collision, computed,
              " m deep: what is certain");
  }
}

TEST_CASE("What gap and tolerance leave open is possible, and no point says nothing") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> far{{3, 0, 0}, {1.5f, 0, 0}}, near{{1.2f, 0, 0}, {1.05f, 0, 0}};
  const auto ask = [&](double gap, double tolerance, const std::vector<vec3>& points, double margin) {
    const clearance::model robot{
        std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball), gap, tolerance)}};
    return clearance::ask(host{}, robot, poses, point_span(points), in_collision{{margin}});
  };
  CHECK(ask(0, 0, far, 0.49).state == state::free);
  CHECK((ask(0.02, 0, far, 0.49).state == state::possible && ask(0.02, 0, far, 0.49).point == 1));
  CHECK((ask(0.02, 0, far, 0.51).state == state::collision && ask(0, 0.02, far, 0.51).state == state::possible));
  CHECK((ask(0.2, 0, near, 0.1).state == state::collision &&
         ask(0.2, 0, near, 0.1).point == 1));  // the first is only possible
  CHECK(ask(clearance::infinity, 0, far, 0).state == state::possible);
  CHECK(ask(0, 0, {}, 1).state == state::no_data);
  CHECK_THROWS_AS(ask(0, 0, far, clearance::not_a_number), std::invalid_argument);
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  CHECK_THROWS_AS(clearance::ask(host{}, robot, poses, point_span(far), in_collision{{0.1, 0.2}}),
                  std::invalid_argument);
}

TEST_CASE("Of two pieces' answers the certain one counts, then the first, whichever is merged into the other") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball), 0.3)}};
  verdict v;
  dice d(97);
  std::size_t states[4] = {};
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<vec3> all = d.points(6, 1.8);
    const auto ask = [&](std::uint32_t begin, std::uint32_t end) {
      auto r = clearance::ask(host{}, robot, poses, point_span(std::span(all).subspan(begin, end - begin)),
                              in_collision{{0.1}});
      if (r.cloud != clearance::none) r.point += begin;
      return r;
    };
    const auto whole = ask(0, 6);
    ++states[int(whole.state)];
    for (const std::uint32_t cut : {0u, 1u, 3u, 6u})
      for (const bool turned : {false, true}) {
        auto r = turned ? ask(cut, 6) : ask(0, cut);
        in_collision::merge(r, turned ? ask(0, cut) : ask(cut, 6));
        v.require(r.state == whole.state && r.cloud == whole.cloud && r.point == whole.point && r.part == whole.part &&
                      r.counts.valid == 6,
                  "cut at ", cut, turned ? ", turned: " : ": ", to_string(r.state), " of point ", r.point, " and not ",
                  to_string(whole.state), " of ", whole.point);
      }
  }
  CHECK((states[int(state::free)] > 5 && states[int(state::possible)] > 5 && states[int(state::collision)] > 5));
}

TEST_CASE("Of a robot without parts nothing is known, whatever is asked") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  const clearance::model_view<decltype(robot)::view_type> no_parts{nullptr, {}, 0, 0};
  const std::span<const Eigen::Isometry3d> no_poses;
  const std::vector<vec3> point{{1.5f, 0, 0}};
  const auto nearest = ask(host{}, no_parts, no_poses, point_span(point), clearance::min_distance{});
  const auto near = ask(host{}, no_parts, no_poses, point_span(point), in_collision{{0.1}});
  CHECK((nearest.state == state::no_data && nearest.valid == 1));
  CHECK((near.state == state::no_data && near.counts.valid == 1 && near.point == clearance::none));
}

TEST_CASE(
    "A prepared question of collision says in every frame what one call says, and goes on after one that is refused") {
  verdict v;
  moving_frames f(5, 113);
  const auto model = f.model();
  clearance::query query(host{}, model, in_collision{});
  const auto same = [](const clearance::collision_result& a, const clearance::collision_result& b) {
    return a.state == b.state && a.cloud == b.cloud && a.point == b.point && a.part == b.part &&
           a.counts.valid == b.counts.valid;
  };
  std::size_t states[4] = {};
  for (; f.there(); f.next()) {
    const std::vector<double> margins(f.number % 2 ? 5 : 1, f.number < 4 ? 0.01 : -0.05);
    const auto expected = ask(host{}, model, f.s.poses, f.here(), in_collision{{margins}});
    ++states[int(expected.state)];
    v.require(same(query(f.s.poses, f.here(), {margins}), expected), "frame ", f.number, ": ",
              to_string(expected.state));
    clearance::collision_result enqueued;
    query.enqueue(f.s.poses, f.here(), {margins}, &enqueued);
    v.require(same(enqueued, expected), "frame ", f.number, ", enqueued: ", to_string(enqueued.state), " and not ",
              to_string(expected.state));
    CHECK_THROWS_AS(query(f.s.poses, f.here(), {{clearance::not_a_number}}), std::invalid_argument);
    CHECK_THROWS_AS(query(f.s.poses, f.here(), {{0.1, 0.2}}), std::invalid_argument);
  }
  CHECK((states[int(state::free)] > 0 && states[int(state::collision)] > 0 && states[int(state::no_data)] == 1));
}

}  // namespace in_collision_test
