// SPDX-License-Identifier: BSD-3-Clause
// On a device, the point within a margin is the host's.
#include "support/brute_pairs.hpp"
#include "support/frames_device.cuh"
#include "support/product_device.cuh"

#include <clearance/device.cuh>
#include <clearance/make_model.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/volume/sphere.hpp>

namespace in_collision_test {

using namespace testing;
using clearance::device, clearance::host, clearance::in_collision, clearance::placed, clearance::point_span,
    clearance::state;

namespace {

bool same(const clearance::collision_result& a, const clearance::collision_result& b) {
  return a.state == b.state && a.cloud == b.cloud && a.point == b.point && a.part == b.part &&
         a.counts.valid == b.counts.valid;
}

}  // namespace

TEST_CASE("On a device a point within a margin is the host's, in all scenes") {
  verdict v;
  const device gpu;
  for (const auto& s : scenes<inner_sphere>()) {
    const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
    const auto there = model.on(gpu);
    const auto two = two_clouds(s);
    for (const double margin : {-0.1, 0.0, 1e-7, 0.02, 0.3})
      v.require(same(ask(gpu, there, s.poses, two, in_collision{{margin * s.size}}),
                     ask(host{}, model, s.poses, two, in_collision{{margin * s.size}})),
                s.name, ", margin ", margin, ": differs from the host's");
  }
}

TEST_CASE("In a crowd the first point is found again and again") {
  const device gpu;
  const auto s = crowd(98);
  const auto model = make_model<clearance::sphere>(s, {}, clearance::wrapped{});
  const auto there = model.on(gpu);
  for (const double margin : {0.0, 0.001, 0.3}) {
    const auto expected = ask(host{}, model, s.poses, point_span(s.points), in_collision{{margin}});
    CHECK(expected.state == state::collision);
    for (int k = 0; k < 5; ++k)
      CHECK(same(ask(gpu, there, s.poses, point_span(s.points), in_collision{{margin}}), expected));
  }
}

TEST_CASE("A prepared question of collision says on a device in every frame what the host says, and in a graph") {
  verdict v;
  const own_stream stream;
  const device gpu{0, stream.handle};
  std::size_t states[4] = {};
  for (const int parts : {3, 130}) {
    moving_frames f(parts, 123);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query query(gpu, there, clearance::in_collision{});
    const auto result = room_on<clearance::collision_result>(gpu, 1);
    const auto look = [&](const std::vector<double>& margins, const std::string& when) {
      const auto expected = ask(host{}, model, f.s.poses, f.here(), in_collision{margins});
      v.require(same(gpu.copy_out(result)[0], expected), parts, " parts, ", when,
                ", enqueued: differs from the host's");
      ++states[int(expected.state)];
      return expected;
    };
    for (; f.there(); f.next()) {
      const std::vector<double> margins(f.number % 2 ? std::size_t(parts) : 1, f.number < 4 ? 0.01 : -0.05);
      const frame_there seen(gpu, f);
      query.enqueue(f.s.poses, seen.all, {margins}, result.data());
      const auto expected = look(margins, "frame " + std::to_string(f.number));
      v.require(same(query(f.s.poses, f.here(), {margins}), expected), parts, " parts, frame ", f.number,
                ": differs from the host's");
      CHECK_THROWS_AS(query(f.s.poses, f.here(), {{clearance::not_a_number}}), std::invalid_argument);
    }
    replay(
        stream, gpu, f, [&](const clouds& all) { query.enqueue(f.s.poses, all, {{0.02}}, result.data()); },
        [&](const std::string& what) { look({0.02}, what); });
  }
  CHECK((states[int(state::free)] > 0 && states[int(state::collision)] > 0 && states[int(state::no_data)] > 0));
}

}  // namespace in_collision_test
