// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How a robot moves over a time from 0 to 1, and how far its parts can move in a part of that time.

#include <clearance/frames/frame.hpp>

#include <concepts>

namespace clearance {

/// How far points of a part can move within a time `h` of a moment, before or after it.
struct part_travel {
  double speed = 0;        ///< No point is faster at that moment, in metres per the motion's whole time.
  double growth = 0;       ///< A time h away no point is faster than speed + growth h.
  double most = infinity;  ///< No point is ever faster than this.
  double rounding = 0;     ///< Metres by which the pose of that moment may differ from the intended motion.

  /// Metres, rounded up; 0 for a part that stands still, even if it is infinitely large.
  double within(double h) const {
    const double fastest = std::min(most, speed + (growth > 0 ? h * growth : 0));
    return (rounding + (fastest > 0 ? h * fastest : 0)) * (1 + 0x1p-40);
  }
};

/// A robot at one time of its motion: world-from-part, and how far each part moves around that time; one per part.
struct moment {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<part_travel> travels;
};

/// Law: at no time in 0 .. 1 within h of t is a point of a part's solid farther than `travels[k].within(h)` from where
/// the moment t has it. The solid is in the ball of the part's facts, or at most gap and tolerance outside it.
template <class M>
concept motion = requires(const M m, double t, std::span<const part_facts> parts) {
  { m.at(t, parts) } -> std::same_as<moment>;
};

/// A ball around a part's solid; without a certificate, around its primitives.
inline double solid_radius(const part_facts& f) {
  return double(f.radius) + double(f.tolerance) + (f.gap < infinity ? double(f.gap) : 0);
}
inline Eigen::Vector3d center_of(const part_facts& f) { return {f.center.x, f.center.y, f.center.z}; }

/// Moves every part from one pose to another: its origin along a straight line at constant speed, its orientation about
/// an axis that is fixed in the part, by at most half a turn, at constant angular velocity.
class straight_motion {
 public:
  /// World-from-part. Throws std::invalid_argument if the numbers of both differ, or a pose is not rigid.
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

  /// Throws std::invalid_argument if the number of parts is another.
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

/// A motion of your own: `poses(t)`, world-from-part, and for each part the highest speed of any of its points, in
/// metres per the time from 0 to 1. You promise that the speeds are high enough.
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
