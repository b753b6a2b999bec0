// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A point cloud in memory that keeps the numbering and the precision of its file.

#include <clearance/math.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace clearance::io {

/// The sensor's pose in the cloud's frame as a file states it; nothing is applied, normalised or checked.
struct viewpoint {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// Points in the file's order, one for each of its records; an invalid record stays in its place as NaN.
/// Point i is at `origin + points[i]` metres; the origin is 0 unless the points are far from 0 (see far_origin).
struct cloud {
  std::string name;
  std::vector<vec3> points;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::optional<io::viewpoint> viewpoint;
  std::size_t width = 0;  // an organised cloud has height rows of width points; any other has height 1
  std::size_t height = 1;
};

/// What to subtract so that floats lose no more than the coordinates have: 0 on an axis along which the points lie
/// around 0 or within 16 m of it (a float errs by less than 1 um there), else their median, rounded to a float: then
/// the difference of two floats of similar size is exact. Outliers and (0,0,0), the usual "no return", do not count.
inline Eigen::Vector3d far_origin(const std::vector<Eigen::Vector3d>& points) {
  constexpr double near = 16;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    bool far = false;
    for (const auto& p : points) far = far || std::abs(p[axis]) > near;
    if (!far) continue;
    for (const auto& p : points)
      if (std::isfinite(p.sum()) && !p.isZero(0)) along.push_back(p[axis]);
    if (along.empty()) continue;
    const std::size_t last = along.size() - 1, few = last / 20;
    const auto at = [&](std::size_t rank) {
      std::nth_element(along.begin(), along.begin() + std::ptrdiff_t(rank), along.end());
      return along[rank];
    };
    const double low = at(few), high = at(last - few), middle = float(at(last / 2));
    if (std::isfinite(middle) && std::abs(middle) > near && std::abs(middle) > high - low) origin[axis] = middle;
  }
  return origin;
}

/// A cloud of the given coordinates (metres, double), with an origin subtracted in double where that saves precision.
inline cloud make_cloud(std::string name, const std::vector<Eigen::Vector3d>& coordinates, std::size_t width,
                        std::size_t height) {
  cloud made{.name = std::move(name), .points = {}, .origin = far_origin(coordinates), .viewpoint = {},
             .width = width, .height = height};
  made.points.reserve(coordinates.size());
  for (const auto& p : coordinates) {
    const Eigen::Vector3f relative = (p - made.origin).cast<float>();
    made.points.push_back({relative.x(), relative.y(), relative.z()});
  }
  return made;
}

}  // namespace clearance::io
