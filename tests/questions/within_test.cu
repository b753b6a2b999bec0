// SPDX-License-Identifier: BSD-3-Clause
// On a device, points within a distance are the host's.
#include "support/brute_within.hpp"
#include "support/frames_device.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/volume/sphere.hpp>

namespace within_test {

using namespace testing;
using clearance::device, clearance::host, clearance::placed, clearance::point_span, clearance::within;

TEST_CASE("On a device points within a distance are the host's, and a long list is whole") {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const real radius : {real(0), real(0.1), clearance::infinity})
      require_same(ask(gpu, model.on(gpu), s.poses, two, within{{radius}}),
                   ask(host{}, model, s.poses, two, within{{radius}}), v,
                   s.name + ", within " + std::to_string(radius));
  }
  const auto s = two_balls();
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const std::vector cloud{placed{point_span(s.points)}};
  require_same(ask(gpu, model.on(gpu), s.poses, cloud, within{{10}}), ask(host{}, model, s.poses, cloud, within{{10}}),
               v, "many");
}

TEST_CASE("A prepared list says on a device in every frame what the host says, and in a graph") {
  verdict v;
  const own_stream stream;
  const device gpu{0, stream.handle};
  for (const int parts : {3, 130}) {
    moving_frames f(parts, 122);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query query(gpu, there, clearance::within{{0.0}});
    constexpr std::size_t capacity = 3000000;
    const auto pairs = room_on<clearance::pair_distance>(gpu, capacity);
    const auto count = room_on<unsigned long long>(gpu, 1);
    const auto counts = room_on<clearance::point_counts>(gpu, 1);
    const auto look = [&](const std::vector<real>& radii, const std::string& when) {
      const auto expected = ask(host{}, model, f.s.poses, f.here(), within{{radii.begin(), radii.end()}});
      const std::string what = std::to_string(parts) + " parts, " + when;
      const auto found = gpu.copy_out(count)[0];
      require_listed(gpu.copy_out(pairs.data(), std::min<std::size_t>(found, capacity)), found, expected, v,
                     what + ", enqueued");
      v.require(gpu.copy_out(counts)[0].valid == expected.counts.valid, what, ": counts");
      return expected;
    };
    for (; f.there(); f.next()) {
      // That of frame 4 is a longer list than there is room for at first.
      const std::vector<real> radii(f.number % 2 ? std::size_t(parts) : 1, f.number == 4 ? 0.8f : 0.1f);
      const within asked{{radii.begin(), radii.end()}};
      const frame_there seen(gpu, f);
      query.enqueue(f.s.poses, seen.all, asked, {pairs.data(), capacity, count.data(), counts.data()});
      const auto expected = look(radii, "frame " + std::to_string(f.number));
      require_same(query(f.s.poses, f.here(), asked), expected, v, "waited for");
      CHECK_THROWS_AS(query(f.s.poses, f.here(), {{clearance::not_a_number}}), std::invalid_argument);
    }
    replay(
        stream, gpu, f,
        [&](const clouds& all) {
          query.enqueue(f.s.poses, all, {{0.1f}}, {pairs.data(), capacity, count.data(), counts.data()});
        },
        [&](const std::string& what) { look({0.1f}, what); });
  }
}

}  // namespace within_test
