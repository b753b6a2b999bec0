// SPDX-License-Identifier: BSD-3-Clause
// Many configurations and one frame of 307,200 points on a GPU that holds the points, including the tree over them and
// all witnesses: random ones, in full or up to 5 cm, and a trajectory of 500 waypoints that is watched from frame to
// frame. CUDA events, behind other work. *states* only asks which are nearer than a margin. *image* has the frame as a
// depth image. *call* is one call as in a program, by the host's clock, copying poses and results.
#include "configurations.hpp"
#include "device.cuh"

#include <clearance/backends/own_stream.cuh>
#include <clearance/device.cuh>
#include <clearance/near_maps.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

namespace configurations_bench {
namespace {

using namespace bench;
using clearance::device, clearance::placed, clearance::point_span, clearance::vec3;

auto spheres(const scene& s) { return sphere_model<clearance::sphere>(s).on(device{}); }
auto triangles(const scene& s) { return triangle_model<clearance::aabb>(s).on(device{}); }
/// The same with fields, which the device samples.
template <class Model>
auto fielded(Model model) {
  return clearance::with_fields(device{}, std::move(model)).model.on(device{});
}
auto spheres_field(const scene& s) { return fielded(sphere_model<clearance::sphere>(s)); }
auto triangles_field(const scene& s) { return fielded(triangle_model<clearance::aabb>(s)); }

void report(benchmark::State& state, std::span<const clearance::min_distance_result> found) {
  double free = 0, near = 0, sum = 0;
  for (const auto& r : found)
    free += r.state == clearance::state::free, near += r.part != clearance::none,
        sum += r.part != clearance::none ? r.distance : 0;
  state.counters["free"] = free, state.counters["minima"] = near,
  state.counters["mean_mm"] = near > 0 ? 1e3 * sum / near : 0;
}

/// A frame's work as a graph, because enqueuing a dozen kernels takes the host longer than the device.
class recorded {
 public:
  template <class F>
  recorded(const device& on, F enqueue) {
    cudaGraph_t graph = nullptr;
    check_cuda(cudaStreamBeginCapture(on.stream, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
    enqueue();
    check_cuda(cudaStreamEndCapture(on.stream, &graph), "cudaStreamEndCapture");
    check_cuda(cudaGraphInstantiate(&run_, graph, 0), "cudaGraphInstantiate");
    check_cuda(cudaGraphDestroy(graph), "cudaGraphDestroy");
    check_cuda(cudaGraphUpload(run_, nullptr), "cudaGraphUpload");
  }
  recorded(recorded&& other) noexcept : run_(std::exchange(other.run_, nullptr)) {}
  ~recorded() {
    if (run_ != nullptr) cudaGraphExecDestroy(run_);
  }
  void operator()() const { check_cuda(cudaGraphLaunch(run_, nullptr), "cudaGraphLaunch"); }

 private:
  cudaGraphExec_t run_ = nullptr;
};

void report(benchmark::State& state, const std::vector<clearance::state>& found) {
  double free = 0, near = 0;
  for (const auto its : found) free += its == clearance::state::free, near += its == clearance::state::collision;
  state.counters["free"] = free, state.counters["collision"] = near;
}

/// Asks about `frames` in turn, by `enqueue(query, cloud)`.
template <class Q, class View, class Enqueue>
void ask(benchmark::State& state, const device& gpu, clearance::query<Q, device, View>& query,
         const std::vector<Eigen::Isometry3d>& poses, const std::vector<std::vector<vec3>>& frames, bool warm,
         Enqueue ask_of) {
  query.place(poses);
  decltype(ask_of(query, placed{point_span()})) results = nullptr;
  std::vector<clearance::device_buffer<vec3>> there;
  std::vector<recorded> turns;
  for (const auto& frame : frames) {
    there.push_back(gpu.copy_in(std::span<const vec3>(frame)));
    const auto enqueue = [&] {
      results =
          ask_of(query, placed{point_span(there.back().data(), there.back().size()), the_scene().world_from_camera});
    };
    enqueue();  // once outside of a graph, because it allocates
    gpu.wait();
    turns.emplace_back(gpu, enqueue);
  }
  const device_clock clock(true);
  std::size_t n = 0;
  for (auto _ : state) {
    if (!warm) query.forget(), gpu.wait();
    const recorded& turn = turns[n++ % turns.size()];
    state.SetIterationTime(clock.seconds([&] { turn(); }));
  }
  report(state, gpu.copy_out(results, Q::each_part ? poses.size() : poses.size() / the_scene().poses.size()));
}

template <class Model>
void ask(benchmark::State& state, const Model& model, const std::vector<Eigen::Isometry3d>& poses,
         const std::vector<std::vector<vec3>>& frames, float d_max, bool warm) {
  const clearance::own_stream stream(0);
  const device gpu = stream.on();
  clearance::query query(gpu, model, clearance::min_distances{});
  ask(state, gpu, query, poses, frames, warm,
      [d_max](auto& its, const auto& cloud) { return its.enqueue(cloud, clearance::min_distances{d_max}); });
}

template <class Make>
void random(benchmark::State& state, Make make, float d_max) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  ask(state, make(s), random_configurations(std::size_t(state.range(0))), {s.cloud}, d_max, false);
}
/// Each part's least distances.
template <class Make>
void parts(benchmark::State& state, Make make, float d_max) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const clearance::own_stream stream(0);
  const device gpu = stream.on();
  const auto model = make(s);
  clearance::query query(gpu, model, clearance::min_distances_per_part{});
  ask(state, gpu, query, random_configurations(std::size_t(state.range(0))), {s.cloud}, false,
      [d_max](auto& its, const auto& cloud) { return its.enqueue(cloud, clearance::min_distances_per_part{d_max}); });
}
template <class Make>
void states(benchmark::State& state, Make make, double margin) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const clearance::own_stream stream(0);
  const device gpu = stream.on();
  const auto model = make(s);
  clearance::query query(gpu, model, clearance::in_collisions{});
  ask(state, gpu, query, random_configurations(std::size_t(state.range(0))), {s.cloud}, false,
      [margin](auto& its, const auto& cloud) { return its.enqueue(cloud, clearance::in_collisions{{margin}}); });
}
/// The frame as a depth image: nearly the same points, but its tree needs no sort.
template <class Make, class Q>
void ask_image(benchmark::State& state, Make make, const Q& q) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const clearance::own_stream stream(0);
  const device gpu = stream.on();
  std::vector<float> depths;
  for (const vec3& p : s.cloud) depths.push_back(p.z);
  const auto there = gpu.copy_in(std::span<const float>(depths));
  const clearance::depth_image seen(there.data(), 640, 480, {525, 525, 319.5, 239.5});
  const auto model = make(s);
  clearance::query query(gpu, model, q);
  ask(state, gpu, query, random_configurations(std::size_t(state.range(0))), {s.cloud}, false,
      [&](auto& its, const auto&) { return its.enqueue(placed{seen, s.world_from_camera}, q); });
}
template <class Make>
void image(benchmark::State& state, Make make, float d_max) {
  ask_image(state, make, clearance::min_distances{d_max});
}
template <class Make>
void image_states(benchmark::State& state, Make make, double margin) {
  ask_image(state, make, clearance::in_collisions{{margin}});
}
template <class Make>
void monitor(benchmark::State& state, Make make, float d_max) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  ask(state, make(s), trajectory(std::size_t(state.range(0))), {next_frame(s.cloud, 1), next_frame(s.cloud, 2)}, d_max,
      true);
}

