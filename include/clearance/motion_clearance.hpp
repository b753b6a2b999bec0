// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How close does a robot come to the points while it moves?

#include <clearance/frames/margins.hpp>
#include <clearance/motion.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/robot/widened.hpp>

#include <queue>

namespace clearance {

struct motion_clearance_options {
  double tolerance = 0.01;  ///< Metres: how far `lower` may be below the least certain distance at an asked time.
                            ///< Infinite: only the state has to be decided.
  double margin = 0;        ///< Metres: `state` compares with it.
  std::size_t most_queries = 1000;  ///< After so many questions the rest stays open, on the safe side.
  std::vector<double> radii = {};   ///< By how much parts may be elsewhere, in metres: all alike, or each.
};

/// The clearance over a motion. `lower` also covers the times between those that were asked. Times go from 0 to 1.
struct motion_clearance_result {
  /// free: lower > margin. collision: at `time` some point is certainly not farther than margin. possible: neither.
  /// no_data: no valid point. Of `uncertain` clouds `lower` is about all places where points may be, and `upper` is not
  /// known (infinite).
  clearance::state state = clearance::state::no_data;
  real lower = 0;               ///< Metres: at no time is a point nearer. 0 if that is not certain.
  real upper = infinity;        ///< Metres: at `time` some point certainly is this near.
  double time = not_a_number;   ///< The asked time with the least `upper`.
  min_distance_result nearest;  ///< The least distance at `time`.
  double from = 0, to = 1;      ///< The times between which the bound is lowest, which keep `lower` down.
  std::uint32_t part = none;    ///< The part that keeps `lower` down.
  std::size_t queries = 0;      ///< How many times were asked.
  bool settled = false;  ///< `lower` is as good as `tolerance` asks, or as it can be. False: the queries were used up.
};

namespace detail {

/// An asked time: what is certain of each part, and how it moves around that time.
struct asked_time {
  double time;
  std::vector<double> lower;
  std::vector<part_travel> travels;
};

/// All times within `half` of an asked one.
struct motion_piece {
  double lower;
  std::uint32_t part;
  double time, half;
  std::size_t asked;

