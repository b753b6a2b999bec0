// SPDX-License-Identifier: BSD-3-Clause
// A PointCloud2, and a depth image with its CameraInfo, asked about where they lie. The messages here have the members
// of ROS 2's, but nothing of ROS is needed.
#include <clearance/backends/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/points/camera.hpp>
#include <clearance/points/point_cloud2.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

struct point_field_message {
  std::string name;
  std::uint32_t offset;
  std::uint8_t datatype;
  std::uint32_t count;
};
struct point_cloud2_message {
  std::uint32_t height, width;
  std::vector<point_field_message> fields;
  bool is_bigendian;
  std::uint32_t point_step, row_step;
  std::vector<std::uint8_t> data;
};
struct camera_info_message {
  std::uint32_t height, width;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k;
  std::uint32_t binning_x, binning_y;
};
struct image_message {
  std::uint32_t height, width;
  std::vector<std::uint16_t> pixels;  // ROS 2 has bytes
};

/// Three points with an intensity, 18 bytes each.
point_cloud2_message a_cloud() {
  point_cloud2_message m{1,  3, {{"intensity", 0, 4, 1}, {"x", 2, 7, 1}, {"y", 6, 7, 1}, {"z", 10, 7, 1}}, false, 18,
                         54, {}};
  m.data.resize(54);
  const float points[3][3] = {{0, 0, 2}, {0.5f, 0, 0.5f}, {0, 1, 1}};
  for (std::size_t i = 0; i < 3; ++i) std::memcpy(m.data.data() + 18 * i + 2, points[i], 12);
  return m;
}

}  // namespace

int main() {
  const std::vector<clearance::inner_sphere> ball = {{{0, 0, 0.5f}, 0.25f}};
  const auto part = clearance::make_part(clearance::build<clearance::sphere>(ball));
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const clearance::host cpu;
  const point_cloud2_message message = a_cloud();

  // [cloud]
  const auto cloud = clearance::point_cloud2_view(message);  // zero copy; throws if the message contradicts itself
  const auto to_cloud = clearance::ask(cpu, part, pose, cloud, clearance::min_distance{});
  // [cloud]

  const camera_info_message info{48, 64, "plumb_bob", {-0.2, 0.03, 0, 0, 0}, {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1}, 0, 0};
  const image_message depth{48, 64, std::vector<std::uint16_t>(64 * 48, 1000)};  // a wall, 1 m ahead

  // [camera]
  const clearance::camera camera({.width = info.width,
                                  .height = info.height,
                                  .distortion_model = info.distortion_model,
                                  .d = info.d,
                                  .k = info.k,
                                  .binning_x = info.binning_x,
                                  .binning_y = info.binning_y});
  const clearance::ray_table table = camera.rays();                         // once; table.blind pixels have no ray
  const auto image = table.image(depth.pixels, depth.width, depth.height);  // throws if of another size
  // [camera]
  const auto to_wall = clearance::ask(cpu, part, pose, image, clearance::min_distance{});

  std::printf("%.4f m to point %u of the cloud, %.4f m to the wall; %zu pixels without a ray\n", to_cloud.distance,
              to_cloud.point, to_wall.distance, table.blind);
  return to_cloud.point == 1 && std::abs(to_cloud.distance - 0.25f) < 1e-6f && table.blind == 0 &&
                 std::abs(to_wall.distance - 0.25f) < 1e-3f
             ? 0
             : 1;
}
