// SPDX-License-Identifier: BSD-3-Clause
// The bracket is true wherever most points are, and the origin of their floats, and the poses.
#include "frames/far_scenes.hpp"

#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distance.hpp>

namespace far_test {

using namespace testing;
using clearance::host, clearance::placed;

namespace {

/// By every way in: plain, by parts, prepared (cold and warm), and with another cloud before and after it.
struct ask_host {
  verdict& v;

  template <class Body, class Source>
  void operator()(const std::vector<Body>& robot, const std::vector<Eigen::Isometry3d>& poses, const Source& source,
                  const truth& t, const std::string& name) const {
    const auto model = model_of(robot);
    const wide distance = t.distance(robot, poses);
    const placed cloud{source, t.pose};
    require_bracket(clearance::ask(host{}, model, poses, cloud, clearance::min_distance{}), distance, v, name);
    require_bracket(clearance::ask(host{}, model, poses, cloud, clearance::min_distance_per_part{}).all, distance, v,
                    name + ", by parts");
    clearance::query query(host{}, model, clearance::min_distance{});
    for (const char* when : {", cold", ", warm"}) require_bracket(query(poses, cloud), distance, v, name + when);
    // A cloud whose floats are exact comes before or after it, near the robot but a little farther: the error is that
    // of both.
    const std::vector<vec3> other = {{0, 0, real(distance) + 3}};
    for (const bool before : {true, false}) {
      clearance::min_distance_result r;
      const placed beside{clearance::point_span(other), poses[0]};
      r = before ? clearance::ask(host{}, model, poses, std::tuple(beside, cloud), clearance::min_distance{})
                 : clearance::ask(host{}, model, poses, std::tuple(cloud, beside), clearance::min_distance{});
      const wide both =
          std::min(distance, truth{{oracle::vec{0, 0, wide(other[0].z)}}, poses[0]}.distance(robot, poses));
      require_bracket(r, both, v, name + (before ? ", the second" : ", the first"));
    }
  }
};

}  // namespace

TEST_CASE("The bracket contains the distance however far most points, and the origin of their floats, are") {
  verdict v;
  each_far_question<ball_body>(300, ask_host{v});
  each_far_question<box_body>(300, ask_host{v});
}

TEST_CASE("The bracket contains the distance at poses as far away as poses may be") {
  verdict v;
  each_far_pose<ball_body>(300, ask_host{v});
  each_far_pose<box_body>(300, ask_host{v});
}

TEST_CASE("A robot near the origin of the floats has a bracket of micrometres, whatever is far away") {
  dice d(93);
  verdict v;
  for (int round = 0; round < 50; ++round) {
    far_scene<box_body> s(d, 4 * round + 1);  // with points near it, somewhere up to 1e7 m from 0
    const auto model = model_of(s.robot);
    s.each_source([&](const auto& source, const truth& t, const std::string& name) {
      if (name.find("less the robot") == name.npos) return;
      const auto r = clearance::ask(host{}, model, s.poses, placed{source, t.pose}, clearance::min_distance{});
      if (r.distance < 5)
        v.require(r.upper - r.lower < 100e-6f + 0x1p-42f * (s.world_from_cloud.translation().norm() + s.middle.norm()),
                  name, ": from", r.lower, " to", r.upper);
    });
  }
}

TEST_CASE(
    "A source that may be off by about as much as it measures leaves nothing free, and one that says no number is "
    "refused") {
  const std::vector<inner_sphere> ball{{{0, 0, 0}, 1}};
  const clearance::model robot{std::vector{clearance::make_part(clearance::build<clearance::sphere>(ball))}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const std::vector<vec3> point{{1.6f, 0, 0}};
  const auto asked = [&](const clearance::position_error& off) {
    clearance::point_span source(point);
    source.off = off;
    const auto near = clearance::ask(host{}, robot, poses, source, clearance::in_collision{{0.5}}).state;
    const auto r = clearance::ask(host{}, robot, poses, source, clearance::min_distance{});
    return std::tuple(near, r.state, r.lower);
  };
  const std::tuple nothing(clearance::state::possible, clearance::state::possible, real(0));
  for (const double relative : {0.25, 0.4999, 0.49999999, 0.5, 0.5000003, 3.0}) {
    INFO(relative);
    CHECK(asked({0, relative}) == nothing);
  }
  const double no = clearance::not_a_number, endless = clearance::infinity;
  for (const clearance::position_error& off : std::vector<clearance::position_error>{
           {0, no}, {no, 0}, {no, 0.01}, {-1, 0}, {0, -1}, {endless, 0}, {0, endless}}) {
    INFO(off.absolute << " and " << off.relative);
    CHECK_THROWS_AS(asked(off), std::invalid_argument);
  }
  CHECK(std::get<0>(asked({})) == clearance::state::free);
  CHECK(std::get<1>(asked({0, 0.2})) == clearance::state::free);
  CHECK(std::get<0>(asked({0, 0.2})) == clearance::state::possible);
}

TEST_CASE("What a source's positions have lost is no more than it says") {
  dice d(94);
  verdict v;
  const auto check = [&](const auto&, const auto&, const auto& source, const truth& t, const std::string& name) {
    const auto off = clearance::rounding_of(source);
    for (std::size_t i = 0; i < source.size(); ++i) {
      if (!t.points[i]) continue;
      const auto p = wider(source[i].position);
      v.require(oracle::between(p, *t.points[i]) <= off.absolute + off.relative * oracle::length(*t.points[i]), name,
                ", point", i);
    }
  };
  each_far_question<ball_body>(300, check);
  CHECK(clearance::rounding_of(clearance::point_span{}).relative == 0);
  CHECK(clearance::rounding_of(clearance::strided_points<float>{}).relative == 0);
}

}  // namespace far_test
