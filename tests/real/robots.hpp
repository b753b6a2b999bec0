// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots and depth frames as found, from the data folder.

#include "support/laws.hpp"
#include "support/places.hpp"
#include "support/scenes.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/png.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/robot/model.hpp>

namespace testing {

inline const std::string data_folder = testing::data();

/// A robot read, closed and packed once.
struct real_robot {
  clearance::io::robot description;
  std::vector<clearance::closed_mesh> solids;
  std::vector<clearance::packing> packings;

  real_robot(const std::string& urdf, std::size_t spheres,
             clearance::io::robot_geometry geometry = clearance::io::robot_geometry::collision)
      : description(clearance::io::load_robot(data_folder + "/robots/" + urdf, {.geometry = geometry})) {
    for (const auto& part : description.parts()) solids.push_back(clearance::close_mesh(part.mesh));
    packings = clearance::pack(solids, {.count = spheres});
  }

  template <class V>
  auto triangles() const {
    std::vector<decltype(clearance::make_part<V>(solids[0]))> parts;
    for (std::size_t k = 0; k < solids.size(); ++k)
      parts.push_back(clearance::make_part<V>(solids[k], {.tolerance = description.parts()[k].tessellation_error}));
    return clearance::model(std::move(parts));
  }
  template <class V>
  auto spheres() const {
    std::vector<decltype(clearance::make_part<V>(packings[0]))> parts;
    for (std::size_t k = 0; k < packings.size(); ++k)
      parts.push_back(clearance::make_part<V>(packings[k], {.tolerance = description.parts()[k].tessellation_error}));
    return clearance::model(std::move(parts));
  }
  /// Standing at `base`, every joint a little away from rest.
  std::vector<Eigen::Isometry3d> poses(const Eigen::Isometry3d& base, double bend) const {
    const auto& tree = description.kinematics();
    auto values = tree.rest();
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto& joint = tree.movable(k);
      const double wanted = values[k] + (k % 2 ? bend : -bend);
      values[k] = std::clamp(wanted, joint.lower, joint.upper);
    }
    auto all = description.poses(values);
    for (auto& pose : all) pose = base * pose;
    return all;
  }
};

/// world-from-camera: at (x, y, z), looking horizontally towards the z axis of the world.
inline Eigen::Isometry3d looking_inward(double x, double y, double z) {
  const Eigen::Vector3d forward = Eigen::Vector3d(-x, -y, 0).normalized(), down(0, 0, -1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = down.cross(forward);
  pose.linear().col(1) = down;
  pose.linear().col(2) = forward;
  pose.translation() << x, y, z;
  return pose;
}

inline constexpr clearance::intrinsics kinect{525, 525, 320, 240};
inline const char* const kinect_frames[] = {"20121214T142255.814212", "20121214T142256.068683",
                                            "20121214T142256.332395"};

inline clearance::depth_image<std::uint16_t> view_of(const clearance::io::depth_frame& frame,
                                                     const clearance::intrinsics& camera, double scale) {
  return {frame.pixels.data(), std::uint32_t(frame.width), std::uint32_t(frame.height), camera, scale};
}

/// A frame of the Amazon Picking Challenge: bits turned by three, tenths of a millimetre.
inline clearance::io::depth_frame shelf_frame(int number) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d", number);
  auto frame = clearance::io::load_png(data_folder + "/clouds/realsense_arm/frame-" + name + ".depth.png");
  for (auto& v : frame.pixels) v = std::uint16_t(v << 13 | v >> 3);
  return frame;
}
inline constexpr clearance::intrinsics shelf_camera{477.584259, 477.584167, 314.188080, 245.884354};

}  // namespace testing