  /// Which of two pieces to look at later.
  friend bool operator<(const motion_piece& a, const motion_piece& b) {
    return a.lower != b.lower ? a.lower > b.lower : a.time > b.time;
  }
};

/// Pieces overlap by more than the rounding of their ends.
inline constexpr double time_error = 0x1p-46;

inline motion_piece piece_around(const asked_time& a, std::size_t number, double half) {
  motion_piece piece{infinity, none, a.time, half, number};
  for (std::uint32_t k = 0; k < a.lower.size(); ++k) {
    const double lower = a.lower[k] * (1 - 0x1p-50) - a.travels[k].within(half + time_error);
    if (piece.part == none || lower < piece.lower) {
      piece.lower = lower;
      piece.part = k;
    }
  }
  piece.lower = piece.lower > 0 ? piece.lower : 0;
  return piece;
}

inline void check(const motion_clearance_options& o) {
  if (!(o.tolerance >= 0))
    throw std::invalid_argument("clearance: a motion's tolerance is " + std::to_string(o.tolerance) +
                                " m; it must not be negative");
  if (!(o.margin >= 0 && o.margin < infinity))
    throw std::invalid_argument("clearance: a motion's margin is " + std::to_string(o.margin) +
                                " m; it must be finite and not negative");
  if (o.most_queries == 0) throw std::invalid_argument("clearance: a motion cannot be judged by 0 queries");
}

inline void check(const moment& m, std::size_t parts) {
  if (m.travels.size() != parts)
    throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but a motion says how " +
                                std::to_string(m.travels.size()) + " move");
  for (std::size_t k = 0; k < parts; ++k) {
    const part_travel& t = m.travels[k];
    if (!(t.speed >= 0 && t.growth >= 0 && t.most >= 0 && t.rounding >= 0))
      throw std::invalid_argument("clearance: a motion's bound for part " + std::to_string(k) +
                                  " is negative or not a number");
  }
}

/// `ask(poses)` is min_distance_per_part.
template <class Ask, motion Motion, class Clouds>
motion_clearance_result over_motion(const Ask& ask, std::span<const part_facts> facts, const Motion& motion,
                                    const Clouds& clouds, const motion_clearance_options& options) {
  check(options);
  check_radii(options.radii, facts.size());
  const bool vague = any_vague(clouds);
  motion_clearance_result result;
  std::vector<asked_time> asked;
  frames::frame_ahead ahead;
  double certain = infinity;  // at the times that were asked
  const auto ask_at = [&](double time) {
    moment now = motion.at(time, facts);
    check(now, facts.size());
    const min_distance_per_part_result& found = ask(now.poses);
    const min_distance_result& r = found.all;
    const double radius = r.part == none ? 0 : radius_of(options.radii, r.part);
    const real upper = radius == 0 ? r.upper : rounded_up(double(r.upper) + radius);
    if (++result.queries == 1 || upper < result.upper || (upper == result.upper && time < result.time)) {
      result.upper = upper;
      result.time = time;
      result.nearest = r;
    }
    if (r.part == none) return false;
    const frames::float_error error = ahead.facts_of(facts, now.poses, clouds).error;
    asked_time a{time, {}, std::move(now.travels)};
    for (std::size_t k = 0; k < facts.size(); ++k) {
      const part_facts wide = widened(facts[k], radius_of(options.radii, k));
      const double sure = frames::certain_distance(found.parts[k].distance, frames::slop(wide), error);
      a.lower.push_back(sure > 0 ? sure : 0);
    }
    certain = std::min(certain, piece_around(a, 0, 0).lower);
    asked.push_back(std::move(a));
    return true;
  };
  std::priority_queue<motion_piece> pieces;
  if (!ask_at(0.5)) return result;
  for (motion_piece worst = piece_around(asked[0], 0, 0.5);; worst = pieces.top(), pieces.pop()) {
    result.lower = rounded_down(worst.lower);
    result.part = worst.part;
    result.from = std::max(0.0, worst.time - worst.half);
    result.to = std::min(1.0, worst.time + worst.half);
    const bool decided = result.lower > options.margin || !(certain > options.margin);
    result.settled = certain - worst.lower <= options.tolerance && (options.tolerance < infinity || decided);
    if (result.settled || result.queries + 2 > options.most_queries) break;
    const double third = worst.half / 3;
    const auto put = [&](std::size_t number) {
      motion_piece piece = piece_around(asked[number], number, third);
      if (piece.lower < worst.lower) {  // what is known of the whole holds for a piece
        piece.lower = worst.lower;
        piece.part = worst.part;
      }
      pieces.push(piece);
    };
    put(worst.asked);  // a third of it has the same middle, so that two questions make three pieces
    for (const double time : {worst.time - 2 * third, worst.time + 2 * third}) {
      if (!ask_at(time)) {
        result.lower = 0;
        result.state = state::no_data;
        return result;
      }
      put(asked.size() - 1);
    }
  }
  if (result.nearest.dropped[int(drop_reason::too_close)] != 0) result.lower = 0;  // nothing is free then
  if (vague) result.upper = infinity;
  result.state = result.upper <= options.margin  ? state::collision
                 : result.lower > options.margin ? state::free
                                                 : state::possible;
  return result;
}

}  // namespace detail

/// As `motion_clearance(on, robot, ...)`, with your prepared query about the same robot, which keeps its memory.
template <class On, class PartView, class Robot, motion Motion, class Clouds>
motion_clearance_result motion_clearance(query<min_distance_per_part, On, PartView>& ask, const Robot& robot,
                                         const Motion& motion, const Clouds& clouds,
                                         const motion_clearance_options& options = {}) {
  static_assert(explain_robot<Robot>() && explain_clouds<Clouds>());
  static_assert(
      !requires(const On& on) { on.comm; },
      "ranks would ask at different times of a motion: ask them min_distance_per_part yourself, or one rank alone");
  const auto at = [&](std::span<const Eigen::Isometry3d> poses) -> decltype(auto) { return ask(poses, clouds); };
  return detail::over_motion(at, detail::facts_of(robot), motion, clouds, options);
}

/// A lower bound of the clearance over a motion, never above it. Every part's least distance is asked at times where
/// the bound is lowest; between them a part can come nearer only by as much as it moves. `clouds` as for `ask`; they
/// are asked many times, so clouds for a device should be there. Throws std::invalid_argument as `ask` and the motion
/// do, and if a tolerance or a margin is negative or not a number.
template <class On, class Robot, motion Motion, class Clouds>
motion_clearance_result motion_clearance(const On& on, const Robot& robot, const Motion& motion, const Clouds& clouds,
                                         const motion_clearance_options& options = {}) {
  static_assert(detail::explain_asked<On, Robot, min_distance_per_part>());
  query prepared(on, robot, min_distance_per_part{});
  return motion_clearance(prepared, robot, motion, clouds, options);
}

}  // namespace clearance
