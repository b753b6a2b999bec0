// SPDX-License-Identifier: BSD-3-Clause
// The question that is about robots of closed meshes alone.
#include "combinations/cells.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"

#include <clearance/make_model.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/volume/aabb.hpp>

namespace signed_test {

using namespace combinations;

TEST_CASE("signed_distances: each cell is asked, and says what is composed by hand") {
  const scene_before_a_robot before;
  const auto box =
      clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::box({0, 0, 0}, {0.2, 0.3, 0.25})));
  const clearance::model robot(std::vector(before.s.poses.size(), box));
  cells_of("signed_distances", clearance::signed_distances{.d_max = 0.6, .which = true}, robot, before.s.poses, before)
      .check();
}

}  // namespace signed_test
