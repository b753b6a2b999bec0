// SPDX-License-Identifier: BSD-3-Clause
#include "scale_notes.hpp"

#include "report_text.hpp"

#include <cmath>

using namespace clearance;

namespace {

/// The diagonal of the box around points in the world, and their number.
struct extent_of_all {
  Eigen::AlignedBox3d box;
  std::size_t points = 0;

  void add(const Eigen::Vector3d& p) {
    box.extend(p);
    ++points;
  }
  double size() const { return points == 0 ? 0 : box.diagonal().norm(); }
};

}  // namespace

void note_scale(const std::vector<seen_points>& clouds, const std::vector<body>& bodies, poses_of poses,
                const min_distance_result& nearest, std::vector<std::string>& notes) {
  if (nearest.state == state::no_data) return;
  extent_of_all seen, robot;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    for (const Eigen::Vector3d& v : bodies[k].closed.surface.vertices) robot.add(poses[k] * v);
    for (const inner_sphere& s : bodies[k].packed.spheres)
      robot.add(poses[k] * Eigen::Vector3d(s.center.x, s.center.y, s.center.z));
  }

  const double size = robot.size();
  bool images = true;
  for (const seen_points& cloud : clouds)
    std::visit(
        [&](const auto& source) {
          images = images && requires { source.pixels; };
          for (std::size_t i = 0; i < source.size() && size > 100 * seen.size(); ++i)  // it ends after a few points
            if (const sample s = source[i]; s.valid())
              seen.add(cloud.pose * Eigen::Vector3d(s.position.x, s.position.y, s.position.z));
        },
        cloud.points);

  const char* const option = images ? "--depth-scale" : "--cloud-scale";
  if (nearest.distance > 50)
    notes.push_back(
        text("no point is within 50 m of the robot, the nearest is %.4g m away: are they in metres? %s "
             "says what their unit is",
             double(nearest.distance), option));
  const double times = size / seen.size();
  if (seen.points < 2 || !(times > 100) || !std::isfinite(times)) return;
  notes.push_back(
      text("the robot is %.3g times as large as all that the clouds show, which is %.3g m: ", times, seen.size()) +
      (times > 1000 ? std::string("are its meshes in metres?") : std::string("what is the clouds' unit?")) + " (" +
      option + ")");
}
