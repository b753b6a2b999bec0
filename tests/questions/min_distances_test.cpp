// SPDX-License-Identifier: BSD-3-Clause
// The least distances of many configurations are those of one at a time, in every bit.
#include "minimum/edge_scenes.hpp"
#include "solid/shapes.hpp"
#include "support/brute_pairs.hpp"
#include "support/closed.hpp"
#include "support/configurations.hpp"
#include "support/linked_tree.hpp"
#include "support/volumes.hpp"
#include "support/wide_tree.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace min_distances_test {

using namespace testing;
using clearance::host, clearance::in_collisions, clearance::infinity, clearance::min_distance, clearance::min_distances,
    clearance::min_distances_per_part, clearance::placed, clearance::point_span, clearance::state;

namespace {

/// Against one at a time, for a few reaches; one prepared question for all of them, frame after frame.
template <class Model, class Clouds>
void check(const Model& model, std::size_t parts, const configurations& poses, const Clouds& clouds, double size,
           verdict& v, const std::string& what) {
  clearance::query query(host{}, model, min_distances{});
  const auto one = [&](auto own) { return ask(host{1}, model, own, clouds, min_distance{}); };
  for (const double d_max : {-0.05, 0.0, 0.2, 1.0, double(infinity)}) {
    const real most = real(d_max * size);
    const std::string which = what + ", d_max " + std::to_string(most);
    require_same(query(poses, clouds, {most}), poses, parts, most, one, v, which + ", prepared");
    require_same(ask(host{1}, model, poses, clouds, min_distances{most}), poses, parts, most, one, v, which);
  }
}

template <class V, class P>
void all_scenes() {
  verdict v;
  dice d(411);
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto poses = configurations_of(s, d);
    for (const std::uint32_t width : {2, 8}) {
      const auto model = make_model<V>(s, {.width = width}, clearance::wrapped{});
      check(model, s.parts.size(), poses, placed{all.span, s.cloud_pose}, s.size, v, s.name);
      const auto several =
          std::tuple(placed{all.raw, all.camera_pose}, std::vector(2, placed{all.doubles, s.cloud_pose}),
                     placed{all.metres, all.camera_pose});
      check(model, s.parts.size(), poses, several, s.size, v, s.name + ", several clouds");
    }
  }
}

/// Each part's are those of a robot that has no other part.
template <class V, class P>
void all_parts() {
  verdict v;
  dice d(431);
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto poses = configurations_of(s, d);
    const std::size_t parts = s.parts.size();
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto clouds = std::tuple(placed{all.raw, all.camera_pose}, std::vector(2, placed{all.doubles, s.cloud_pose}));
    clearance::query query(host{}, model, min_distances_per_part{});
    for (const double d_max : {0.2, double(infinity)}) {
      const real most = real(d_max * s.size);
      const auto found = ask(host{1}, model, poses, clouds, min_distances_per_part{most});
      const auto& prepared = query(poses, clouds, {most});
      v.require(found.size() == poses.size() / parts && prepared.size() == found.size(), s.name,
                ": another number of configurations");
      for (std::size_t k = 0; k < parts; ++k) {
        clearance::min_distances_result its;
        configurations own;
        for (std::size_t c = 0; c < found.size() && c < prepared.size(); ++c) {
          auto r = found.of(c)[k];
          v.require(same_result(r, prepared.of(c)[k]), s.name, ", configuration", c, ", part", k,
                    ": another result, prepared");
          v.require(r.part == k || (r.part == clearance::none && r.point == clearance::none), s.name, ": part", r.part,
                    " and not", k);
          if (r.part == k) r.part = 0;
          its.of.push_back(r);
          own.push_back(poses[c * parts + k]);
        }
        require_same(
            its, own, 1, most,
            [&](auto pose) { return ask(host{1}, model.parts()[k], pose[0], clouds, min_distance{}); }, v,
            s.name + ", part " + std::to_string(k));
      }
    }
  }
}

