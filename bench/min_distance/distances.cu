// SPDX-License-Identifier: BSD-3-Clause
// Every point's own distance on a GPU that holds the points: cold, and warm with what was nearest in the last frame.
// *fields*, *cells*: to a robot whose parts have them.
// CUDA events, behind other work.
#include "device.cuh"
#include "shell.hpp"
#include "tables.cuh"

#include <clearance/device.cuh>
#include <clearance/points/depth_image.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <algorithm>

namespace distances_bench {
namespace {

using namespace bench;
using clearance::device, clearance::vec3;

/// Alternates two clouds, so that a frame remembers the other one; when cold, each is the first.
template <class Model, class Source>
void ask(benchmark::State& state, const Model& model, const std::vector<Eigen::Isometry3d>& poses,
         const Eigen::Isometry3d& pose, const Source& first, const Source& second, float d_max, bool warm, bool fields,
         bool cells) {
  const device gpu;
  with_tables(gpu, model, {fields, cells}, [&](const auto& there) {
    clearance::query query(gpu, there, clearance::distances{});
    clearance::pointwise::device_points<typename std::remove_cvref_t<decltype(there)>::view_type> once(gpu,
                                                                                                       there.view());
    const clearance::device_buffer<float> out(first.size(), gpu.id);
    const clearance::device_buffer<clearance::point_counts> counts(1, gpu.id);
    const device_clock clock(true);
    const auto frame = [&](const Source& source) {
      const clearance::placed cloud{source, pose};
      if (warm)
        query.enqueue(poses, cloud, {.d_max = d_max}, {{out.data()}, counts.data()});
      else
        once.enqueue(poses, cloud, {out.data()}, d_max, counts.data(), clearance::frames::as_it_is{});
    };
    frame(second);
    for (bool odd = true; auto _ : state)
      state.SetIterationTime(clock.seconds([&] { frame((odd = !odd) ? second : first); }));
    frame(first);
    double sum = 0;
    std::size_t near = 0;
    for (const float d : gpu.copy_out(out))
      if (d < clearance::infinity) sum += d, ++near;
    state.counters["near"] = double(near);
    state.counters["mean_mm"] = 1e3 * sum / double(near);
  });
}

struct options {
  float d_max = clearance::infinity;
  bool warm = false, close = false, fields = false, cells = false;
  clearance::build_options build = {};
};

/// The frame, and the frame with 2 mm of noise; `close`: seen from close_camera().
template <class Make>
void frame(benchmark::State& state, Make make, const options& how) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const std::size_t count = std::size_t(state.range(0));
  const auto points = repeated(s.cloud, count), twice = repeated(s.cloud, count + s.cloud.size());
  const device gpu;
  const auto first = gpu.copy_in(std::span<const vec3>(points));
  const auto second = gpu.copy_in(std::span<const vec3>(twice).subspan(s.cloud.size()));
  ask(state, make(s, how.build), s.poses, how.close ? close_camera() : s.world_from_camera,
      clearance::point_span(first.data(), count), clearance::point_span(second.data(), count), how.d_max, how.warm,
      how.fields, how.cells);
}

constexpr auto of_spheres = [](const scene& s, clearance::build_options build) {
  return sphere_model<clearance::sphere>(s, build);
};
constexpr auto of_triangles = [](const scene& s, clearance::build_options build) {
  return triangle_model<clearance::aabb>(s, build);
};
void spheres(benchmark::State& state, const options& how) { frame(state, of_spheres, how); }
void triangles(benchmark::State& state, const options& how) { frame(state, of_triangles, how); }

/// The same frame as the camera's depth image: its neighbours are known in both directions.
template <class Make>
void image(benchmark::State& state, Make make, const options& how) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  std::vector<float> depth;
  for (const vec3 p : s.cloud) depth.push_back(p.z);
  std::vector<float> noisy;
  for (const vec3 p : std::span(repeated(s.cloud, 2 * s.cloud.size())).subspan(s.cloud.size())) noisy.push_back(p.z);
  const device gpu;
  const auto first = gpu.copy_in(std::span<const float>(depth)), second = gpu.copy_in(std::span<const float>(noisy));
  const clearance::intrinsics camera{525, 525, 320, 240};
  ask(state, make(s, how.build), s.poses, how.close ? close_camera() : s.world_from_camera,
      clearance::depth_image(first.data(), 640, 480, camera), clearance::depth_image(second.data(), 640, 480, camera),
      how.d_max, how.warm, how.fields, how.cells);
}
void spheres_image(benchmark::State& state, const options& how) { image(state, of_spheres, how); }
void triangles_image(benchmark::State& state, const options& how) { image(state, of_triangles, how); }

