// SPDX-License-Identifier: BSD-3-Clause
// On a device, points in zones are the host's.
#include "solid/shapes.hpp"
#include "support/brute_zones.hpp"
#include "support/frames_device.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace zones_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::zones;

TEST_CASE("Zones on a device hold what they hold on the host") {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    const clearance::zones options{.thresholds = {0, 0.05 * s.size, 0.5 * s.size}};
    require_same(ask(gpu, model.on(gpu), s.poses, two, options), ask(host{}, model, s.poses, two, options), v, s.name);
  }
}

TEST_CASE("Crowds in zones are counted one by one") {
  verdict v;
  const device gpu;
  const auto s = crowd(97);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const clearance::zones options{.thresholds = {0.02, 0.1, 0.3}};
  const auto found = ask(gpu, model.on(gpu), s.poses, point_span(s.points), options);
  require_same(found, ask(host{}, model, s.poses, point_span(s.points), options), v, "crowd");
  CHECK(found.of(0, 2).points > 10000);
}

TEST_CASE("Crowds in and around solids are counted one by one") {
  verdict v;
  const device gpu;
  dice d(102);
  const auto box = [&] { return clearance::make_part<clearance::aabb>(clearance::close_mesh(shapes::cube(1))); };
  const clearance::model boxes{std::vector{box(), box()}};
  const std::vector poses{d.pose(0.5), d.pose(0.5)};
  const auto crowd = d.points(300000, 2);
  const clearance::zones options{.thresholds = {0, 0.05, 0.5}};
  const auto found = ask(gpu, boxes.on(gpu), poses, point_span(crowd), options);
  require_same(found, ask(host{}, boxes, poses, point_span(crowd), options), v, "boxes");
  CHECK((found.of(0, 0).points > 10000 && found.of(0, 1).points > found.of(0, 0).points));
}

TEST_CASE("A prepared question of zones says on a device in every frame what the host says, and in a graph") {
  verdict v;
  const own_stream stream;
  const device gpu{0, stream.handle};
  for (const int parts : {3, 130}) {
    moving_frames f(parts, 121);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query query(gpu, there, clearance::zones{{0.0}});
    const clearance::zones wide{.thresholds = {0, 0.05, 0.4}}, narrow{.thresholds = {0.02, 0.3}};
    const auto zone_there = room_on<clearance::zone>(gpu, wide.thresholds.size() * std::size_t(parts));
    const auto counts = room_on<clearance::point_counts>(gpu, 1);
    const auto look = [&](const clearance::zones& options, const std::string& when) {
      const auto expected = ask(host{}, model, f.s.poses, f.here(), options);
      const std::string what = std::to_string(parts) + " parts, " + when;
      require_same({expected.per_part, 1, gpu.copy_out(zone_there.data(), expected.zones.size()), {}}, expected, v,
                   what + ", enqueued");
      v.require(gpu.copy_out(counts)[0].valid == expected.counts.valid, what, ": counts");
      return expected;
    };
    for (; f.there(); f.next()) {
      const auto& options = f.number % 2 ? narrow : wide;
      const frame_there seen(gpu, f);
      CHECK(options.per_part(std::size_t(parts)) == options.thresholds.size());
      query.enqueue(f.s.poses, seen.all, options, {zone_there.data(), counts.data()});
      const auto expected = look(options, "frame " + std::to_string(f.number));
      require_same(query(f.s.poses, f.here(), options), expected, v, "waited for");
      CHECK_THROWS_AS(query(f.s.poses, f.here(), {.thresholds = {0.2, 0.1}}), std::invalid_argument);
    }
    replay(
        stream, gpu, f,
        [&](const clouds& all) { query.enqueue(f.s.poses, all, wide, {zone_there.data(), counts.data()}); },
        [&](const std::string& what) { look(wide, what); });
  }
}

}  // namespace zones_test