/// Which are in collision: in_collision's states, for a few margins; one a part too, of which one is another.
template <class Model, class Clouds>
void check_states(const Model& model, std::size_t parts, const configurations& poses, const Clouds& clouds, double size,
                  verdict& v, const std::string& what, std::size_t (&states)[4]) {
  clearance::query query(host{}, model, in_collisions{});
  for (const double margin : {-0.1, -0.01, 0.0, 1e-7, 0.02, 0.3, double(infinity)})
    for (const bool own : {false, true}) {
      std::vector<double> margins(own ? parts : 1, margin * size);
      if (own) margins[0] *= 3;
      const auto found = ask(host{1}, model, poses, clouds, in_collisions{{margins}});
      v.require(found.of.size() * parts == poses.size() && query(poses, clouds, {margins}).of == found.of, what,
                ": another number, or other states if prepared");
      for (std::size_t c = 0; c < found.of.size(); ++c) {
        const auto one =
            ask(host{1}, model, std::span(poses).subspan(c * parts, parts), clouds, clearance::in_collision{{margins}});
        v.require(found.of[c] == one.state, what, ", margin", margins[0], ", configuration", c, ": ",
                  to_string(found.of[c]), " and not ", to_string(one.state));
        v.require(found.counts.seen == one.counts.seen && found.counts.valid == one.counts.valid, what,
                  ": other counts");
        ++states[int(one.state)];
      }
    }
}
template <class V, class P>
void all_states() {
  verdict v;
  dice d(421);
  std::size_t states[4] = {};
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto poses = configurations_of(s, d);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    check_states(model, s.parts.size(), poses, placed{all.span, s.cloud_pose}, s.size, v, s.name, states);
    const auto several = std::tuple(placed{all.raw, all.camera_pose},
                                    std::vector(2, placed{all.doubles, shifted(1000, 0, 0) * s.cloud_pose}));
    check_states(model, s.parts.size(), poses, several, s.size, v, s.name + ", several clouds", states);
  }
  CHECK((states[int(state::free)] > 20 && states[int(state::collision)] > 20));
}

/// A backend of somebody else's, without a search of its own.
struct own_backend : host {};

/// No ball, though it shows a middle, a radius, and one ball around it.
struct padded {
  vec3 center;
  real radius, padding;  ///< It ends at their sum.

  static padded fit(std::span<const clearance::ball> balls) {
    const auto all = clearance::sphere::fit(balls);
    return {all.center, all.radius / 8, all.radius};
  }
  real lower_bound(vec3 q) const { return clearance::sphere{center, radius + padding}.lower_bound(q); }
  std::array<clearance::ball, 1> balls() const { return {{{center, radius + padding}}}; }
};

}  // namespace

TEST_CASE("Least distances of many configurations of inner spheres are those of each") {
  all_scenes<clearance::sphere, inner_sphere>();
  all_scenes<clearance::obb, inner_sphere>();
  all_scenes<kdop14, inner_sphere>();
}
TEST_CASE("Least distances of many configurations of triangles are those of each") {
  all_scenes<clearance::sphere, triangle>();
  all_scenes<clearance::aabb, triangle>();
}

TEST_CASE("Each part's least distances of many configurations of inner spheres are those of the part alone") {
  all_parts<clearance::sphere, inner_sphere>();
}
TEST_CASE("Each part's least distances of many configurations of triangles are those of the part alone") {
  all_parts<clearance::aabb, triangle>();
}

TEST_CASE("Which of many configurations of inner spheres are in collision is what each says") {
  all_states<clearance::sphere, inner_sphere>();
}
TEST_CASE("Which of many configurations of triangles are in collision is what each says") {
  all_states<clearance::aabb, triangle>();
}

TEST_CASE("So they are of robots and clouds of extreme numbers") {
  verdict v;
  std::size_t states[4] = {};
  dice d(412);
  for (const auto& s : edge_scenes()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto poses = configurations_of(s, d, 4);
    check(model, s.parts.size(), poses, placed{point_span(s.points), s.cloud_pose}, s.size, v, s.name);
    check_states(model, s.parts.size(), poses, placed{point_span(s.points), s.cloud_pose}, s.size, v, s.name, states);
  }
}

