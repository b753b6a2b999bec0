// SPDX-License-Identifier: BSD-3-Clause
// On a device, every part's distances are the host's.
#include "support/brute_per_part.hpp"
#include "support/frames_device.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/volume/sphere.hpp>

namespace distances_per_part_test {

using namespace testing;
using clearance::device, clearance::host, clearance::distances_per_part;

TEST_CASE("On a device every part's distances are the host's, to the bit") {
  verdict v;
  const device gpu;
  for (auto s : scenes<inner_sphere>()) {
    if (s.points.size() > 3) s.points[1].x = clearance::not_a_number;
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto two = two_clouds(s);
    for (const real d_max : {real(0.2 * s.size), clearance::infinity}) {
      const std::string what = s.name + ", d_max " + std::to_string(d_max);
      require_same(ask(gpu, model.on(gpu), s.poses, two, distances_per_part{d_max}),
                   ask(host{}, model, s.poses, two, distances_per_part{d_max}), v, what);
    }
  }
}

TEST_CASE("Prepared, every part's distances are on a device in every frame the host's, and in a graph") {
  verdict v;
  const own_stream stream;
  const device gpu{0, stream.handle};
  for (const int parts : {3, 130}) {
    moving_frames f(parts, 126);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query query(gpu, there, clearance::distances_per_part{});
    const auto distance = room_on<real>(gpu, std::size_t(parts) * 45010);
    const auto counts = room_on<clearance::point_counts>(gpu, 1);
    const auto look = [&](real d_max, const std::string& when) {
      const auto expected = ask(host{}, model, f.s.poses, f.here(), distances_per_part{d_max});
      const std::string what = std::to_string(parts) + " parts, " + when;
      require_same({.distance = gpu.copy_out(distance.data(), expected.distance.size()),
                    .points = expected.points,
                    .counts = gpu.copy_out(counts)[0],
                    .certain = {},
                    .parts = expected.parts},
                   expected, v, what + ", enqueued");
      return expected;
    };
    for (; f.there(); f.next()) {
      const real d_max = f.number % 2 ? 0.3f : clearance::infinity;
      const frame_there seen(gpu, f);
      query.enqueue(f.s.poses, seen.all, {d_max}, {distance.data(), counts.data()});
      const auto expected = look(d_max, "frame " + std::to_string(f.number));
      require_same(query(f.s.poses, f.here(), {d_max}), expected, v, "waited for");
      CHECK_THROWS_AS(query(f.s.poses, f.here(), {clearance::not_a_number}), std::invalid_argument);
    }
    replay(
        stream, gpu, f,
        [&](const clouds& all) { query.enqueue(f.s.poses, all, {0.3f}, {distance.data(), counts.data()}); },
        [&](const std::string& what) { look(0.3f, what); });
  }
}

}  // namespace distances_per_part_test