/// Points of the worst cloud, where only spheres nearer than a point's own distance matter; in random order, or as a
/// sensor sees them, with neighbours side by side (along a Z-curve of 2 mm).
void shell(benchmark::State& state, bool ordered, bool cells) {
  if (no_device(state)) return;
  const scene& s = the_scene();
  const device gpu;
  const auto model = sphere_model<clearance::sphere>(s);
  const clearance::device_buffer<vec3> there(std::size_t(state.range(0)), gpu.id);
  {
    const auto on_gpu = model.on(gpu);
    put_shell(gpu, on_gpu, s.poses, 0.3f, there.data(), there.size());
  }
  if (ordered) put_in_order(gpu, there.data(), there.size());
  const clearance::point_span points(there.data(), there.size());
  ask(state, model, s.poses, Eigen::Isometry3d::Identity(), points, points, 0.3f - 2e-6f, false, false, cells);
}
BENCHMARK_CAPTURE(shell, random, false, false)
    ->Arg(5000000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(20);
BENCHMARK_CAPTURE(shell, ordered, true, false)
    ->Arg(5000000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(20);

BENCHMARK_CAPTURE(shell, cells_random, false, true)
    ->Arg(5000000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(20);
BENCHMARK_CAPTURE(shell, cells_ordered, true, true)
    ->Arg(5000000)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(20);

/// How long cells of all parts take to be made on the device, without the way to it.
template <class Make>
void making_cells(benchmark::State& state, Make make) {
  if (no_device(state)) return;
  const auto model = make(the_scene(), clearance::build_options{});
  double bytes = 0;
  for (auto _ : state) {
    bytes = 0;
    for (const auto& cells : clearance::with_cells(device{}, model).model.cells()) bytes += double(cells.bytes());
  }
  state.counters["MB"] = bytes / 1e6;
}
BENCHMARK_CAPTURE(making_cells, spheres, of_spheres)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK_CAPTURE(making_cells, triangles, of_triangles)->Unit(benchmark::kMillisecond)->Iterations(3);

constexpr options cold{}, warm{.warm = true}, within_10cm{.d_max = 0.1f}, close_cold{.close = true},
    close_warm{.warm = true, .close = true}, fields{.fields = true}, fields_10cm{.d_max = 0.1f, .fields = true},
    fields_close{.close = true, .fields = true}, fields_warm{.warm = true, .fields = true}, cells{.cells = true},
    cells_10cm{.d_max = 0.1f, .cells = true}, cells_close{.close = true, .cells = true};
#define TIMES ->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(30)
#define FRAMES ->Arg(307200)->Arg(5000000) TIMES
BENCHMARK_CAPTURE(spheres, untruncated, cold) FRAMES;
BENCHMARK_CAPTURE(spheres, warm, warm) FRAMES;
BENCHMARK_CAPTURE(spheres, within_10cm, within_10cm) FRAMES;
BENCHMARK_CAPTURE(triangles, untruncated, cold) FRAMES;
BENCHMARK_CAPTURE(triangles, warm, warm) FRAMES;
BENCHMARK_CAPTURE(triangles, within_10cm, within_10cm) FRAMES;
BENCHMARK_CAPTURE(triangles, close, close_cold)->Arg(307200)->Arg(16 * 307200) TIMES;
BENCHMARK_CAPTURE(triangles, close_warm, close_warm)->Arg(307200)->Arg(16 * 307200) TIMES;
BENCHMARK_CAPTURE(spheres_image, untruncated, cold) TIMES;
BENCHMARK_CAPTURE(triangles_image, untruncated, cold) TIMES;
BENCHMARK_CAPTURE(triangles_image, warm, warm) TIMES;
BENCHMARK_CAPTURE(triangles_image, close, close_cold) TIMES;
BENCHMARK_CAPTURE(triangles_image, close_warm, close_warm) TIMES;
BENCHMARK_CAPTURE(spheres, fields, fields) FRAMES;
BENCHMARK_CAPTURE(spheres, fields_within_10cm, fields_10cm) FRAMES;
BENCHMARK_CAPTURE(triangles, fields, fields) FRAMES;
BENCHMARK_CAPTURE(triangles, fields_close, fields_close)->Arg(307200) TIMES;
BENCHMARK_CAPTURE(spheres_image, fields, fields) TIMES;
BENCHMARK_CAPTURE(triangles_image, fields, fields) TIMES;
BENCHMARK_CAPTURE(triangles_image, fields_warm, fields_warm) TIMES;
BENCHMARK_CAPTURE(triangles_image, fields_close, fields_close) TIMES;
BENCHMARK_CAPTURE(spheres, cells, cells) FRAMES;
BENCHMARK_CAPTURE(spheres, cells_within_10cm, cells_10cm) FRAMES;
BENCHMARK_CAPTURE(spheres_image, cells, cells) TIMES;
BENCHMARK_CAPTURE(triangles, cells, cells) FRAMES;
BENCHMARK_CAPTURE(triangles, cells_within_10cm, cells_10cm) FRAMES;
BENCHMARK_CAPTURE(triangles, cells_close, cells_close)->Arg(307200)->Arg(16 * 307200) TIMES;
BENCHMARK_CAPTURE(triangles_image, cells, cells) TIMES;
BENCHMARK_CAPTURE(triangles_image, cells_close, cells_close) TIMES;

}  // namespace
}  // namespace distances_bench

#undef TIMES

BENCHMARK_MAIN();