/// Waits for answers about points that are already there. `ask(gpu, model)` makes the function of `(poses, cloud)`.
template <class Make, class Ask>
void waited(benchmark::State& state, Make make, Ask ask) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const device gpu;
  const auto model = make(s);
  const auto poses = random_configurations(std::size_t(state.range(0)));
  const auto there = gpu.copy_in(std::span<const vec3>(s.cloud));
  auto asked = ask(gpu, model);
  decltype(asked(poses, placed{point_span(), s.world_from_camera})) found;
  for (auto _ : state) found = asked(poses, placed{point_span(there.data(), there.size()), s.world_from_camera});
  report(state, found);
}
template <class Make>
void call(benchmark::State& state, Make make) {
  waited(state, make, [](const device& gpu, const auto& model) {
    return [&](const auto& poses, const auto& cloud) {
      return clearance::ask(gpu, model, poses, cloud, clearance::min_distances{}).of;
    };
  });
}
/// Each part's least distances, to compare with `call`'s one for all parts.
template <class Make>
void each_part(benchmark::State& state, Make make) {
  waited(state, make, [](const device& gpu, const auto& model) {
    return [&](const auto& poses, const auto& cloud) {
      return clearance::ask(gpu, model, poses, cloud, clearance::min_distances_per_part{}).all;
    };
  });
}
/// The same by a prepared question.
template <class Make>
void each_part_prepared(benchmark::State& state, Make make) {
  waited(state, make, [](const device& gpu, const auto& model) {
    return
        [query = std::make_unique<
             clearance::query<clearance::min_distances_per_part, device, typename decltype(model.view())::part_type>>(
             gpu, model, clearance::min_distances_per_part{})](const auto& poses, const auto& cloud) {
          return std::span((*query)(poses, cloud).all);
        };
  });
}

