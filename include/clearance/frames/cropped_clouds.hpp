// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where obstacles are: clouds of any kind without what lies elsewhere, in world coordinates.

#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/points/cropped.hpp>
#include <clearance/points/uncertain.hpp>

#include <stdexcept>
#include <string>

namespace clearance {

/// Where a point is an obstacle: a few boxes in world coordinates, all of which must keep it. Metres. What cannot be a
/// box, and more than `crop_boxes::most`, throw std::invalid_argument.
class crop {
 public:
  /// Obstacles are in the box from `lower` to `upper`, faces included; infinite where it has no end.
  crop& inside(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper,
               const Eigen::Isometry3d& world_from_box = Eigen::Isometry3d::Identity()) {
    return add({lower, upper, rigid(world_from_box, "a crop's box").inverse(), true});
  }
  /// Nothing in the box is an obstacle: what a robot may touch, or what is known otherwise.
  crop& outside(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper,
                const Eigen::Isometry3d& world_from_box = Eigen::Isometry3d::Identity()) {
    return add({lower, upper, rigid(world_from_box, "a crop's box").inverse(), false});
  }
  /// Obstacles are from `low` to `high` along the world's z.
  crop& height(double low, double high) {
    const double far = double(infinity);
    return inside({-far, -far, low}, {far, far, high});
  }
  /// Nothing within `thickness` of the plane {p: normal . p = offset} is an obstacle: a table, a floor, a wall.
  /// `normal` need not be a unit vector; `offset` is in its units.
  crop& without_plane(const Eigen::Vector3d& normal, double offset, double thickness) {
    const double size = normal.norm(), far = double(infinity);
    if (!(size > 0 && size < far) || !(std::abs(offset / size) < far) || !(thickness >= 0 && thickness < far))
      throw std::invalid_argument(
          "clearance: a crop's plane needs a normal that is not 0, and an offset and a thickness (0 or more) that are "
          "finite");
    // The box's z is the normal; its x, any way across.
    const Eigen::Vector3d n = normal / size, least = n.cwiseAbs();
    const int axis = least.x() <= least.y() && least.x() <= least.z() ? 0 : least.y() <= least.z() ? 1 : 2;
    const Eigen::Vector3d x = n.cross(Eigen::Vector3d(axis == 0, axis == 1, axis == 2)).normalized(), y = n.cross(x);
    Eigen::Isometry3d box_from_world = Eigen::Isometry3d::Identity();
    for (int k = 0; k < 3; ++k) {
      box_from_world(0, k) = x[k];
      box_from_world(1, k) = y[k];
      box_from_world(2, k) = n[k];
    }
    const double at = offset / size;
    return add({{-far, -far, at - thickness}, {far, far, at + thickness}, box_from_world, false});
  }

  bool empty() const { return boxes_.empty(); }
  /// The boxes as a cloud at this pose sees them.
  crop_boxes seen_from(const Eigen::Isometry3d& world_from_cloud) const {
    const auto floats = [](const Eigen::Vector3d& v) { return vec3{real(v.x()), real(v.y()), real(v.z())}; };
    crop_boxes made;
    for (const box_in_world& b : boxes_)
      made.box[made.count++] = {.box_from_cloud = to_floats(b.box_from_world * world_from_cloud),
                                .lower = floats(b.lower),
                                .upper = floats(b.upper),
                                .inside = b.inside};
    return made;
  }

 private:
  struct box_in_world {
    Eigen::Vector3d lower, upper;
    Eigen::Isometry3d box_from_world;
    bool inside;
  };

  crop& add(const box_in_world& b) {
    if (!(b.lower.array() <= b.upper.array()).all())
      throw std::invalid_argument("clearance: a crop's box has a lower end that is not below the upper one");
    if (boxes_.size() == crop_boxes::most)
      throw std::invalid_argument("clearance: a crop has more than " + std::to_string(crop_boxes::most) + " boxes");
    boxes_.push_back(b);
    return *this;
  }

  std::vector<box_in_world> boxes_;
};

namespace detail {

struct by_crop {
  const crop* asked;

  template <point_source S>
  cropped<S> operator()(const S& source, const Eigen::Isometry3d& world_from_cloud) const {
    return cropped<S>(source, asked->seen_from(world_from_cloud));
  }
  template <point_source S, sensor_noise N>
  auto operator()(const uncertain<S, N>& source, const Eigen::Isometry3d& world_from_cloud) const {
    return source.around_same((*this)(source.source, world_from_cloud), source.noise);
  }
};

}  // namespace detail

/// Clouds (any that a call takes) without the points that are no obstacles by `where`: they are dropped as `cropped`. A
/// cloud that is not `placed` has the world's coordinates. Views: clouds must outlive them.
template <class Clouds>
auto cropped_clouds(const Clouds& clouds, const crop& where) {
  return mapped_clouds(clouds, detail::by_crop{&where});
}
template <detail::owning_clouds Clouds>
void cropped_clouds(const Clouds&&, const crop&) = delete;  // the points would be gone; give them a name

}  // namespace clearance
