// SPDX-License-Identifier: BSD-3-Clause
// Joint vectors give the same poses on a device as on the host, to the bit, and so the same answers.
#include "io/random_tree.hpp"
#include "support/same_result.hpp"
#include "support/scenes.hpp"

#include <clearance/device.cuh>
#include <clearance/io/joint_chain.hpp>
#include <clearance/make_model.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/volume/sphere.hpp>

namespace joint_chain_test {

using namespace testing;
using clearance::device, clearance::host;

TEST_CASE("Joint vectors on a device have the host's answers, from the host's memory and from the device's") {
  verdict v;
  const device gpu;
  dice d(88);
  std::size_t turned = 0, wound = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto [tree, one] = random_tree(d, 7, 0.3);
    std::vector<std::vector<inner_sphere>> bodies;
    std::vector<std::size_t> links;
    for (std::size_t k = 0; k < tree.links().size(); ++k)
      bodies.push_back(random_primitives<inner_sphere>(d, 8, 0.1, 0.05)), links.push_back(k);
    const auto model = clearance::make_model<clearance::sphere>(bodies);
    const auto there = model.on(gpu);
    const auto chain = clearance::io::joint_chain_of(tree, links, {.ignore_limits = true}, d.pose(0.5));
    const auto moved = chain.on(gpu);
    std::vector<double> q;
    const auto row = [&](bool far) {
      std::vector<double> values;
      for (std::size_t i = 0; i < tree.size(); ++i)
        values.push_back(far && tree.movable(i).kind != clearance::io::joint_kind::prismatic ? d.uniform(-1e6, 1e6)
                                                                                             : d.uniform(-3, 3));
      return values;
    };
    for (int c = 0; c < 50; ++c) {
      std::vector<double> values = row(c == 49);
      try {
        chain.count(values);
        wound += c == 49;
      } catch (const std::invalid_argument&) {  // a slide that follows a turn is so far away that ways cancel
        values = row(false);
      }
      q.insert(q.end(), values.begin(), values.end());
    }
    const auto points = d.points(500, 1.5);
    const auto expected = clearance::ask(host{}, model, chain.poses(q), points, clearance::min_distances{});
    clearance::query query(gpu, there, clearance::min_distances{});
    const auto same = [&](const std::vector<clearance::min_distance_result>& found, const char* what) {
      v.require(found.size() == 50, what, ":", found.size(), " results");
      for (std::size_t c = 0; c < found.size() && c < 50; ++c)
        v.require(same_result(found[c], expected.of[c]), what, ", configuration", c);
    };
    same(query(moved, q, points).of, "from the host");
    const auto q_there = gpu.copy_in(std::span<const double>(q));
    query.place(moved, q_there.data(), 50);
    same(query(points).of, "from the device");
    clearance::query on_host(host{}, model, clearance::min_distances{});
    same(on_host(chain, q, points).of, "on the host");
    const auto states = clearance::ask(host{}, model, chain.poses(q), points, clearance::in_collisions{{0.1}});
    clearance::query in(gpu, there, clearance::in_collisions{});
    v.require(in(moved, q, points, {{0.1}}).of == states.of, "within a margin");
    turned += std::size_t(std::ranges::count(states.of, clearance::state::collision));
  }
  CHECK(turned > 10);
  CHECK(wound > 5);
}

TEST_CASE("A joint vector on a device that is not allowed is refused, and never free") {
  const device gpu;
  clearance::chain_link slide;
  slide.value = 0, slide.factor = 1, slide.slides = true;
  const clearance::joint_chain<> chain({slide}, {0}, {{"slide", {-1, 1}}});
  const auto moved = chain.on(gpu);
  const auto model =
      clearance::make_model<clearance::sphere>(std::vector<std::vector<inner_sphere>>{{{{0, 0, 0}, 0.1f}}}).on(gpu);
  const std::vector<vec3> points{{3, 0, 0}};
  clearance::query query(gpu, model, clearance::min_distances{});
  CHECK_THROWS_WITH(query(moved, std::vector<double>{0, 2}, points),
                    "clearance: configuration 1: joint \"slide\" at 2.000000 is outside -1.000000 to 1.000000");
  const std::vector<double> q{0, 2};
  const auto q_there = gpu.copy_in(std::span<const double>(q));
  query.place(moved, q_there.data(), 2);
  CHECK_THROWS_WITH(query(points), Catch::Contains("a joint vector is not finite or beyond its joint's limits"));
  const auto points_there = gpu.copy_in(std::span<const vec3>(points));
  const auto* results = query.enqueue(clearance::point_span(points_there.data(), 1), clearance::min_distances{});
  const auto found = gpu.copy_out(results, 2);
  CHECK((found[0].state == clearance::state::free && found[0].distance == Approx(2.9)));
  CHECK((found[1].state == clearance::state::possible && std::isnan(found[1].distance)));
  const clearance::joint_chain<> two({slide, slide}, {0, 1}, {{"slide", {}}});
  CHECK_THROWS_WITH(query(two.on(gpu), std::vector<double>{0}, points),
                    "clearance: there are 1 parts, but a joint chain of 2");
}

}  // namespace joint_chain_test
