// SPDX-License-Identifier: BSD-3-Clause
// How a distance changes as parts move, compared with differences of distances that are asked anew.
#include "support/brute_pairs.hpp"
#include "support/product.hpp"
#include "support/same_result.hpp"

#include <clearance/gradient.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace gradient_test {

using namespace testing;
using clearance::gradient, clearance::gradient_state, clearance::host, clearance::min_distance_per_part,
    clearance::part_minimum, clearance::part_witness, clearance::part_witnesses, clearance::smooth_minimum_of;

namespace {

/// A pose that moves with `v` at `about` and turns by `w`, for a time `h`.
Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& v, const Eigen::Vector3d& w,
                        const Eigen::Vector3d& about, double h) {
  const Eigen::AngleAxisd turn(h * w.norm(), w.normalized());
  Eigen::Isometry3d there = Eigen::Isometry3d::Identity();
  there.linear() = turn * pose.linear();
  there.translation() = turn * (pose.translation() - about) + about + h * v;
  return there;
}

Eigen::Vector3d any(dice& d, double half) {
  return {d.uniform(-half, half), d.uniform(-half, half), d.uniform(-half, half)};
}
vec3 floats(const Eigen::Vector3d& v) { return {real(v.x()), real(v.y()), real(v.z())}; }

/// Few primitives and few points, so that what is nearest stays so in a small motion.
template <class P>
scene<P> sparse(dice& d) {
  scene<P> s{"sparse", {}, {}, d.points(60, 1.5), d.pose(0.5)};
  for (int k = 0; k < 4; ++k) s.parts.push_back(random_primitives<P>(d, 8, 0.3, 0.2)), s.poses.push_back(d.pose(1));
  return s;
}

template <class V, class P>
void against_differences() {
  verdict v;
  dice d(4711);
  const double h = 5e-4;
  std::size_t compared = 0, negative = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto s = sparse<P>(d);
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const clearance::placed cloud{clearance::point_span(s.points), s.cloud_pose};
    const auto [least, minima] = ask(host{}, model, s.poses, cloud, min_distance_per_part{});
    const auto witnesses = ask(host{}, model, s.poses, cloud, part_witnesses{minima});
    const Eigen::Vector3d velocity = any(d, 1), turning = any(d, 1), about = any(d, 2);
    const auto ask = [&](double time) {
      auto poses = s.poses;
      for (auto& pose : poses) pose = moved(pose, velocity, turning, about, time);
      return clearance::ask(host{}, model, poses, cloud, min_distance_per_part{}).parts;
    };
    const auto before = ask(-h), after = ask(h);
    for (std::size_t k = 0; k < minima.size(); ++k) {
      const auto same = [&](const part_minimum& m) {
        return m.point == minima[k].point && m.primitive == minima[k].primitive;
      };
      if (!same(before[k]) || !same(after[k]) || std::abs(minima[k].distance) < 0.02) continue;
      // Between a face and its edge the second derivative jumps, and is at most the square of the speed by the
      // distance.
      const Eigen::Vector3d arm = Eigen::Vector3d(witnesses[k].at.x, witnesses[k].at.y, witnesses[k].at.z) - about;
      const double remainder = h * (velocity + turning.cross(arm)).squaredNorm() / std::abs(double(minima[k].distance));
      const auto g = gradient(witnesses[k], about);
      const double rate = (double(after[k].distance) - double(before[k].distance)) / (2 * h);
      const double said = g.along(floats(velocity), floats(turning));
      v.require(bool(g) && std::abs(said - rate) < 2e-3 + remainder, "part", k, " has", said, " instead of", rate,
                " at", minima[k].distance);
      ++compared, negative += minima[k].distance < 0;
      if (least.part == k) {
        const auto robots = gradient(least, about);
        v.require(robots.linear == g.linear && robots.angular == g.angular, "the robot's gradient is that of its part");
      }
    }
  }
  CHECK(compared > 100);
  if constexpr (std::is_same_v<P, inner_sphere>) CHECK(negative > 0);
}

