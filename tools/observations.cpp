// SPDX-License-Identifier: BSD-3-Clause
#include "observations.hpp"

#include "command_line.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/kinematics.hpp>
#include <clearance/io/png.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>

using namespace clearance;

namespace {

/// Refuses a file if what is made of its points is too large for its size.
void check_made(const cloud_options& from, std::uint64_t points, std::uint64_t each, const std::string& what) {
  constexpr std::uint64_t times = 64;  // the file's size; unpacked files stay far below
  std::error_code none;
  const auto size = std::filesystem::file_size(from.file, none);
  const std::uint64_t made = points * (from.bytes_each + each),
                      most = std::max(from.limits.unfolded, none ? 0 : times * size);
  if (made > most)
    io::refuse(from.file, "has " + std::to_string(points) + ' ' + what + ", of which " + io::mebibytes(made) +
                              " would be made here, more than the limit of " + io::mebibytes(most) +
                              " (--unfold-limit MiB raises it)");
}

}  // namespace

std::uint64_t observation::size() const { return image() ? image()->pixels.size() : points()->points.size(); }

observation observe(const cloud_options& from, std::set<std::string>& taken) {
  observation made;
  made.from = from;
  made.name = from.file;
  for (int k = 2; !taken.insert(made.name).second; ++k) made.name = from.file + " (" + std::to_string(k) + ')';
  if (from.is_image()) {
    made.data = io::load_png(from.file, from.limits);
    check_made(from, made.size(), sizeof(std::uint16_t), "pixels");
    return made;
  }

  io::cloud cloud = io::load_cloud(from.file, from.limits);
  check_made(from, cloud.points.size(), sizeof(Eigen::Vector3d) + sizeof(vec3), "points");
  if (from.cloud_scale != 1) {
    for (Eigen::Vector3d& p : cloud.points) p *= from.cloud_scale;
    if (cloud.viewpoint) cloud.viewpoint->translation *= from.cloud_scale;
  }

  std::uint64_t zeros = 0;
  for (Eigen::Vector3d& p : cloud.points) {
    if (!p.isZero(0)) continue;
    ++zeros;
    if (from.zero_is_missing) p.x() = not_a_number;
  }
  if (from.zero_is_missing) made.zeros = zeros;
  if (!from.zero_is_missing && 100 * zeros > cloud.points.size())
    made.notes.push_back(from.file + ": " + std::to_string(zeros) + " of " + std::to_string(cloud.points.size()) +
                         " points are (0,0,0) and count as points; --zero-is-missing drops them");

  if (from.use_viewpoint && !cloud.viewpoint) throw usage_error("--use-viewpoint", from.file + " has no VIEWPOINT");
  if (cloud.viewpoint && !from.use_viewpoint) {
    const auto& [t, q] = *cloud.viewpoint;
    if (t != Eigen::Vector3d::Zero() || q.coeffs() != Eigen::Quaterniond::Identity().coeffs()) {
      char says[256];
      std::snprintf(says, sizeof says,
                    ": VIEWPOINT x,y,z,qx,qy,qz,qw %g,%g,%g,%g,%g,%g,%g is not applied; --use-viewpoint does so", t.x(),
                    t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
      made.notes.push_back(from.file + says);
    }
  }

  made.data = std::move(cloud);
  return made;
}

Eigen::Isometry3d observation::world(const Eigen::Isometry3d& carrier) const {
  const Eigen::Isometry3d camera = io::carried(carrier, from.pose, "the camera");
  if (!from.use_viewpoint || !points()) return camera;
  return io::carried(
      camera, pose("--use-viewpoint: " + from.file, points()->viewpoint->translation, points()->viewpoint->rotation),
      "the viewpoint");
}

seen_points observation::seen(const Eigen::Isometry3d& carrier, poses_of robot) {
  const Eigen::Isometry3d placed = world(carrier);
  if (const auto* frame = image()) {
    depth_image<std::uint16_t> source(frame->pixels.data(), std::uint32_t(frame->width), std::uint32_t(frame->height),
                                      *from.camera, from.scale);
    source.nearest = real(from.nearest);
    source.farthest = real(from.farthest);
    return {source, placed, from.sensor, from.off, from.later};
  }
  floats_ = points()->near(robot, placed);
  auto [source, pose] = floats_.view();
  source.filter.nearest = real(from.nearest);
  source.filter.farthest = real(from.farthest);
  return {source, pose, from.sensor, from.off, from.later};
}

std::vector<Eigen::Vector3d> observation::in_world(const Eigen::Isometry3d& carrier, const seen_points& seen,
                                                   std::size_t begin, std::size_t end) const {
  std::vector<Eigen::Vector3d> at;
  if (points()) {  // in the file's doubles
    const Eigen::Isometry3d placed = world(carrier);
    for (std::size_t i = begin; i < end; ++i) at.push_back(placed * points()->points[i]);
    return at;
  }
  const auto& source = std::get<depth_image<std::uint16_t>>(seen.points);
  for (std::size_t i = begin; i < end; ++i) {
    const vec3 p = source[i].position;
    at.push_back(seen.pose * Eigen::Vector3d(p.x, p.y, p.z));
  }
  return at;
}

std::vector<vec3> observation::hide(std::span<const point_label> labels, const seen_points& seen) {
  std::vector<vec3> where;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != point_label::own) continue;
    where.push_back(std::visit([&](const auto& source) { return source[i].position; }, seen.points));
    if (auto* frame = std::get_if<io::depth_frame>(&data))
      frame->pixels[i] = 0;
    else
      floats_.points[i].x = not_a_number;
  }
  hidden_ = where.size();
  return where;
}

void observation::recount(min_distance_result& r) const {
  r.dropped[int(image() ? drop_reason::missing : drop_reason::not_finite)] -= hidden_;
  r.dropped[int(drop_reason::masked)] += hidden_;
  r.dropped[int(drop_reason::not_finite)] -= zeros;
  r.dropped[int(drop_reason::missing)] += zeros;
}

void observation::forget_points() {
  floats_.points = {};
  if (auto* cloud = std::get_if<io::cloud>(&data)) cloud->points = {};
  if (auto* frame = std::get_if<io::depth_frame>(&data)) frame->pixels = {};
}
