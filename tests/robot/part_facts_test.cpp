// SPDX-License-Identifier: BSD-3-Clause
// The facts of a part are lengths. Every entry refuses a negative one and NaN; if one gets in anyway, nothing becomes
// free by it.
#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace part_facts_test {

using namespace clearance;

namespace {

const std::vector<inner_sphere> one{{{0, 0, 0}, 0.5f}};
const auto tree = build<sphere>(one);
const std::vector<vec3> points{{2, 0, 0}};
const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
const std::vector poses{here};

const double none_of_them[] = {-1, -1e-9, -double(infinity), double(not_a_number)};
const part_facts good{{0, 0, 0}, 0.5f, 0, 0};

/// Facts of which one is no length.
std::vector<part_facts> bad_facts() {
  std::vector<part_facts> all;
  for (const double bad : none_of_them)
    for (real part_facts::* const which : {&part_facts::gap, &part_facts::tolerance, &part_facts::radius}) {
      all.push_back(good);
      all.back().*which = real(bad);
    }
  for (const real bad : {not_a_number, infinity}) {
    all.push_back(good), all.back().center.x = bad;
    all.push_back(good), all.back().center.z = bad;
  }
  return all;
}

}  // namespace

TEST_CASE("make_part refuses a gap or a tolerance that is negative or no number") {
  packing packed;
  packed.spheres = one;
  for (const double bad : none_of_them) {
    CHECK_THROWS_AS(make_part(tree, bad), std::invalid_argument);
    CHECK_THROWS_AS(make_part(tree, 0, bad), std::invalid_argument);
    CHECK_THROWS_AS(make_part<sphere>(one, {.tolerance = bad}), std::invalid_argument);
    CHECK_THROWS_AS(make_part<aabb>(close_mesh(shapes::box({0, 0, 0}, {1, 1, 1})), {.tolerance = bad}),
                    std::invalid_argument);
    CHECK_THROWS_AS(make_model<sphere>(std::vector<std::vector<inner_sphere>>{one}, part_options{.tolerance = bad}),
                    std::invalid_argument);
    packed.gap = bad;
    CHECK_THROWS_AS(make_part<sphere>(packed), std::invalid_argument);
    CHECK_THROWS_AS(make_model<sphere>(std::vector{packed}), std::invalid_argument);
  }
  CHECK_THROWS_WITH(make_part(tree, 0, double(not_a_number)),
                    "clearance: the tolerance of a part is nan m, which must be 0 or more");
  CHECK(make_part(tree, infinity).facts.gap == infinity);  // no certificate
}

TEST_CASE("facts that are none are refused in a model, in a part that is asked about, and in a view made by hand") {
  for (const part_facts& bad : bad_facts()) {
    const part made{tree, no_interior{}, bad};
    CHECK_THROWS_AS(model(std::vector{part{tree, no_interior{}, good}, made}), std::invalid_argument);
    CHECK_THROWS_AS(ask(host{}, made, here, points, min_distance{}), std::invalid_argument);
    const auto view = made.view();
    const model_view<std::remove_const_t<decltype(view)>> by_hand{
        &view, {&bad, 1}, view.tree.depth(), view.tree.width()};
    CHECK_THROWS_AS(ask(host{}, by_hand, poses, points, min_distance{}), std::invalid_argument);
    CHECK_THROWS_AS(query(host{}, by_hand, min_distance{}), std::invalid_argument);
    CHECK_THROWS_AS(attach(host{}, by_hand, by_hand), std::invalid_argument);
  }
  part_facts bad = good;
  bad.tolerance = -1;
  CHECK_THROWS_WITH(model(std::vector{part{tree, no_interior{}, good}, part{tree, no_interior{}, bad}}),
                    "clearance: the tolerance of part 1 is -1.000000 m, which must be 0 or more");
}

TEST_CASE("facts that are none leave nothing certain, wherever they come from") {
  const world_transform there;
  for (const part_facts& bad : bad_facts()) {
    frames::frame_facts all;
    all.add(good, frames::place(good, there, there, {0, 0, 0}, {}).error);
    CHECK(frames::certain_distance(1.5f, all.slop, all.error) > 1.49);
    all.add(bad, frames::place(bad, there, there, {0, 0, 0}, {}).error);
    INFO(bad.gap << ' ' << bad.tolerance << ' ' << bad.radius << ' ' << bad.center.x << ' ' << bad.center.z);
    CHECK_FALSE(frames::certain_distance(1.5f, all.slop, all.error) > 0);
  }
}

}  // namespace part_facts_test
