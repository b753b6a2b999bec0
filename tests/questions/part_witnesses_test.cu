// SPDX-License-Identifier: BSD-3-Clause
// On a device, the witnesses of the parts' least distances are the host's: in every frame, and in a graph.
#include "support/frames_device.cuh"
#include "support/product_device.cuh"
#include "support/same_result.hpp"

#include <clearance/device.cuh>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>

namespace part_witnesses_test {

using namespace testing;
using clearance::device, clearance::host, clearance::min_distance_per_part, clearance::part_minimum,
    clearance::part_witness, clearance::part_witnesses;

namespace {

void require_witnesses(const std::vector<part_witness>& found, const std::vector<part_witness>& expected, verdict& v,
                       const std::string& what) {
  v.require(found.size() == expected.size(), what);
  for (std::size_t k = 0; k < expected.size(); ++k)
    v.require(same_witness(found[k], expected[k]), what, ": the witness of part", k);
}

}  // namespace

TEST_CASE(
    "A prepared question of every part's witness says on a device in every frame what the host says, and in a graph") {
  verdict v;
  const own_stream stream;
  const device gpu{0, stream.handle};
  for (const int parts : {3, 40}) {
    moving_frames f(parts, 161);
    const auto model = f.model();
    const auto there = model.on(gpu);
    clearance::query least(gpu, there, min_distance_per_part{});
    clearance::query query(gpu, there, part_witnesses{}), follows(gpu, there, part_witnesses{});
    const auto result = room_on<clearance::min_distance_result>(gpu, 1);
    const auto minima = room_on<part_minimum>(gpu, std::size_t(parts));
    const auto witnesses = room_on<part_witness>(gpu, std::size_t(parts));
    std::size_t seen = 0;
    const auto look = [&](const std::string& when) {
      const auto nearest = ask(host{}, model, f.s.poses, f.here(), min_distance_per_part{}).parts;
      const auto expected = ask(host{}, model, f.s.poses, f.here(), part_witnesses{nearest});
      const std::string what = std::to_string(parts) + " parts, " + when;
      require_witnesses(gpu.copy_out(witnesses), expected, v, what + ", enqueued");
      require_witnesses(query(f.s.poses, f.here(), {nearest}), expected, v, what + ", prepared");
      require_witnesses(ask(gpu, there, f.s.poses, f.here(), part_witnesses{nearest}), expected, v,
                        what + ", one call");
      for (const part_witness& w : expected) seen += w.part != clearance::none;
    };
    const auto enqueue = [&](const clouds& all) {
      least.enqueue(f.s.poses, all, {result.data(), minima.data()});
      follows.enqueue(f.s.poses, all, {minima.data(), witnesses.data()});
    };
    for (; f.there(); f.next()) {
      enqueue(frame_there(gpu, f).all);
      look("frame " + std::to_string(f.number));
    }
    replay(stream, gpu, f, enqueue, look);
    v.require(seen > 6 * std::size_t(parts), "witnesses:", seen);
  }
}

TEST_CASE("Minima of other clouds have no witness on a device") {
  const device gpu;
  moving_frames f(4, 162);
  const auto there = f.model().on(gpu);
  const auto minima = ask(gpu, there, f.s.poses, f.here(), min_distance_per_part{}).parts;
  const auto others = gpu.copy_in(std::span<const part_minimum>(minima));
  const auto witnesses = room_on<part_witness>(gpu, minima.size());
  clearance::query query(gpu, there, part_witnesses{});
  f.see(10);  // smaller: points of those numbers are not there
  CHECK_THROWS_AS(query(f.s.poses, f.here(), {minima}), std::invalid_argument);
  query.enqueue(f.s.poses, frame_there(gpu, f).all, {others.data(), witnesses.data()});
  for (const part_witness& w : gpu.copy_out(witnesses))
    CHECK((w.part == clearance::none && w.point == clearance::none));
  query.enqueue(f.s.poses, std::vector<clearance::placed<clearance::point_span>>{}, {others.data(), witnesses.data()});
  for (const part_witness& w : gpu.copy_out(witnesses)) CHECK(w.part == clearance::none);
}

}  // namespace part_witnesses_test
