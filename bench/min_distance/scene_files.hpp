// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The scene in files, for peers not written in C++.

#include "scene.hpp"

#include <benchmark/benchmark.h>

#include <array>
#include <fstream>
#include <string_view>

namespace bench {

/// Triangles in the camera's frame, for peers. Those without area are left out, because some peers fail on them.
inline std::vector<std::array<Eigen::Vector3d, 3>> robot_in_camera(const scene& s) {
  std::vector<std::array<Eigen::Vector3d, 3>> all;
  for (std::size_t k = 0; k < s.meshes.size(); ++k) {
    const Eigen::Isometry3d pose = s.world_from_camera.inverse() * s.poses[k];
    const auto& vertices = s.meshes[k].surface.vertices;
    const auto& faces = s.meshes[k].surface.triangles;
    for (const auto& f : faces)
      if ((vertices[f[1]] - vertices[f[0]]).cross(vertices[f[2]] - vertices[f[0]]).norm() > 0)
        all.push_back({pose * vertices[f[0]], pose * vertices[f[1]], pose * vertices[f[2]]});
  }
  return all;
}

/// Writes triangle corners and points to two files of `folder`: x y z as floats, both in the camera's frame.
inline int write_scene(const std::filesystem::path& folder) {
  const scene& s = the_scene<false>();
  const auto write = [&](const char* name, const std::vector<clearance::vec3>& all) {
    std::ofstream file(folder / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(all.data()), std::streamsize(all.size() * sizeof all[0]));
    return bool(file.flush());
  };
  std::vector<clearance::vec3> corners;
  for (const auto& t : robot_in_camera(s))
    for (const auto& v : t) corners.push_back({float(v.x()), float(v.y()), float(v.z())});
  return write("robot.f32", corners) && write("points.f32", s.cloud) ? 0 : 1;
}

/// Replaces BENCHMARK_MAIN: `--write-scene FOLDER` writes the scene and measures nothing.
inline int run_all(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--write-scene") return write_scene(argv[2]);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace bench
