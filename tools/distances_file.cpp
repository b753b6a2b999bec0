// SPDX-License-Identifier: BSD-3-Clause
#include "distances_file.hpp"

#include <clearance/io/distance_colour.hpp>
#include <clearance/io/ply_writer.hpp>

#include <cmath>
#include <cstdio>

using namespace clearance;

namespace {

double blue_at(const query_options& asked) { return std::isfinite(asked.d_max) ? asked.d_max : 1; }

}  // namespace

distances_written write_distances(const query_options& asked, const asked_clouds& clouds, const point_distances& found) {
  distances_written made{.blue_at = blue_at(asked)};
  std::vector<Eigen::Vector3d> positions;
  std::vector<float> distance;
  std::vector<std::uint8_t> red, green, blue;
  std::vector<std::uint32_t> cloud, point;
  std::vector<std::int32_t> part;
  std::size_t at = 0;  // of all records of all clouds
  for (std::size_t c = 0; c < clouds.files.size(); ++c) {
    const auto placed = clouds.files[c].in_world(clouds.carriers[c], clouds.seen[c]);
    for (std::size_t i = 0; i < placed.size(); ++i, ++at) {
      const real d = found.distance[at];
      if (std::isnan(d)) {
        ++made.left_out;
        continue;
      }
      made.beyond += std::isinf(d);
      const io::colour shown = io::distance_colour(d, made.blue_at);
      const auto byte = [](float value) { return std::uint8_t(std::lround(255 * value)); };
      positions.push_back(placed[i]);
      distance.push_back(d);
      red.push_back(byte(shown.red)), green.push_back(byte(shown.green)), blue.push_back(byte(shown.blue));
      cloud.push_back(std::uint32_t(c)), point.push_back(std::uint32_t(i)), part.push_back(std::int32_t(found.part[at]));  // none: -1
    }
  }
  made.points = positions.size();
  char says[200];
  std::snprintf(says, sizeof says, "distance in metres, inf beyond %g m; red at 0 m and inside, blue at %g m and beyond", asked.d_max, made.blue_at);
  const io::ply_column columns[] = {{"red", red}, {"green", green}, {"blue", blue}, {"distance", distance}, {"cloud", cloud}, {"point", point}, {"part", part}};
  io::save_ply(asked.distances, positions, columns, says);
  return made;
}

io::scene_points drawn(const query_options& asked, const observation& cloud, const seen_points& seen, const point_distances* found, std::size_t first) {
  io::scene_points made{.name = cloud.name, .points = {}, .pose = seen.pose};
  std::visit(
      [&](const auto& source) {
        for (std::size_t i = 0; i < source.size(); ++i) {
          const sample s = source[i];
          if (!s.valid()) continue;
          made.points.push_back(s.position);
          if (found) made.colours.push_back(io::distance_colour(found->distance[first + i], blue_at(asked)));
        }
      },
      seen.points);
  return made;
}
