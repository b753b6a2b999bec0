// SPDX-License-Identifier: BSD-3-Clause
// What several GPUs in one process gain: clouds of up to 10^9 points that stay on them, frames of 300k points, and
// clouds from pinned memory, on one GPU, on one named twice, and on two. By the host's clock, from the call to the
// answer on the host; percentiles are counters, in microseconds. Every answer is compared with that of one GPU, bit for
// bit.
#include "device.cuh"
#include "shell.hpp"

#include <clearance/device.cuh>
#include <clearance/volume/sphere.hpp>

#include <cstring>
#include <optional>

namespace devices_bench {
namespace {

using namespace bench;
using clearance::device, clearance::devices, clearance::point_span, clearance::vec3;

const auto& robot() {
  static const auto model = sphere_model<clearance::sphere>(the_scene());
  return model;
}

/// Each point is one of the frame's, up to 3.5 mm off along each axis: a cloud of any size, in any memory.
struct repeated_frame {
  const vec3* frame;
  std::size_t frame_points, first;
  vec3* to;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const vec3 p = frame[(first + i) % frame_points];
    const std::uint64_t bits = point_bits(first + i)();
    const auto off = [bits](int shift) { return (float(bits >> shift & 0x1fffff) * 0x1p-20f - 1) * 0.0035f; };
    to[i] = {p.x + off(0), p.y + off(21), p.z + off(42)};
  }
};

/// Points `first` to `end - 1`, made in a device's memory.
clearance::device_buffer<vec3> made(const device& on, std::size_t first, std::size_t end) {
  const auto& frame = the_scene().cloud;
  const auto there = on.copy_in(std::span<const vec3>(frame));
  clearance::device_buffer<vec3> points(end - first, on.id);
  on.for_each(end - first, repeated_frame{there.data(), frame.size(), first, points.data()});
  on.wait();
  return points;
}

/// The cloud in pieces, each made where it is read.
struct resident {
  std::vector<clearance::device_buffer<vec3>> memory;
  std::optional<clearance::sharded<point_span>> view;

