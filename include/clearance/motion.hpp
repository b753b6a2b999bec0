// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How a robot moves for a time from 0 to 1, and how far its parts can get in a while.

#include <clearance/frame/frame.hpp>

#include <concepts>

namespace clearance {

/// How far points of a part can move within a time `h` of a moment, before or after it.
struct part_travel {
  double speed = 0;        ///< No point is faster at the moment itself: metres for the whole motion's time.
  double growth = 0;       ///< Nor, a time h away from it, than speed + growth h,
  double most = infinity;  ///< nor ever than this.
  double rounding = 0;     ///< Metres by which the pose of the moment may be off from the motion that is meant.

  /// Metres, rounded up; 0 for a part that stands still, even if it is endlessly large.
  double within(double h) const {
    const double fastest = std::min(most, speed + (growth > 0 ? h * growth : 0));
    return (rounding + (fastest > 0 ? h * fastest : 0)) * (1 + 0x1p-40);
  }
};

/// A robot at one time of its motion: world-from-part, and what that says of the times around it; one a part.
struct moment {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<part_travel> travels;
};

/// Law: no point of a part's solid, which is in the ball of its facts and not more than gap and tolerance out of it, is
/// at any time in
///      0 .. 1 within h of t farther from where the moment t has it than `travels[k].within(h)`.
template <class M>
concept motion = requires(const M m, double t, std::span<const part_facts> parts) {
  { m.at(t, parts) } -> std::same_as<moment>;
};

/// Around all of a part's solid; without a certificate around its primitives.
inline double solid_radius(const part_facts& f) {
  return double(f.radius) + double(f.tolerance) + (f.gap < infinity ? double(f.gap) : 0);
}
inline Eigen::Vector3d center_of(const part_facts& f) { return {f.center.x, f.center.y, f.center.z}; }

/// Every part from one pose to another: its origin along a straight line at constant speed, its orientation about an
/// axis that is fixed in the part, by at most half a turn, at constant angular velocity.
class straight_motion {
 public:
  /// World-from-part. Throws std::invalid_argument if there are not as many of both, or one is not rigid.
  straight_motion(std::span<const Eigen::Isometry3d> from, std::span<const Eigen::Isometry3d> to) {
    if (from.size() != to.size())
      throw std::invalid_argument("clearance: a motion begins with " + std::to_string(from.size()) +
                                  " poses and ends with " + std::to_string(to.size()));
    for (std::size_t k = 0; k < from.size(); ++k) {
      const Eigen::Isometry3d a = rigid(from[k], "part", std::int64_t(k)), b = rigid(to[k], "part", std::int64_t(k));
      ways_.push_back({a, b.translation() - a.translation(),
                       Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear()))});
    }
  }

  /// Throws std::invalid_argument if there are not as many parts.
  moment at(double t, std::span<const part_facts> parts) const {
    if (parts.size() != ways_.size())
      throw std::invalid_argument("clearance: there are " + std::to_string(parts.size()) + " parts, but a motion of " +
                                  std::to_string(ways_.size()));
    moment now;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const way& w = ways_[k];
      Eigen::Isometry3d pose = w.from;
      pose.translation() += t * w.shift;
      pose.linear() = w.from.linear() * Eigen::AngleAxisd(t * w.turn.angle(), w.turn.axis()).toRotationMatrix();
      now.poses.push_back(pose);
      const Eigen::Vector3d center = center_of(parts[k]);
      const double radius = solid_radius(parts[k]), angle = w.turn.angle();
      part_travel travel;
      travel.most = travel.speed =
          w.shift.norm() + (angle > 0 ? angle * (center.cross(w.turn.axis()).norm() + radius) : 0);
      // More than the roundings of a dozen products and of sine and cosine.
      const double size = w.from.translation().norm() + w.shift.norm() + (angle > 0 ? center.norm() + radius : 0);
      travel.rounding = frames::pose_error * size;
      now.travels.push_back(travel);
    }
    return now;
  }

 private:
  struct way {
    Eigen::Isometry3d from;
    Eigen::Vector3d shift;
    Eigen::AngleAxisd turn;
  };
  std::vector<way> ways_;
};
static_assert(motion<straight_motion>);

/// A motion of one's own: `poses(t)`, world-from-part, and for each part how fast any of its points ever is, in metres
/// for the time from 0 to 1. That these are high enough is the caller's promise.
template <class Poses>
  requires std::convertible_to<std::invoke_result_t<const Poses&, double>, std::vector<Eigen::Isometry3d>>
struct timed_motion {
  Poses poses;
  std::vector<double> speeds;

  moment at(double t, std::span<const part_facts>) const {
    moment now{poses(t), {}};
    for (const double speed : speeds) now.travels.push_back({speed, 0, speed, 0});
    return now;
  }
};
template <class Poses>
timed_motion(Poses, std::vector<double>) -> timed_motion<Poses>;

}  // namespace clearance
