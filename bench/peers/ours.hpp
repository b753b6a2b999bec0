// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Ours beside each peer, in the same run: the exact distance of one frame to all triangles, no frame before it, one
// thread.

#include "min_distance/scene.hpp"

#include <clearance/io/robot.hpp>
#include <clearance/min_distance_query.hpp>
#include <clearance/volume/aabb.hpp>

#include <benchmark/benchmark.h>

#include <fstream>

namespace peers {

inline const bench::scene& scene() { return bench::the_scene<false>(); }

/// Triangles in the camera's frame, as a peer gets them; those without area are left out, because some peers fail on
/// them.
inline std::vector<std::array<Eigen::Vector3d, 3>> robot_in_camera() {
  std::vector<std::array<Eigen::Vector3d, 3>> all;
  for (std::size_t k = 0; k < scene().meshes.size(); ++k) {
    const Eigen::Isometry3d pose = scene().world_from_camera.inverse() * scene().poses[k];
    const auto& [vertices, faces] = scene().meshes[k].surface;
    for (const auto& f : faces)
      if ((vertices[f[1]] - vertices[f[0]]).cross(vertices[f[2]] - vertices[f[0]]).norm() > 0)
        all.push_back({pose * vertices[f[0]], pose * vertices[f[1]], pose * vertices[f[2]]});
  }
  return all;
}

inline void ours_cold(benchmark::State& state) {
  const auto model = bench::triangle_model<clearance::aabb>(scene());
  const clearance::placed<clearance::point_span> cloud{scene().cloud, scene().world_from_camera};
  clearance::min_distance_query query(clearance::host{.threads = 1}, model);
  clearance::min_distance_result r;
  for (auto _ : state) {
    query.forget();
    r = query(scene().poses, cloud);
  }
  state.counters["distance_mm"] = r.distance * 1e3;
}

/// For peers that are no C++: corners of triangles and points, x y z as floats, in two files of `folder`.
inline int write_scene(const std::filesystem::path& folder) {
  const auto write = [&](const char* name, const std::vector<clearance::vec3>& all) {
    std::ofstream file(folder / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(all.data()), std::streamsize(all.size() * sizeof all[0]));
    return bool(file.flush());
  };
  std::vector<clearance::vec3> corners;
  for (const auto& t : robot_in_camera())
    for (const auto& v : t) corners.push_back({float(v.x()), float(v.y()), float(v.z())});
  return write("robot.f32", corners) && write("points.f32", scene().cloud) ? 0 : 1;
}

/// Instead of BENCHMARK_MAIN: `--write-scene FOLDER` writes the scene, and measures nothing.
inline int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "--write-scene") return write_scene(argv[2]);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace peers
