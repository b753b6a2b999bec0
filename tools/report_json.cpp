// SPDX-License-Identifier: BSD-3-Clause
#include "report_json.hpp"

#include <cmath>

using namespace clearance;

std::optional<std::pair<std::uint64_t, std::uint64_t>> pixel(const observation& cloud, std::uint32_t point) {
  if (!cloud.image()) return std::nullopt;
  return std::pair{point % cloud.image()->width, point / cloud.image()->width};
}

double microseconds(double seconds) { return std::round(1e9 * seconds) / 1e3; }

json witness(const min_distance_result& r, const observation* cloud, std::uint32_t point,
             const std::vector<body>& bodies) {
  const bool any = r.state != state::no_data,
             near = cloud != nullptr;  // beyond a d_max there is a bracket, but no witness
  const auto given = [](bool there, json value) { return there ? value : json(nullptr); };
  const auto xyz = [](const position& p) { return json{p.x, p.y, p.z}; };
  json out;
  out["state"] = to_string(r.state);
  out["distance"] = given(any, or_null(r.distance));
  out["lower"] = given(any, or_null(r.lower));
  out["upper"] = given(any, or_null(r.upper));
  out["cloud"] = near ? json(cloud->name) : json(nullptr);
  out["point"] = given(near, point);
  out["pixel"] = nullptr;
  if (near)
    if (const auto at = pixel(*cloud, point)) out["pixel"] = {at->first, at->second};
  out["point_xyz"] = given(near, xyz(r.at));
  out["part"] = near ? json(bodies[r.part].name) : json(nullptr);
  out["primitive"] = given(near && r.primitive != none, r.primitive);
  out["nearest_xyz"] = given(near, xyz(r.nearest));
  const bool direction = near && !(r.normal == vec3{0, 0, 0});
  out["normal"] = direction ? json({r.normal.x, r.normal.y, r.normal.z}) : json(nullptr);
  return out;
}

json counts(const min_distance_result& r) {
  json dropped = json::object();
  for (int k = 1; k < drop_reasons; ++k) dropped[reasons[k]] = r.dropped[k];
  return {{"seen", r.seen}, {"valid", r.valid}, {"dropped", dropped}};
}

json pose_of(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

json about_cloud(const observation& cloud) {
  json one = {{"file", cloud.from.file},
              {"name", cloud.name},
              {"points", cloud.size()},
              {"pose", pose_of(cloud.from.pose)},
              {"link", cloud.from.link.empty() ? json(nullptr) : json(cloud.from.link)},
              {"viewpoint", nullptr}};
  if (cloud.points() && cloud.points()->viewpoint) {
    const auto& [t, q] = *cloud.points()->viewpoint;
    one["viewpoint"] = {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  }
  return one;
}
