// SPDX-License-Identifier: BSD-3-Clause
// A robot description and depth images in, a distance for every link out.
#include <clearance/backends/host.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <ranges>

/// Stands for your robot: a column with an arm on a hinge. The hinge is 0.5 m above the base.
std::filesystem::path write_robot() {
  const auto file = std::filesystem::temp_directory_path() / "clearance_example_robot.urdf";
  std::ofstream(file) << R"(<robot name="hinge">
    <link name="column"><collision><origin xyz="0 0 0.25"/><geometry><box size="0.1 0.1 0.5"/></geometry></collision></link>
    <link name="arm"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.06 0.06"/></geometry></collision></link>
    <joint name="hinge" type="revolute"><parent link="column"/><child link="arm"/><origin xyz="0 0 0.5"/>
      <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>)";
  return file;
}

int main() {
  const auto file = write_robot();
  // [load]
  // Once: read the robot, fill its links with spheres, build their trees.
  const clearance::io::robot robot = clearance::io::load_robot(file);
  const auto& links = robot.parts();
  // [pack]
  const auto packed = clearance::pack(links | std::views::transform(&clearance::io::robot_part::mesh), {.count = 100});
  // [pack]
  const auto arm = clearance::make_model<clearance::sphere>(
      packed, [&](std::size_t k) { return clearance::part_options{.tolerance = links[k].tessellation_error}; });
  // [load]
  std::filesystem::remove(file);

  // A camera 3 m in front of the base looks back at it, and sees a wall that stands 1 m from the base. (It looks along
  // the world's -x; its own axes are z forward, x right, y down.)
  const std::vector<std::uint16_t> pixels(64 * 48, 2000);
  const clearance::depth_image<std::uint16_t> image(pixels.data(), 64, 48,
                                                    {.fx = 60, .fy = 60, .cx = 31.5, .cy = 23.5});
  Eigen::Isometry3d camera = Eigen::Isometry3d::Identity();
  camera.linear().col(0) = Eigen::Vector3d::UnitY(), camera.linear().col(1) = -Eigen::Vector3d::UnitZ();
  camera.linear().col(2) = -Eigen::Vector3d::UnitX();
  camera.translation() << 3, 0, 0.5;

  int stops = 0;
  clearance::min_distance_result last;
  // [frames]
  // In every frame: where the links are now, and what the camera sees.
  for (const double angle : {1.5, 0.75, 0.0}) {
    const std::vector<Eigen::Isometry3d> poses = robot.poses(std::vector{angle});
    last = clearance::ask(clearance::host{}, arm, poses, image, camera, clearance::min_distance{});
    std::printf("hinge at %.2f rad: %s is %.4f m from pixel (%u, %u), certainly at least %.4f m\n", angle,
                robot.parts()[last.part].name.c_str(), last.distance, last.point % 64, last.point / 64, last.lower);
    if (!(last.lower > 0.6)) ++stops;  // also if there was no valid point
  }
  // [frames]

  // At 0 rad the arm points at the wall, and ends 0.6 m before it.
  return stops == 1 && last.lower <= 0.6 && 0.6 <= last.upper && robot.parts()[last.part].name == "arm" ? 0 : 1;
}
