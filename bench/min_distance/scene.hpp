// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The scene of the benchmarks of the minimum: a KUKA LWR in front of a table seen by a depth camera, if the real data
// is there; otherwise the scene of `clearance demo`, made by code.

#include "../../tools/demo_scene.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <chrono>
#include <cstdio>
#include <filesystem>

namespace bench {

struct scene {
  std::string name;
  std::vector<clearance::closed_mesh> meshes;
  std::vector<clearance::packing> packings;  ///< 2,048 inner spheres per link.
  std::vector<Eigen::Isometry3d> poses;
  std::vector<clearance::vec3> cloud;  ///< One 640 x 480 frame, in the camera's frame.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  double packing_seconds = 0;
};

/// A camera that looks along `forward`, its x axis level.
inline Eigen::Isometry3d looking(const Eigen::Vector3d& from, Eigen::Vector3d forward) {
  forward.normalize();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(2) = forward;
  pose.linear().col(0) = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.linear().col(1) = forward.cross(pose.linear().col(0));
  pose.translation() = from;
  return pose;
}

/// Another place for the camera: the median point is a third of a metre from the robot.
inline Eigen::Isometry3d close_camera() { return looking({1.62, -0.1, 1.05}, {-0.75, 0.1, -0.65}); }

inline void pack_all(scene& s) {
  const auto start = std::chrono::steady_clock::now();
  s.packings = clearance::pack(s.meshes, {.count = 2048});
  s.packing_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline scene demo(bool packed) {
  const demo_scene made = make_demo_scene(1);
  scene s;
  s.name = "demo";
  for (const auto& part : made.parts) {
    s.meshes.push_back(clearance::close_mesh(part.mesh));
    s.poses.push_back(part.pose);
  }
  const clearance::depth_image image(made.depth.data(), made.width, made.height, made.camera);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const auto point = image[i];
    constexpr auto nan = clearance::not_a_number;
    s.cloud.push_back(point.valid() ? point.position : clearance::vec3{nan, nan, nan});
  }
  s.world_from_camera = made.world_from_camera;
  if (packed) pack_all(s);
  return s;
}

inline clearance::io::robot load_kuka(const std::filesystem::path& data) {
  clearance::io::robot_options options;
  options.geometry = clearance::io::robot_geometry::visual;
  return clearance::io::load_robot(data / "robots/kuka_lwr4plus_cad/kuka_lwr4plus.urdf", options);
}

inline const std::vector<double> kuka_joints{0, 0.6, 0, -1.4, 0, 0.5, 0};

/// The scene of all figures of this library; the robot's links are about 10 cm from the nearest point.
inline scene kuka(const std::filesystem::path& data, bool packed) {
  const auto robot = load_kuka(data);
  scene s;
  s.name = "kuka";
  for (const auto& part : robot.parts()) s.meshes.push_back(clearance::close_mesh(part.mesh));
  s.poses = robot.poses(kuka_joints);
  s.cloud = clearance::io::load_cloud((data / "clouds/kinect_seq/frame_20121214T142255.814212.pcd").string())
                .relative_to({0, 0, 0})
                .points;
  s.world_from_camera = looking({2.18, -0.1, 1.25}, {-0.75, 0.1, -0.65});
  if (packed) pack_all(s);
  return s;
}

/// The KUKA if its data is there, else the demo; not packed if triangles are enough.
template <bool Packed = true>
const scene& the_scene() {
  static const scene s = [] {
    const std::filesystem::path data = CLEARANCE_TEST_DATA;
    const bool real = !data.empty() && std::filesystem::exists(data / "robots/kuka_lwr4plus_cad/kuka_lwr4plus.urdf");
    if (!real) std::fprintf(stderr, "No real data: this is the scene of clearance demo instead of the KUKA LWR.\n");
    scene made = real ? kuka(data, Packed) : demo(Packed);
    if (Packed)
      std::fprintf(stderr, "%s: %zu links packed with 2,048 spheres each in %.2f s\n", made.name.c_str(),
                   made.meshes.size(), made.packing_seconds);
    return made;
  }();
  return s;
}

template <class V>
auto sphere_model(const scene& s, clearance::build_options options = {}) {
  return clearance::make_model<V>(s.packings, clearance::part_options{.build = options});
}

template <class V>
auto triangle_model(const scene& s, clearance::build_options options = {}) {
  return clearance::make_model<V>(s.meshes, clearance::part_options{.build = options});
}

}  // namespace bench