TEST_CASE("Points inside solids are 0 away of every configuration, certainly or perhaps, and the lowest goes first") {
  verdict v;
  dice d(413);
  std::size_t inside = 0, uncertain = 0, states[4] = {};
  for (const double tolerance : {0.0, 0.3, 2.0}) {
    const auto model = clearance::make_model<clearance::aabb>(std::vector(2, clearance::close_mesh(shapes::cube(1))),
                                                              clearance::part_options{.tolerance = tolerance});
    configurations poses;
    for (int c = 0; c < 60; ++c)
      for (int k = 0; k < 2; ++k) poses.push_back(d.pose(0.1 * c));
    for (const std::size_t points : {3u, 40u, 3000u}) {
      const auto cloud = d.points(points, 3);
      check(model, 2, poses, placed{point_span(cloud), d.pose(0.1)}, 1, v, std::to_string(points) + " points");
      check_states(model, 2, poses, point_span(cloud), 1, v, std::to_string(points) + " points", states);
      for (const auto& r : ask(host{}, model, poses, cloud, min_distances{}).of)
        inside += r.distance == 0, uncertain += r.distance == 0 && r.state == state::possible;
    }
  }
  CHECK(inside > 100);
  CHECK(uncertain > 50);
  CHECK((states[int(state::free)] > 50 && states[int(state::possible)] > 50 && states[int(state::collision)] > 50));
}

TEST_CASE("A tree of somebody else's, however deep or wide, is a robot's") {
  verdict v;
  dice d(414);
  const auto spheres = random_spheres(d, 200, 0.4);
  const auto points = d.points(3000, 1);
  configurations poses;
  for (int c = 0; c < 20; ++c) poses.push_back(d.pose(1.5));
  const auto around = clearance::enclosing_ball(std::span<const inner_sphere>(spheres));
  const clearance::part_facts facts{around.center, around.radius, 0.001f, 0};
  for (const bool lopsided : {false, true}) {
    const linked_tree<clearance::obb, inner_sphere> tree(spheres, lopsided);
    const clearance::model model{std::vector{clearance::part{tree.view(), clearance::no_interior{}, facts}}};
    check(model, 1, poses, point_span(points), 1, v, lopsided ? "a list" : "a linked tree");
  }
  const auto volumes = wide_volumes<clearance::sphere>(spheres);
  const wide_view<clearance::sphere, inner_sphere> wide{volumes.data(), spheres.data(), 200};
  check(clearance::model{std::vector{clearance::part{wide, clearance::no_interior{}, facts}}}, 1, poses,
        point_span(points), 1, v, "a wide tree");
}

TEST_CASE("A volume is a ball if it says so, and not because it has a middle and a radius") {
  static_assert(clearance::round_volume<clearance::sphere> && clearance::bounding_volume<padded> &&
                !clearance::round_volume<padded>);
  verdict v;
  const auto s = scenes<inner_sphere>()[0];
  dice d(419);
  const auto model = make_model<padded>(s, {}, clearance::wrapped{});
  const auto poses = configurations_of(s, d, 40);
  require_same(
      ask(host{}, model, poses, point_span(s.points), min_distances{}), poses, s.parts.size(), infinity,
      [&](auto own) { return ask(host{}, model, own, point_span(s.points), min_distance{}); }, v, "padded");
}

TEST_CASE("Clouds in order and in none, large ones, and one point far from all others") {
  verdict v;
  dice d(415);
  auto s = crowd(416);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto poses = configurations_of(s, d, 12);
  s.points.push_back({1e6f, -1e6f, 1e5f});
  check(model, 3, poses, point_span(s.points), 1, v, "a crowd");
  std::vector<std::uint16_t> pixels(320 * 240);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = i % 13 == 5 ? 0 : std::uint16_t(900 + 300 * std::sin(double(i % 320) / 40) + d.number(0, 3));
  const clearance::depth_image<std::uint16_t> image(pixels.data(), 320, 240, {260, 260, 159.5, 119.5});
  check(model, 3, poses, placed{image, shifted(0, 0, -1.5)}, 1, v, "an image");
}

