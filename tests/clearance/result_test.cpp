// SPDX-License-Identifier: BSD-3-Clause
// What is asked for by a number that a result does not have is refused, and never read beside it.
#include "support/laws.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/make_model.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

#include <stdexcept>

namespace result_test {

using namespace testing;
using namespace clearance;

namespace {

constexpr std::size_t numbers[] = {0, 1, 2, 3, 4, 5, 6, 100'000'000, ~std::size_t(0) / 2, ~std::size_t(0)};

/// `ask(i)` answers for numbers below `count`, and refuses all others with a sentence that says what there is.
template <class Ask>
void check(verdict& v, const std::string& what, std::size_t count, Ask ask) {
  for (const std::size_t i : numbers) {
    std::string why;
    try {
      ask(i);
    } catch (const std::out_of_range& error) {
      why = error.what();
    }
    const std::string expected = "clearance: there is no " + what + ' ' + std::to_string(i) + ": there " +
                                 (count == 1 ? "is 1" : "are " + std::to_string(count)) + ", numbered from 0";
    v.require(why == (i < count ? std::string() : expected), what, i, "says", why);
  }
}

}  // namespace

TEST_CASE("A number of what a result does not have is refused in a sentence, by every result") {
  dice d(8);
  verdict v;
  for (const std::size_t parts : {1u, 2u, 5u})
    for (const std::size_t points : {0u, 1u, 40u}) {
      std::vector<std::vector<inner_sphere>> bodies;
      for (std::size_t k = 0; k < parts; ++k) bodies.push_back(random_spheres(d, 6));
      const auto model = make_model<sphere>(bodies);
      const auto cloud = d.points(points, 3);
      std::vector<Eigen::Isometry3d> poses;
      for (std::size_t k = 0; k < 3 * parts; ++k) poses.push_back(d.pose(1));
      const std::span<const Eigen::Isometry3d> one(poses.data(), parts);
      const auto in_zones = ask(host{}, model, one, cloud, zones{.thresholds = {0.1, 0.3}});
      check(v, "part", parts, [&](std::size_t i) { return in_zones.of(i, 0).points; });
      check(v, "zone", 2, [&](std::size_t i) { return in_zones.of(parts - 1, i).points; });
      const auto near = ask(host{}, model, one, cloud, nearest_k{.k = 3});
      check(v, "part", parts, [&](std::size_t i) { return near.of(i).size(); });
      const auto each = ask(host{}, model, one, cloud, distances_per_part{});
      check(v, "part", parts, [&](std::size_t i) { return each.of(i).size(); });
      v.require(each.of(parts - 1).size() == points, "as many distances as points");
      const auto least = ask(host{}, model, poses, cloud, min_distances_per_part{});
      check(v, "configuration", 3, [&](std::size_t i) { return least.of(i).size(); });
      const auto plan = ask(host{}, model, poses, cloud, min_distances{});
      check(v, "trajectory", 3, [&](std::size_t i) { return plan.trajectory(i, 1).size(); });
      check(v, "trajectory", 1, [&](std::size_t i) { return plan.trajectory(i, 3).size(); });
      const auto states = ask(host{}, model, poses, cloud, in_collisions{});
      check(v, "trajectory", 3, [&](std::size_t i) { return states.trajectory(i, 1).size(); });
    }
}

}  // namespace result_test
