// SPDX-License-Identifier: BSD-3-Clause
// On a device questions about cropped points and images say what they say on the host, bit for bit.
#include "combinations/sources.hpp"
#include "support/catch.hpp"
#include "support/product.hpp"
#include "support/same_answer.hpp"

#include <clearance/device.cuh>
#include <clearance/frames/cropped_clouds.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/sphere.hpp>

namespace cropped_device_test {

using namespace testing;
using clearance::crop, clearance::device, clearance::host;

TEST_CASE("A device crops points, images and uncertain points as the host does") {
  const combinations::scene_before_a_robot before(5, 6000);
  const auto robot = make_model<clearance::sphere>(before.s, {}, clearance::wrapped{});
  const device gpu;
  const auto there = robot.on(gpu);
  const auto where = crop().height(-0.6, 0.7).without_plane({0.1, 0, 1}, 0.1, 0.1).outside({0.2, 0, -1}, {0.6, 0.5, 1});
  const auto poses = before.configurations(1), plan = before.configurations(8);
  verdict v;
  const auto check = [&](const auto& cloud, const std::string& what) {
    const auto some = clearance::cropped_clouds(cloud, where);
    const auto same = [&]<class Q>(const Q& q, const std::vector<Eigen::Isometry3d>& at, const char* name) {
      const typename Q::result expected = ask(host{}, robot, at, some, q), found = ask(gpu, there, at, some, q);
      v.require(same_answer(found, expected), what, ": ", name);
    };
    same(clearance::min_distance_per_part{}, poses, "every part's least distance");
    same(clearance::zones{.thresholds = {0.1, 0.3}}, poses, "zones");
    same(clearance::min_distances{.d_max = 0.5}, plan, "a plan");
    if constexpr (!clearance::vague_source<std::remove_cvref_t<decltype(cloud.source)>>)
      same(clearance::distances{.d_max = 0.6, .which = true}, poses, "every point's distance");
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < some.source.size(); ++i)
      dropped += some.source[i].dropped == clearance::drop_reason::cropped;
    v.require(dropped > 100 && dropped < some.source.size(), what, ": ", dropped, " points are cropped");
  };
  check(before.cloud<combinations::points>(true), "points");
  check(before.cloud<combinations::image>(true), "an image");
  check(before.cloud<combinations::balls>(true, 0.02f), "uncertain points");
}

}  // namespace cropped_device_test