TEST_CASE("The monitor of a trajectory: every frame is new, and its answer does not know of the last one") {
  verdict v;
  dice d(417);
  const auto s = scenes<inner_sphere>()[0];
  const auto model = make_model<clearance::aabb>(s, {}, clearance::wrapped{});
  configurations poses;
  for (int c = 0; c < 50; ++c)
    for (const auto& pose : s.poses) poses.push_back(shifted(0.02 * c, 0, 0) * pose);
  clearance::query query(host{}, model, min_distances{});
  for (const std::size_t points : {300, 10, 2000, 0, 500}) {
    const auto cloud = d.points(points, 2);
    const auto one = [&](auto own) { return ask(host{}, model, own, cloud, min_distance{}); };
    require_same(query(poses, cloud), poses, s.parts.size(), infinity, one, v, std::to_string(points) + " points");
    query.begin(poses, cloud, min_distances{});
    require_same(query.finish(), poses, s.parts.size(), infinity, one, v, std::to_string(points) + " points, begun");
    if (points == 10) poses.resize(poses.size() / 2 / s.parts.size() * s.parts.size());
    if (points == 2000) query.forget();
  }
}

TEST_CASE("The first waypoint below a margin, and nothing known is below it") {
  const auto part =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.5f}}), 0.01, 0);
  const clearance::model model{std::vector{part}};
  configurations poses;
  for (int c = 0; c < 10; ++c) poses.push_back(shifted(0.5 * c, 0, 0));
  const std::vector<vec3> wall{{4, 0, 0}};
  const auto found = ask(host{}, model, poses, wall, min_distances{});
  CHECK(found.first_below(0.0) == 7);  // 4 - 3.5 - 0.5, less the gap
  CHECK(found.first_below(0.48) == 7);
  CHECK(found.first_below(0.495) == 6);
  CHECK(found.first_below(clearance::infinity) == 0);
  for (const double nonsense :
       {-1.0, -1e-9, double(clearance::not_a_number)}) {  // the waypoint at the wall is a collision, and its lower is 0
    CHECK_THROWS_AS(found.first_below(nonsense), std::invalid_argument);
    CHECK_THROWS_AS(found.first_below(nonsense, 5), std::invalid_argument);
    CHECK_THROWS_AS(clearance::min_distances_result{}.first_below(nonsense, 5), std::invalid_argument);
  }
  const auto nearby = ask(host{}, model, poses, wall, min_distances{0.6f});
  CHECK(nearby.first_below(0.495) == 6);
  CHECK((nearby.of[0].state == state::free && nearby.of[0].distance == infinity && nearby.of[0].lower > 0.589f &&
         nearby.of[0].lower <= 0.59f));
  CHECK(ask(host{}, model, poses, std::vector<vec3>{}, min_distances{}).first_below(0) == 0);
  CHECK(ask(host{}, model, poses, std::vector<vec3>{{clearance::not_a_number, 0, 0}}, min_distances{}).of[3].state ==
        state::no_data);
}

TEST_CASE("What is no batch is refused, and an empty one is one") {
  const auto s = scenes<inner_sphere>()[0];
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const point_span cloud(s.points);
  configurations poses = s.poses;
  poses.insert(poses.end(), s.poses.begin(), s.poses.end());
  CHECK(ask(host{}, model, configurations{}, cloud, min_distances{}).of.empty());
  CHECK_THROWS_WITH(ask(host{}, model, std::span(poses).first(4), cloud, min_distances{}),
                    "clearance: 4 poses are no whole configurations of 3 parts");
  CHECK_THROWS_AS(ask(host{}, model, poses, cloud, min_distances{clearance::not_a_number}), std::invalid_argument);
  CHECK_THROWS_AS(ask(host{}, model, poses, placed{cloud, Eigen::Isometry3d(Eigen::Scaling(2.0))}, min_distances{}),
                  std::invalid_argument);
  CHECK(ask(host{}, model, configurations{}, cloud, min_distances_per_part{}).size() == 0);
  CHECK_THROWS_WITH(ask(host{}, model, std::span(poses).first(4), cloud, min_distances_per_part{}),
                    "clearance: 4 poses are no whole configurations of 3 parts");
  CHECK_THROWS_AS(ask(host{}, model, poses, cloud, min_distances_per_part{clearance::not_a_number}),
                  std::invalid_argument);
  poses[4].linear() *= 1.5;
  CHECK_THROWS_WITH(
      ask(host{}, model, poses, cloud, min_distances_per_part{}),
      Catch::Matchers::StartsWith("clearance: the pose of configuration 1's part 1 is not rigid: its axes"));
  CHECK_THROWS_WITH(
      ask(host{}, model, poses, cloud, min_distances{}),
      Catch::Matchers::StartsWith("clearance: the pose of configuration 1's part 1 is not rigid: its axes"));
}

