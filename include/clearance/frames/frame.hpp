// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds with their poses, parts placed in a cloud's frame, and what is certain about rounding.

#include <clearance/ground/pose.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/robot/part.hpp>

namespace clearance::frames {

/// A part as seen from a cloud.
struct placement {
  rigid_transform part_from_cloud;  ///< The exact path: one fixed sequence of operations.
  ball around;  ///< The part's ball in the cloud's frame, its radius enlarged by arithmetic's errors.
  real error;   ///< The largest error of a distance to this part, at distance 0.
  world_transform world_from_part;
};

/// Float arithmetic is wrong by at most 16 units of rounding (2^-24) of |p| + |t| + part size, where p is less the
/// origin. Of |p|: that subtraction one, the rotation's own floats 1.8, the sums of products two; of |t|: three; of the
/// point in the part's frame: one, and a leaf formula five. That is 11; the other five may be the source's own.
inline constexpr double unit_error = 0x1p-20, source_share = 5 * 0x1p-24;
/// Added to that, because squares of lengths below 1e-19 m lose digits, and squares of lengths below 2e-23 m are 0.
inline constexpr double underflow_error = 0x1p-72;
/// Poses are composed in double, from rotations orthonormal to 1e-14. With R' as the inverse of R a way is wrong by
/// 1.5e-14 of itself, the way from the origin twice, and ten roundings of 2^-53 add 2e-15. The sum is below this share
/// of all ways.
inline constexpr double pose_error = 0x1p-44;

/// The largest error of a distance, by the distance itself, in metres.
struct float_error {
  double here = 0;                ///< At distance 0, the largest over all parts.
  double per_metre = unit_error;  ///< Added for each metre.
  double gap = 0;                 ///< By how much more the clouds may be nearer, and not farther.

  CLEARANCE_HD double at(real distance) const { return fma(per_metre, double(absolute(distance)), here); }
  CLEARANCE_HD void widen(const float_error& other) {
    here = other.here > here ? other.here : here;
    per_metre = other.per_metre > per_metre ? other.per_metre : per_metre;
    gap = other.gap > gap ? other.gap : gap;
  }
};

/// The error of float arithmetic near a part whose size and distance from the origin sum up to `extent`.
CLEARANCE_HD inline double arithmetic_error(double extent) { return fma(unit_error * 2, extent, underflow_error); }

/// The whole error of a distance to that part. `poses` is the sum of all ways between frames, `origin` the way from the
/// source's own zero to the origin. A point's position is at most extent + distance + origin long, and wrong by
/// `relative` of that. unit_error, which counts the extent twice, includes `source_share` of the first two. The error
/// is infinite if `relative` is 0.25 or more, or if an error, the gap or the extent is negative or NaN.
CLEARANCE_HD inline float_error error_near(double extent, double poses, double origin, const position_error& off) {
  if (!(off.absolute >= 0 && off.relative >= 0 && off.relative < 0.25 && off.gap >= 0 && extent >= 0))
    return {double(infinity), unit_error};
  const double at_zero = arithmetic_error(extent) + fma(pose_error, poses, fma(off.relative, origin, off.absolute));
  if (off.relative <= source_share) return {at_zero, unit_error, off.gap};
  const double more = off.relative - source_share;
  return {fma(more, extent, at_zero) / (1 - more), (unit_error + more) / (1 - more),
          off.gap};  // the error depends on the true distance; this is by the computed one
}

/// The origin that is subtracted from a cloud's coordinates: near the robot, in steps of 64 m. So ordinary scenes lose
/// nothing, and clouds in world coordinates of 1e6 m lose no more than their own coordinates have lost.
CLEARANCE_HD inline vec3 origin_near(position robot_in_cloud) {
  const auto step = [](double x) { return real(round(x / 64) * 64); };
  return {step(robot_in_cloud.x), step(robot_in_cloud.y), step(robot_in_cloud.z)};
}

/// The mean of the parts' origins, in the cloud's frame; `world_from_part(k)` is part k's pose.
CLEARANCE_CALLS_ANYTHING
template <class Pose>
CLEARANCE_HD position middle_of(const world_transform& world_from_cloud, const Pose& world_from_part,
                                std::size_t parts) {
  position sum{0, 0, 0};
  for (std::size_t k = 0; k < parts; ++k) {
    const position at = world_from_part(std::uint32_t(k)).translation();
    sum = {sum.x + at.x, sum.y + at.y, sum.z + at.z};
  }
  return world_from_cloud.inverse()(position{sum.x / double(parts), sum.y / double(parts), sum.z / double(parts)});
}

CLEARANCE_HD inline double norm(position p) { return sqrt(fma(p.x, p.x, fma(p.y, p.y, p.z * p.z))); }

/// Places a part in a cloud. `part_from_cloud` maps positions less `origin`. Both transforms have passed make_rigid.
CLEARANCE_HD inline placement place(const part_facts& facts, const world_transform& world_from_part,
                                    const world_transform& world_from_cloud, vec3 origin, const position_error& off) {
  const world_transform part_from_world = world_from_part.inverse();
  world_transform part_from_cloud = part_from_world * world_from_cloud;
  const position start = part_from_world(world_from_cloud(origin));
  part_from_cloud.m[0][3] = start.x;
  part_from_cloud.m[1][3] = start.y;
  part_from_cloud.m[2][3] = start.z;
  const position center = part_from_cloud.inverse()(facts.center);
  const double radius = facts.radius >= 0 ? facts.radius : infinity;
  const double extent = norm({facts.center.x, facts.center.y, facts.center.z}) + radius + norm(start);
  const double origin_away = norm({origin.x, origin.y, origin.z});
  const double poses = norm(world_from_part.translation()) + norm(world_from_cloud.translation()) + origin_away;
  placement p;
  p.part_from_cloud = to_floats(part_from_cloud);
  // Only the errors of arithmetic on the points as read: bounds concern computed distances.
  p.around = {{real(center.x), real(center.y), real(center.z)}, rounded_up(radius + 2 * arithmetic_error(extent))};
  p.error = rounded_up(error_near(extent, poses, origin_away, off).here);
  p.world_from_part = world_from_part;
  return p;
}

/// By how much a part's solid may be nearer than its computed distance. Infinite if either fact is negative or NaN.
CLEARANCE_HD inline double slop(const part_facts& f) {
  return f.gap >= 0 && f.tolerance >= 0 ? double(f.gap) + double(f.tolerance) : double(infinity);
}

/// What all parts of a frame have in common.
struct frame_facts {
  world_transform world_from_cloud;
  vec3 origin = {0, 0, 0};
  float_error error;
  double slop = 0;  ///< The largest gap plus tolerance of all parts.