template <class V, class P>
void of_all_scenes() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const auto model = make_model<V>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    const auto [least, minima] = ask(host{}, model, s.poses, two, min_distance_per_part{});
    const auto all = ask(host{}, model, s.poses, two, part_witnesses{minima});
    v.require(all.size() == minima.size(), s.name);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const part_witness& w = all[k];
      v.require(same_bits(w.distance, minima[k].distance) && w.cloud == minima[k].cloud && w.point == minima[k].point &&
                    w.primitive == minima[k].primitive &&
                    (w.part == k || (w.part == clearance::none && w.point == clearance::none)),
                s.name, ": the witness of part", k);
      if (least.part == k)
        v.require(
            same_bytes(w.at, least.at) && same_bytes(w.nearest, least.nearest) && same_bytes(w.normal, least.normal),
            s.name, ": where the robot's minimum is");
      if (w.part == clearance::none) continue;
      const double away =
          (Eigen::Vector3d(w.at.x, w.at.y, w.at.z) - Eigen::Vector3d(w.nearest.x, w.nearest.y, w.nearest.z)).norm();
      const double size =
          std::abs(double(w.distance)) + Eigen::Vector3d(w.at.x, w.at.y, w.at.z).cwiseAbs().maxCoeff() + 100;
      v.require(std::abs(away - std::abs(double(w.distance))) <= 1e-5 * size, s.name, ": nearest and point are", away,
                " apart, not", w.distance);
    }
    const auto same = [&](const std::vector<part_witness>& other) {
      return std::equal(all.begin(), all.end(), other.begin(), other.end(), same_witness);
    };
    v.require(same(ask(clearance::host{1}, model, s.poses, std::tuple(two[0], two[1]), part_witnesses{minima})), s.name,
              ", clouds of several kinds");
    clearance::query query(host{}, model, part_witnesses{});
    const auto of_one = ask(host{}, model, s.poses, two[0], min_distance_per_part{});
    query(s.poses, two[0], {of_one.parts});
    v.require(same(query(s.poses, two, {minima})), s.name, ", prepared");
    std::vector<part_witness> room(minima.size());
    query.enqueue(s.poses, two, {minima.data(), room.data()});
    v.require(same(room), s.name, ", enqueued");
    query.enqueue(s.poses, std::vector<vec3>(), {minima.data(), room.data()});
    v.require(std::all_of(room.begin(), room.end(), [](const part_witness& w) { return w.part == clearance::none; }),
              s.name, ", of another cloud");
  }
}

/// A cube of half edge 1 that knows its inside.
struct cube_interior {
  CLEARANCE_HD bool inside(vec3 p) const {
    return clearance::absolute(p.x) < 1 && clearance::absolute(p.y) < 1 && clearance::absolute(p.z) < 1;
  }
};

}  // namespace

TEST_CASE("The witness of a capsule that begins inside a solid is where it begins") {
  struct swept {
    vec3 from, along;
    std::size_t size() const { return 1; }
    clearance::sample operator[](std::size_t) const { return {from, clearance::drop_reason::none}; }
    clearance::capsule around(std::size_t, vec3 p) const { return {p, along, 0}; }
  };
  std::vector<triangle> faces{triangle::from({1, -9, -9}, {1, 9, -9}, {1, 0, 9})};
  auto surface = clearance::make_part(clearance::build<clearance::obb>(faces));
  using cube = clearance::part<decltype(surface.tree), cube_interior>;
  const clearance::model robot{std::vector{cube{surface.tree, {}, surface.facts}}};
  const std::vector poses{Eigen::Isometry3d::Identity()};
  for (const vec3 from : {vec3{0.5f, 0, 0}, vec3{1.5f, 0, 0}}) {
    const swept cloud{from, {0.25f, 0, 0}};
    const auto [least, minima] = ask(host{}, robot, poses, cloud, min_distance_per_part{});
    const part_witness w = ask(host{}, robot, poses, cloud, part_witnesses{minima})[0];
    CHECK(w.distance == (from.x < 1 ? 0 : from.x - 1));
    CHECK(same_bytes(w.at, clearance::position{double(from.x), 0, 0}));
    CHECK(same_bytes(w.at, least.at));
  }
}

TEST_CASE("Gradients of distances to inner spheres are those of differences") {
  against_differences<clearance::sphere, inner_sphere>();
}
TEST_CASE("Gradients of distances to triangles are those of differences") {
  against_differences<clearance::obb, triangle>();
}
TEST_CASE("Every part's witness to spheres has the numbers of its minimum") {
  of_all_scenes<clearance::aabb, inner_sphere>();
}
TEST_CASE("Every part's witness to triangles has the numbers of its minimum") {
  of_all_scenes<clearance::sphere, triangle>();
}

TEST_CASE("Turning about a point counts by the arm, and pulling away by the normal") {
  part_witness w;
  w.distance = 0.5, w.part = 0, w.nearest = {1, 0, 0}, w.normal = {1, 0, 0};
  const auto g = gradient(w, clearance::position{0, 2, 0});
  REQUIRE(g);
  CHECK(g.linear == vec3{-1, 0, 0});
  CHECK(g.angular == vec3{0, 0, -2});  // at y = -2 from the axis, turning about z moves it along +x
  CHECK(g.along({1, 0, 0}, {0, 0, 0}) == -1);
  CHECK(g.along({0, 5, 7}, {3, 3, 0}) == 0);
}