TEST_CASE(
    "Which configurations are in collision: what gap and tolerance leave open, what is too close, and what is "
    "refused") {
  const auto part = clearance::make_part(
      clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 0.5f}}), 0.01, 0.02);
  const clearance::model model{std::vector{part}};
  configurations poses;
  for (const double x : {0.0, 2.0, 2.475, 2.485, 2.5, 2.6, 3.0}) poses.push_back(shifted(x, 0, 0));
  const std::vector<vec3> wall{{3, 0, 0}};
  const auto found = ask(host{}, model, poses, wall, in_collisions{{0.005}});
  CHECK((found.of == std::vector{state::free, state::free, state::possible, state::possible, state::possible,
                                 state::collision, state::collision}));
  CHECK((found.first_not_free() == 2 && found.counts.valid == 1));
  CHECK(ask(host{}, model, poses, std::vector<vec3>{}, in_collisions{}).of == std::vector(7, state::no_data));
  const float pixels[] = {3, -infinity};
  const clearance::depth_image image(pixels, 2, 1, {1, 1, 0, 0});
  CHECK(ask(host{}, model, poses, image, in_collisions{}).of == std::vector(7, state::possible));
  CHECK(ask(own_backend{}, model, poses, wall, in_collisions{{0.005}}).of == found.of);
  CHECK(ask(host{}, model, configurations{}, wall, in_collisions{}).of.empty());
  CHECK_THROWS_WITH(ask(host{}, model, poses, wall, in_collisions{{clearance::not_a_number}}),
                    "clearance: the margin of part 0 is not a number");
  CHECK_THROWS_WITH(ask(host{}, model, poses, wall, in_collisions{{0.1, 0.2}}),
                    "clearance: there are 1 parts, but 2 margins");
  poses[4].linear() *= 1.5;
  CHECK_THROWS_WITH(
      ask(host{}, model, poses, wall, in_collisions{}),
      Catch::Matchers::StartsWith("clearance: the pose of configuration 4's part 0 is not rigid: its axes"));
}

TEST_CASE("With a traversal of one's choice each configuration is asked for by itself") {
  verdict v;
  dice d(418);
  const auto s = scenes<triangle>()[0];
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto poses = configurations_of(s, d);
  const placed cloud{point_span(s.points), s.cloud_pose};
  for (const real d_max : {0.1f, real(infinity)})
    require_same(
        ask(clearance::plain{host{}, clearance::stack{}}, model, poses, cloud, min_distances{d_max}), poses,
        s.parts.size(), d_max, [&](auto own) { return ask(host{}, model, own, cloud, min_distance{}); }, v, "plain");
}

