// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The scene of the demonstration: an arm with a depth camera on its hand, in front of a table with boxes.

#include "demo_arm.hpp"

#include <clearance/points/depth_image.hpp>

#include <algorithm>
#include <limits>
#include <random>

/// A box around its own centre; `half` holds half of each side.
struct demo_box {
  Eigen::Isometry3d pose;
  Eigen::Vector3d half;
};

struct demo_scene {
  std::vector<demo_part> parts;
  std::vector<demo_box> boxes;       // what the camera looks at, without noise
  std::vector<std::uint16_t> depth;  // millimetres, 0 where the sensor sees nothing
  std::uint32_t width = 640, height = 480;
  clearance::intrinsics camera{525, 525, 319.5, 239.5};
  Eigen::Isometry3d world_from_camera;
};

/// Random numbers that are the same with every standard library.
class demo_random {
 public:
  explicit demo_random(unsigned seed) : bits_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (double(bits_()) + 0.5) / 4294967296.0; }
  double normal() {  // Box and Muller
    const double r = std::sqrt(-2 * std::log(uniform(0, 1)));
    return r * std::cos(uniform(0, 2 * std::numbers::pi));
  }

 private:
  std::mt19937 bits_;
};

/// Where a ray enters a box: `along` in lengths of the direction, `cosine` of the angle to the face's normal.
struct demo_hit {
  double along = std::numeric_limits<double>::infinity(), cosine = 0;
};

inline demo_hit hit(const demo_box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Matrix3d turn = box.pose.linear().transpose();
  const Eigen::Vector3d o = turn * (origin - box.pose.translation()), d = turn * direction;
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  int face = -1;
  for (int k = 0; k < 3; ++k) {
    const double one = (-box.half[k] - o[k]) / d[k], other = (box.half[k] - o[k]) / d[k];
    const double low = std::min(one, other), high = std::max(one, other);
    if (low > enter) {
      enter = low;
      face = k;
    }
    leave = std::min(leave, high);
  }
  if (face < 0 || !(enter <= leave)) return {};
  return {enter, std::abs(d[face]) / d.norm()};
}

/// A floor, a table, a box close to the hand, and five more that `random` puts farther away.
inline std::vector<demo_box> make_demo_boxes(demo_random& random) {
  constexpr double table = 0.35;
  const auto box = [](double x, double y, double bottom, double degrees, Eigen::Vector3d sides) {
    Eigen::Isometry3d pose(Eigen::Translation3d(x, y, bottom + sides.z() / 2));
    pose.rotate(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
    return demo_box{pose, sides / 2};
  };
  std::vector<demo_box> boxes{box(1, 0, -0.1, 0, {8, 8, 0.1}), box(1.0, 0.1, table - 0.04, 0, {1.0, 1.4, 0.04}),
                              box(0.90, 0.25, table, 30, {0.08, 0.07, 0.19})};
  for (int i = 0; i < 5; ++i)
    boxes.push_back(box(random.uniform(1.05, 1.4), -0.35 + 0.24 * i + random.uniform(-0.04, 0.04), table,
                        random.uniform(0, 90),
                        {random.uniform(0.06, 0.18), random.uniform(0.06, 0.18), random.uniform(0.05, 0.22)}));
  return boxes;
}

/// The same scene for the same seed. Noise grows with the square of the depth, as for triangulating sensors. Pixels are
/// missing at random, at grazing angles, beyond 4 m, and in shadows beside nearer objects.
inline demo_scene make_demo_scene(unsigned seed = 1) {
  demo_random random(seed);
  demo_scene scene;
  scene.parts = make_demo_arm();
  scene.boxes = make_demo_boxes(random);
  // In front of the hand, looking away from it, so that the arm is never in view.
  scene.world_from_camera = scene.parts.back().pose;
  scene.world_from_camera.translate(Eigen::Vector3d(0, 0, 0.135));
  scene.world_from_camera.rotate(Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));

  const std::size_t width = scene.width, pixels = width * scene.height;
  std::vector<demo_hit> seen(pixels);
  const Eigen::Vector3d origin = scene.world_from_camera.translation();
  for (std::size_t i = 0; i < pixels; ++i) {
    const Eigen::Vector3d ray((double(i % width) - scene.camera.cx) / scene.camera.fx,
                              (double(i / width) - scene.camera.cy) / scene.camera.fy, 1);
    for (const demo_box& box : scene.boxes)
      if (const demo_hit h = hit(box, origin, scene.world_from_camera.linear() * ray); h.along < seen[i].along)
        seen[i] = h;
  }
  scene.depth.assign(pixels, 0);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double z = seen[i].along, missing = random.uniform(0, 1), noise = random.normal();  // drawn for every pixel
    bool shadow = false;
    for (std::size_t k = 1; k <= 6 && i % width + k < width; ++k) shadow = shadow || seen[i + k].along < 0.9 * z - 0.02;
    if (!(z < 4) || seen[i].cosine < 0.1 || shadow || missing < 0.015) continue;
    scene.depth[i] = std::uint16_t(std::lround(1000 * (z + (0.0004 + 0.0019 * z * z) * noise)));
  }
  return scene;
}