/// The fields of all parts, sampled on the device, until they are in the host's memory.
template <class Model>
void sample(benchmark::State& state, Model (*make)(const scene&, clearance::build_options)) {
  if (no_device(state)) return;
  const auto model = make(the_scene(), {});
  for (auto _ : state) {
    const auto fielded = clearance::with_fields(device{}, model).model;
    benchmark::DoNotOptimize(fielded.view());
  }
}

constexpr float all = clearance::infinity;
#define TIMES(n) ->Arg(n)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(30)
#define CALLS(n) ->Arg(n)->UseRealTime()->Unit(benchmark::kMicrosecond)->Iterations(10)
#define BOTH(function, name, make, n, ...)                       \
  BENCHMARK_CAPTURE(function, name, make, __VA_ARGS__) TIMES(n); \
  BENCHMARK_CAPTURE(function, name##_by_field, make##_field, __VA_ARGS__) TIMES(n)
BOTH(random, spheres, spheres, 4096, all);
BOTH(random, spheres_within_5cm, spheres, 4096, 0.05f);
BOTH(random, triangles, triangles, 4096, all);
BOTH(random, triangles_within_5cm, triangles, 4096, 0.05f);
BENCHMARK_CAPTURE(random, tree_alone, spheres, -1.0f) TIMES(1);
BOTH(parts, spheres, spheres, 4096, all);
BOTH(parts, spheres_within_5cm, spheres, 4096, 0.05f);
BOTH(parts, triangles, triangles, 4096, all);
BOTH(states, spheres, spheres, 4096, 0);
BOTH(states, spheres_5cm, spheres, 4096, 0.05);
BOTH(states, triangles, triangles, 4096, 0);
BOTH(image, spheres, spheres, 4096, all);
BOTH(image, spheres_within_5cm, spheres, 4096, 0.05f);
BENCHMARK_CAPTURE(image, tree_alone, spheres, 0.05f) TIMES(1);
BOTH(image_states, spheres, spheres, 4096, 0);
BENCHMARK_CAPTURE(image_states, tree_alone, spheres, -1) TIMES(1);
BOTH(monitor, untruncated, spheres, 500, all);
BOTH(monitor, within_20cm, spheres, 500, 0.2f);
BENCHMARK_CAPTURE(call, spheres, spheres) CALLS(4096);
BENCHMARK_CAPTURE(call, spheres_by_field, spheres_field) CALLS(4096);
BENCHMARK_CAPTURE(each_part, spheres, spheres) CALLS(4096);
BENCHMARK_CAPTURE(each_part, spheres_by_field, spheres_field) CALLS(4096);
BENCHMARK_CAPTURE(each_part_prepared, spheres, spheres) CALLS(4096);
BENCHMARK_CAPTURE(each_part_prepared, spheres_by_field, spheres_field) CALLS(4096);
BENCHMARK_CAPTURE(sample, spheres, sphere_model<clearance::sphere>)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK_CAPTURE(sample, triangles, triangle_model<clearance::aabb>)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace configurations_bench

#undef BOTH
#undef CALLS
#undef TIMES

BENCHMARK_MAIN();