TEST_CASE("Results of several trajectories are taken apart by their horizon") {
  const auto model =
      clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{{{{0, 0, 0}, 0.1f}}});
  std::vector<Eigen::Isometry3d> poses;
  for (const double x : {0.0, 1.0, 1.85, 1.9, 0.0, 0.0}) poses.push_back(shifted(x, 0, 0));
  const auto found = ask(host{}, model, poses, std::vector<vec3>{{2, 0, 0}}, min_distances{});
  CHECK(found.first_below(0.08) == 2);
  CHECK(found.first_below(0.08, 3) == std::vector<std::size_t>{2, 0});
  CHECK(found.first_below(0.08, 2) == std::vector<std::size_t>{2, 0, 2});
  CHECK(found.trajectory(1, 2)[1].distance == found.of[3].distance);
  CHECK_THROWS_AS(found.first_below(0.08, 4), std::invalid_argument);
  CHECK_THROWS_AS(found.first_below(0.08, 0), std::invalid_argument);
  CHECK_THROWS_AS(found.trajectory(3, 2), std::out_of_range);
  const auto states = ask(host{}, model, poses, std::vector<vec3>{{2, 0, 0}}, in_collisions{{0.08}});
  CHECK(states.first_not_free() == 2);
  CHECK(states.first_not_free(3) == std::vector<std::size_t>{2, 0});
  CHECK(states.first_not_free(2) == std::vector<std::size_t>{2, 0, 2});
  CHECK(states.trajectory(1, 2)[1] == states.of[3]);
  CHECK_THROWS_AS(states.first_not_free(4), std::invalid_argument);
  CHECK_THROWS_AS(states.trajectory(3, 2), std::out_of_range);
  const auto none = ask(host{}, model, std::vector<Eigen::Isometry3d>{}, std::vector<vec3>{}, min_distances{});
  CHECK(none.first_below(0, 7).empty());
}

namespace {

/// Clouds in which very many points are in one place, or nearly, alone or among others, with their numbers mixed.
std::vector<std::pair<std::string, std::vector<vec3>>> crowds(dice& d, std::size_t count) {
  std::vector<std::pair<std::string, std::vector<vec3>>> all;
  const auto cell = [&](vec3 at, real size) {
    return at + vec3{d.number(0, size), d.number(0, size), d.number(0, size)};
  };
  std::vector<vec3> equal(count, vec3{1.1f, 0.3f, 0.2f}), near, at_zero, image, mixed;
  for (std::size_t i = 0; i < count; ++i) {
    near.push_back(cell({1.1f, 0.3f, 0.2f}, 1e-6f));
    at_zero.push_back(cell({1.1f, 0, 0}, 1e-6f));
    image.push_back({1.1f, 1e-9f * real(i % 100), 1e-9f * real(i / 100)});
    mixed.push_back(i % 3 == 0 ? equal[0] : i % 3 == 1 ? cell({1.1f, 0.3f, 0.2f}, 1e-3f) : cell({-2, -2, -2}, 6));
  }
  all = {{"equal", equal},
         {"in a cell", near},
         {"in a cell at 0", at_zero},
         {"an image of nothing", image},
         {"among others", mixed}};
  return all;
}

template <class Model>
void check_crowds(const Model& model, verdict& v, const std::string& what) {
  dice d(434);
  configurations poses;
  for (int c = 0; c < 12; ++c)
    for (std::size_t k = 0; k < model.size(); ++k)
      poses.push_back(c == 0 ? shifted(0.125 * double(k), 0, 0) : d.pose(c < 6 ? 0.3 : 1.2));
  for (const auto& [name, points] : crowds(d, 20000)) {
    const auto one = [&, &points = points](auto own) { return ask(host{}, model, own, points, min_distance{}); };
    for (const double d_max : {0.5, double(infinity)})
      require_same(ask(host{}, model, poses, points, min_distances{real(d_max)}), poses, model.size(), real(d_max), one,
                   v, what + ", " + name);
  }
}

}  // namespace

TEST_CASE("Of very many points in one place, or nearly, the lowest is found, as of any others") {
  verdict v;
  dice d(433);
  std::vector<std::vector<inner_sphere>> balls(2);
  for (auto& its : balls)
    for (int i = 0; i < 60; ++i)
      its.push_back(
          {clearance::scaled(0.3f, vec3{d.number(-1, 1), d.number(-1, 1), d.number(-1, 1)}), d.number(0.01f, 0.05f)});
  check_crowds(clearance::make_model<clearance::sphere>(balls), v, "spheres");
  check_crowds(clearance::make_model<clearance::obb>(balls), v, "spheres in boxes");
  const auto closed = closed_scene(12);
  check_crowds(clearance::make_model<clearance::obb>(closed.meshes), v, "solids");
  check_crowds(clearance::make_model<clearance::sphere>(closed.meshes), v, "solids in balls");
}

}  // namespace min_distances_test