  frame_facts() = default;
  CLEARANCE_HD frame_facts(const world_transform& cloud, vec3 origin, const position_error& off)
      : world_from_cloud(cloud), origin(origin), error{0, error_near(0, 0, 0, off).per_metre, off.gap} {}

  CLEARANCE_HD void add(const part_facts& facts, real error_of_part) {
    const double slop_of_part = frames::slop(facts);
    error.widen({error_of_part});
    slop = slop_of_part > slop ? slop_of_part : slop;
  }
};

/// All parts as seen from one cloud, made on the host for every frame. If it is kept, it allocates only once.
class cloud_frame : public frame_facts {
 public:
  std::vector<placement> places;
  std::vector<world_transform> poses;

  cloud_frame() = default;
  cloud_frame(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts,
              const Eigen::Isometry3d& cloud, const position_error& off = {}) {
    start(facts, parts);
    put(facts, cloud, 0, off);
  }

  /// Begins a frame with poses world-from-part. Throws std::invalid_argument if their number is wrong or one is not
  /// rigid.
  void start(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> parts) {
    if (parts.size() != facts.size())
      throw std::invalid_argument("clearance: there are " + std::to_string(facts.size()) + " parts, but " +
                                  std::to_string(parts.size()) + " poses");
    with_vectors([&] {
      error = {};
      slop = 0;
      poses.clear();
      for (std::size_t k = 0; k < parts.size(); ++k)
        poses.push_back(rigid_transform_of(parts[k], "part", std::int64_t(k)));
    });
  }

  /// The next cloud, number `cloud`, whose errors widen the frame's; `off` is its source's `rounding_of`. Throws
  /// std::invalid_argument if its pose is not rigid.
  void put(std::span<const part_facts> facts, const Eigen::Isometry3d& pose, std::uint32_t cloud,
           const position_error& off) {
    with_vectors([&] {
      const world_transform world = rigid_transform_of(pose, "cloud", cloud);
      places.clear();
      const float_error before = error;  // a bracket covers all clouds
      frame_facts::operator=(
          {world,
           origin_near(middle_of(
               world, [this](std::uint32_t k) -> const world_transform& { return poses[k]; }, poses.size())),
           off});
      for (std::size_t k = 0; k < poses.size(); ++k) {
        places.push_back(place(facts[k], poses[k], world, origin, off));
        add(facts[k], places.back().error);
      }
      error.widen(before);
    });
  }
};

}  // namespace clearance::frames