TEST_CASE("What has no gradient says why, and has no numbers") {
  const auto nothing = [](const clearance::pose_gradient& g, gradient_state why) {
    return g.state == why && !g && g.linear.x != g.linear.x && g.angular.z != g.angular.z &&
           !(g.along({1, 1, 1}, {1, 1, 1}) == g.along({1, 1, 1}, {1, 1, 1}));
  };
  const clearance::position origin{0, 0, 0};
  CHECK(nothing(gradient(clearance::min_distance_result{}, origin), gradient_state::no_data));
  CHECK(nothing(gradient(part_witness{}, origin), gradient_state::no_data));
  const std::vector poses{Eigen::Isometry3d::Identity()};
  const auto ask = [&](const auto& part, vec3 p) {
    const std::vector points{p};
    const clearance::model robot{std::vector{part}};
    const auto [r, minima] = clearance::ask(host{}, robot, poses, points, min_distance_per_part{});
    const auto of_part = gradient(clearance::ask(host{}, robot, poses, points, part_witnesses{minima})[0], origin);
    const auto of_robot = gradient(r, origin);
    CHECK(of_part.state == of_robot.state);
    return of_robot;
  };
  const auto ball =
      clearance::make_part(clearance::build<clearance::sphere>(std::vector<inner_sphere>{{{0, 0, 0}, 1}}));
  CHECK(nothing(ask(ball, {0, 0, 0}), gradient_state::no_direction));
  CHECK(ask(ball, {0.25f, 0, 0}).linear == vec3{-1, 0, 0});  // deeper or not, the distance grows away from the centre
  CHECK(nothing(ask(ball, {0, clearance::not_a_number, 0}), gradient_state::no_data));
  std::vector<triangle> faces{triangle::from({-1, -1, 1}, {3, -1, 1}, {-1, 3, 1})};
  auto surface = clearance::make_part(clearance::build<clearance::obb>(faces));
  const clearance::part<decltype(surface.tree), cube_interior> cube{surface.tree, {}, surface.facts};
  CHECK(nothing(ask(cube, {0, 0, 0.5f}), gradient_state::at_zero));
  CHECK(nothing(ask(cube, {0, 0, 1}), gradient_state::at_zero));
  CHECK(ask(cube, {0, 0, 1.5f}).linear == vec3{0, 0, -1});
}

TEST_CASE("Witnesses of minima that are of something else are refused") {
  dice d(9);
  const auto s = sparse<inner_sphere>(d);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::point_span cloud(s.points);
  const auto minima = ask(host{}, model, s.poses, cloud, min_distance_per_part{}).parts;
  const auto refused = [&](std::vector<part_minimum> changed, const auto& poses, const auto& clouds) {
    CHECK_THROWS_AS(ask(host{}, model, poses, clouds, part_witnesses{changed}), std::invalid_argument);
  };
  auto changed = minima;
  changed[1].distance = std::nextafter(changed[1].distance, clearance::infinity);
  refused(changed, s.poses, cloud);
  changed = minima, changed[2].point = 60;
  refused(changed, s.poses, cloud);
  changed = minima, changed[3].cloud = 1;
  refused(changed, s.poses, cloud);
  changed = minima, changed.pop_back();
  refused(changed, s.poses, cloud);
  auto poses = s.poses;
  for (auto& pose : poses) pose.translation().x() += 0.5;
  refused(minima, poses, cloud);
  refused(minima, s.poses, clearance::point_span(s.points.data(), 0));
  poses[0].translation().x() = clearance::not_a_number;
  refused(minima, poses, cloud);
}

TEST_CASE("The smooth minimum is never above the least, near it, and its weights are its slopes") {
  verdict v;
  dice d(33);
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<part_minimum> minima(1 + d.below(12));
    for (auto& m : minima) m.distance = d.below(9) == 0 ? clearance::infinity : d.number(-0.1, 1);
    minima[d.below(unsigned(minima.size()))].distance = d.number(-0.1, 1);
    const double temperature = std::pow(10, d.uniform(-4, 1));
    real least = clearance::infinity;
    for (const auto& m : minima) least = std::min(least, m.distance);
    const auto smooth = smooth_minimum_of(minima, temperature);
    double together = 0;
    for (const double w : smooth.weights) together += w;
    const double lowest = double(least) - temperature * std::log(double(minima.size())) - 1e-12;
    v.require(smooth.value <= double(least) && smooth.value >= lowest, "between", smooth.value, least);
    v.require(std::abs(together - 1) < 1e-12, "the weights add up to", together);
    const std::size_t k = d.below(unsigned(minima.size()));
    const real h = real(1e-3 * temperature), distance = minima[k].distance;
    if (!(h > 1e-6f) || distance == clearance::infinity) continue;
    minima[k].distance = distance + h;
    const double up = minima[k].distance, above = smooth_minimum_of(minima, temperature).value;
    minima[k].distance = distance - h;
    const double down = minima[k].distance, below = smooth_minimum_of(minima, temperature).value;
    v.require(std::abs((above - below) / (up - down) - smooth.weights[k]) < 1e-5, "the slope",
              (above - below) / (up - down), " instead of", smooth.weights[k]);
  }
  std::vector<part_minimum> far(3);
  const auto nothing = smooth_minimum_of(far, 0.1);
  CHECK((nothing.value == double(clearance::infinity) && nothing.weights == std::vector<double>{0, 0, 0}));
  far[0].distance = 1;
  for (const double temperature : {0.0, -1.0, double(clearance::infinity), double(clearance::not_a_number)})
    CHECK_THROWS_AS(smooth_minimum_of(far, temperature), std::invalid_argument);
  far[1].distance = clearance::not_a_number;
  CHECK_THROWS_AS(smooth_minimum_of(far, 0.1), std::invalid_argument);
  far[1].distance = -clearance::infinity;
  CHECK_THROWS_AS(smooth_minimum_of(far, 0.1), std::invalid_argument);
}

}  // namespace gradient_test
