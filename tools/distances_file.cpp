// SPDX-License-Identifier: BSD-3-Clause
#include "distances_file.hpp"

#include <clearance/io/ply_writer.hpp>
#include <clearance/io/scene.hpp>

#include <cmath>
#include <cstdio>

using namespace clearance;

namespace {

double blue_at(const query_options& asked) { return std::isfinite(asked.d_max) ? asked.d_max : 1; }

}  // namespace

namespace {

/// The valid points of all clouds, in pieces that fit into memory.
class distance_pieces {
 public:
  distance_pieces(const asked_clouds& clouds, const point_distances& found, double blue)
      : clouds_(clouds), found_(found), blue_(blue) {}

  io::ply_piece operator()() {
    std::vector<Eigen::Vector3d> positions;
    std::vector<float> distance;
    std::vector<std::uint8_t> red, green, blue;
    std::vector<std::uint32_t> cloud, point;
    std::vector<std::int32_t> part;

    while (positions.empty() && cloud_ < clouds_.files.size()) {
      const std::size_t end = std::min<std::size_t>(clouds_.files[cloud_].size(), begin_ + most);
      const auto placed = clouds_.files[cloud_].in_world(clouds_.carriers[cloud_], clouds_.seen[cloud_], begin_, end);
      for (std::size_t i = begin_; i < end; ++i) {
        const real d = found_.distance[first_ + i];
        if (std::isnan(d)) continue;
        const io::colour shown = io::distance_colour(d, blue_);
        const auto byte = [](float value) { return std::uint8_t(std::lround(255 * value)); };
        positions.push_back(placed[i - begin_]);
        distance.push_back(d);
        red.push_back(byte(shown.red));
        green.push_back(byte(shown.green));
        blue.push_back(byte(shown.blue));
        cloud.push_back(std::uint32_t(cloud_));
        point.push_back(std::uint32_t(i));
        part.push_back(std::int32_t(found_.part[first_ + i]));  // none: -1
      }

      begin_ = end;
      if (end == clouds_.files[cloud_].size()) {
        begin_ = 0;
        first_ += end;
        ++cloud_;
      }
    }

    return {std::move(positions),
            {{"red", std::move(red)},
             {"green", std::move(green)},
             {"blue", std::move(blue)},
             {"distance", std::move(distance)},
             {"cloud", std::move(cloud)},
             {"point", std::move(point)},
             {"part", std::move(part)}}};
  }

 private:
  static constexpr std::size_t most = 1 << 18;

  const asked_clouds& clouds_;
  const point_distances& found_;
  double blue_;
  std::size_t cloud_ = 0, begin_ = 0,
              first_ = 0;  // next record of a cloud; the cloud's first among all
};

}  // namespace

distances_written write_distances(const query_options& asked, const asked_clouds& clouds,
                                  const point_distances& found) {
  distances_written made{.blue_at = blue_at(asked)};
  for (const real d : found.distance) {
    ++(std::isnan(d) ? made.left_out : made.points);
    made.beyond += std::isinf(d);
  }
  char says[200];
  std::snprintf(says, sizeof says,
                "distance in metres, inf beyond %g m; red at 0 m and inside, blue at %g m and beyond", asked.d_max,
                made.blue_at);
  io::save_ply_pieces(asked.distances, made.points, distance_pieces(clouds, found, made.blue_at), says);
  return made;
}

io::scene_points drawn(const query_options& asked, const observation& cloud, const seen_points& seen,
                       const point_distances* found, std::size_t first) {
  io::scene_points made{.name = cloud.name, .points = {}, .pose = seen.pose};
  std::visit(
      [&](const auto& source) {
        const cropped obstacles(source, seen.boxes);
        for (std::size_t i = 0; i < source.size(); ++i) {
          const sample s = obstacles[i];
          if (!s.valid()) continue;
          made.points.push_back(s.position);
          if (found) made.colours.push_back(io::distance_colour(found->distance[first + i], blue_at(asked)));
        }
      },
      seen.points);
  return made;
}

std::vector<vec3> cropped_points(const seen_points& seen) {
  std::vector<vec3> made;
  std::visit(
      [&](const auto& source) {
        const cropped obstacles(source, seen.boxes);
        for (std::size_t i = 0; seen.boxes.count != 0 && i < source.size(); ++i)
          if (const sample s = obstacles[i]; s.dropped == drop_reason::cropped) made.push_back(s.position);
      },
      seen.points);
  return made;
}