  resident(const devices& on, std::size_t count) {
    std::vector<point_span> pieces;
    const point_span whole(nullptr, count);
    for (std::size_t k = 0; k < on.size(); ++k) {
      const std::size_t first = clearance::first_of_piece(whole, k, on.size()),
                        end = clearance::first_of_piece(whole, k + 1, on.size());
      memory.push_back(made(on.each()[k], first, end));
      pieces.emplace_back(memory.back().data(), end - first);
    }
    view.emplace(pieces);
  }
};

enum class which { one, one_twice, two };

/// The chosen GPUs; none if there are too few.
std::optional<devices> picked(benchmark::State& state, which w) {
  if (no_device(state)) return {};
  int there = 0;
  check_cuda(cudaGetDeviceCount(&there), "cudaGetDeviceCount");
  if (w == which::two && there < 2) {
    state.SkipWithError("one GPU only");
    return {};
  }
  return w == which::one ? devices{0} : w == which::two ? devices{0, 1} : devices{0, 0};
}

/// Every way to ask about as many points must give the same answer, or its row fails.
void same_bits(benchmark::State& state, const clearance::min_distance_result& r) {
  static std::map<std::int64_t, clearance::min_distance_result> known;
  const auto [first, fresh] = known.emplace(state.range(0), r);
  const auto& e = first->second;
  const auto equal = [](const auto& a, const auto& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
  const bool same = r.state == e.state && equal(r.distance, e.distance) && equal(r.lower, e.lower) &&
                    equal(r.upper, e.upper) && r.cloud == e.cloud && r.point == e.point && r.part == e.part &&
                    r.primitive == e.primitive && equal(r.at, e.at) && equal(r.nearest, e.nearest) &&
                    equal(r.normal, e.normal) && r.seen == e.seen && r.valid == e.valid && equal(r.dropped, e.dropped);
  if (!same) state.SkipWithError("another answer than before");
  state.counters["distance_mm"] = r.distance * 1e3;
}

std::size_t calls(std::size_t points) { return points > 500000000 ? 60 : points > 20000000 ? 200 : 5000; }

/// Points that stay on the GPUs; `warm`: the last frame is remembered.
void stays(benchmark::State& state, which w, bool warm) {
  const auto on = picked(state, w);
  if (!on) return;
  const auto count = std::size_t(state.range(0));
  const resident cloud(*on, count);
  const auto model = robot().on(*on);
  clearance::query query(*on, model, clearance::min_distance{});
  const scene& s = the_scene();
  clearance::min_distance_result r;
  percentiles(
      state, calls(count), 20, [&](std::size_t) { r = query(s.poses, *cloud.view, s.world_from_camera); },
      [&] {
        if (!warm) query.forget(), on->wait();
      });
  same_bits(state, r);
}

/// The same with one `device`, to see the cost of a list of devices; and with one call that prepares nothing.
void one_device(benchmark::State& state, bool prepared) {
  if (no_device(state)) return;
  const auto count = std::size_t(state.range(0));
  const device gpu;
  const auto there = made(gpu, 0, count);
  const auto model = robot().on(gpu);
  clearance::query query(gpu, model, clearance::min_distance{});
  const scene& s = the_scene();
  clearance::min_distance_result r;
  percentiles(
      state, prepared ? calls(count) : 300, 20,
      [&](std::size_t) {
        const point_span cloud(there.data(), count);
        r = prepared ? query(s.poses, cloud, s.world_from_camera)
                     : clearance::ask(gpu, model, s.poses, cloud, s.world_from_camera, clearance::min_distance{});
      },
      [] {});
  same_bits(state, r);
}
void one_call(benchmark::State& state, which w) {
  const auto on = picked(state, w);
  if (!on) return;
  const auto count = std::size_t(state.range(0));
  const resident cloud(*on, count);
  const auto model = robot().on(*on);
  const scene& s = the_scene();
  clearance::min_distance_result r;
  percentiles(
      state, 300, 20,
      [&](std::size_t) {
        r = clearance::ask(*on, model, s.poses, *cloud.view, s.world_from_camera, clearance::min_distance{});
      },
      [] {});
  same_bits(state, r);
}

/// Each device only reads its piece: the floor, by the same clock.
void read(benchmark::State& state, which w) {
  const auto on = picked(state, w);
  if (!on) return;
  const auto count = std::size_t(state.range(0));
  const resident cloud(*on, count);
  const clearance::pinned_buffer<float> never(1, 0);
  percentiles(
      state, calls(count), 20,
      [&](std::size_t) {
        for (std::size_t k = 0; k < on->size(); ++k) {
          const point_span piece = cloud.view->piece(k);
          on->each()[k].launch(read_kernel<>, 264, 512, 0, reinterpret_cast<const float4*>(piece.points),
                               piece.count * 3 / 4, never.data());
        }
        on->wait();
      },
      [] {});
}

enum class from { pinned, pinned_copy_alone, first_device };

/// Points that are copied in every call: from pinned memory, or from the first GPU's.
void comes(benchmark::State& state, which w, from where) {
  const auto on = picked(state, w);
  if (!on) return;
  const auto count = std::size_t(state.range(0));
  const auto there = made(device{}, 0, count);
  clearance::pinned_buffer<vec3> pinned;
  if (where != from::first_device) {
    pinned = clearance::pinned_buffer<vec3>(count, 0);
    check_cuda(cudaMemcpy(pinned.data(), there.data(), count * sizeof(vec3), cudaMemcpyDeviceToHost), "cudaMemcpy");
  }
  const point_span cloud(where == from::first_device ? there.data() : pinned.data(), count);
  const auto model = robot().on(*on);
  clearance::query query(*on, model, clearance::min_distance{});
  const scene& s = the_scene();
  const auto few = count > 20000000 ? 20 : 1000;
  clearance::min_distance_result r;
  if (where != from::pinned_copy_alone) {
    percentiles(state, few, 3, [&](std::size_t) { r = query(s.poses, cloud, s.world_from_camera); }, [] {});
    return same_bits(state, r);
  }
  std::vector<clearance::device_buffer<std::byte>> room;
  for (std::size_t k = 0; k < on->size(); ++k)
    room.emplace_back(piece_of(cloud, k, on->size()).bytes().size(), on->each()[k].id);
  percentiles(
      state, few, 3,
      [&](std::size_t) {
        for (std::size_t k = 0; k < on->size(); ++k) {
          const point_span piece = piece_of(cloud, k, on->size());
          check_cuda(
              cudaMemcpyAsync(room[k].data(), piece.points, room[k].size(), cudaMemcpyDefault, on->each()[k].stream),
              "cudaMemcpyAsync");
        }
        on->wait();
      },
      [] {});
}

#define ONCE ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(1)
#define ALL ->Arg(307200)->Arg(5000000)->Arg(20000000)->Arg(100000000)->Arg(1000000000) ONCE
BENCHMARK_CAPTURE(one_device, warm, true) ALL;
BENCHMARK_CAPTURE(read, one, which::one) ALL;
BENCHMARK_CAPTURE(read, two, which::two) ALL;
BENCHMARK_CAPTURE(stays, one_warm, which::one, true) ALL;
BENCHMARK_CAPTURE(stays, two_warm, which::two, true) ALL;
BENCHMARK_CAPTURE(stays, one_cold, which::one, false) ALL;
BENCHMARK_CAPTURE(stays, two_cold, which::two, false) ALL;
BENCHMARK_CAPTURE(stays, one_twice_warm, which::one_twice, true)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(one_device, one_call, false)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(one_call, one, which::one)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(one_call, two, which::two)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(comes, pinned_one, which::one, from::pinned)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(comes, pinned_two, which::two, from::pinned)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(comes, pinned_copy_alone_one, which::one, from::pinned_copy_alone)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(comes, pinned_copy_alone_two, which::two, from::pinned_copy_alone)->Arg(307200)->Arg(100000000) ONCE;
BENCHMARK_CAPTURE(comes, first_device_two, which::two, from::first_device)->Arg(307200)->Arg(100000000) ONCE;

}  // namespace
}  // namespace devices_bench

#undef ONCE

BENCHMARK_MAIN();
