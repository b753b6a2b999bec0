// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from itself? Of each pair of parts that can meet, one is a robot, and the other's inner spheres
// are balls before it.

#include <clearance/as_balls.hpp>
#include <clearance/frames/margins.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/robot/part_pairs.hpp>

#include <deque>

namespace clearance {

/// The least distance of two parts, a < b, and which spheres attain it, numbered as they were given. Metres; below 0 if
/// they overlap. The solids are at least `lower` apart.
struct pair_clearance {
  std::uint32_t a = none, b = none;
  real distance = infinity, lower = 0;
  std::uint32_t sphere_a = none, sphere_b = none;
  position at_a = {0, 0, 0}, at_b = {0, 0, 0};  ///< The nearest places of both spheres, in the world, metres.
  vec3 normal = {0, 0, 0};                      ///< The unit vector from b to a; 0 if their centres coincide.
};

/// The least distance of all pairs, in world coordinates. `lower <= distance of the solids <= upper`. `collision`: two
/// parts certainly overlap; `no_data`: there is no pair.
struct self_clearance : pair_clearance {
  clearance::state state = clearance::state::no_data;
  real upper = infinity;
};

/// The least distance of all pairs, and each pair's: first those of part 0, then those of part 1 with higher ones.
struct self_distance_result : self_clearance {
  std::vector<pair_clearance> pairs;  ///< Each pair that can meet.
};

namespace detail {

template <class H>
inline constexpr bool views_spheres = false;
template <class V>
inline constexpr bool views_spheres<bvh_view<V, inner_sphere>> = true;

/// Part `a` as balls, and the parts above it that it can meet as a robot, where `On` runs.
template <class On, class PartView>
struct part_before_others {
  std::uint32_t a;
  std::vector<std::uint32_t> others;
  std::vector<part_facts> facts;
  std::uint32_t depth = 0, width = 0;
  typename On::template buffer<PartView> views;
  solid_balls<ball_records> balls;
  std::vector<inner_sphere> spheres;
  std::vector<std::uint32_t> ids;  ///< Of the spheres.

  part_before_others(const On& on, std::uint32_t a, std::vector<std::uint32_t> with, std::span<const PartView> parts)
      : a(a),
        others(std::move(with)),
        balls(balls_at<true>(parts[a].tree.primitives, parts[a].tree.primitive_count, parts[a].facts.gap,
                             parts[a].facts.tolerance)),
        spheres(on.copy_out(parts[a].tree.primitives, parts[a].tree.primitive_count)),
        ids(on.copy_out(parts[a].tree.ids, spheres.size())) {
    std::vector<PartView> some;
    for (const std::uint32_t b : others) {
      some.push_back(parts[b]);
      facts.push_back(parts[b].facts);
      depth = std::max(depth, parts[b].tree.depth());
      width = std::max(width, parts[b].tree.width());
    }
    views = on.copy_in(std::span<const PartView>(some));
  }
  model_view<PartView> view() const { return {views.data(), {facts.data(), facts.size()}, depth, width}; }

  /// The answer about the others as one about the robot, if it is less than `all`. `world`: from the answer's frame.
  void lower_to(self_clearance& all, const min_distance_result& r, const world_transform& world) const {
    if (r.part == none) return;
    const bool some = all.state != state::no_data;
    const bool inside = r.state == state::collision || all.state == state::collision;
    const real lower = some ? std::min(all.lower, r.lower) : r.lower, upper = std::min(all.upper, r.upper);
    if (!some || r.distance < all.distance) {
      const inner_sphere& its = spheres[r.point];
      all.a = a;
      all.b = others[r.part];
      all.distance = r.distance;
      all.sphere_a = ids[r.point];
      all.sphere_b = r.primitive;
      all.normal = world.turned(r.normal);
      const position center = world(r.at);
      all.at_a = {center.x - double(its.radius) * all.normal.x, center.y - double(its.radius) * all.normal.y,
                  center.z - double(its.radius) * all.normal.z};
      all.at_b = world(r.nearest);
    }
    all.lower = inside ? 0 : lower;
    all.upper = inside ? 0 : upper;
    all.state = inside ? state::collision : all.lower > 0 ? state::free : state::possible;
  }
};

/// Where two spheres are nearest to one another.
inline void put_places(pair_clearance& pair, const inner_sphere& a, const Eigen::Isometry3d& at_a,
                       const inner_sphere& b, const Eigen::Isometry3d& at_b) {
  const auto placed_at = [](const inner_sphere& s, const Eigen::Isometry3d& at) -> Eigen::Vector3d {
    return at * Eigen::Vector3d(s.center.x, s.center.y, s.center.z);
  };
  const Eigen::Vector3d from = placed_at(a, at_a), to = placed_at(b, at_b), apart = from - to;
  const double length = apart.norm();
  const Eigen::Vector3d way = length > 0 ? Eigen::Vector3d(apart / length) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d on_a = from - double(a.radius) * way, on_b = to + double(b.radius) * way;
  pair.at_a = {on_a.x(), on_a.y(), on_a.z()};
  pair.at_b = {on_b.x(), on_b.y(), on_b.z()};
  pair.normal = {real(way.x()), real(way.y()), real(way.z())};
}

/// All parts that others can meet. Throws std::invalid_argument if the pairs are of another robot.
template <class On, class PartView>
std::vector<part_before_others<On, PartView>> parts_before_others(const On& on, const model_view<PartView>& robot,
                                                                  const part_pairs& pairs) {
  static_assert(views_spheres<typename PartView::hierarchy_type>,
                "a robot is asked about itself if its parts are inner spheres in trees of build: pack them");
  if (pairs.parts() != robot.size())
    throw std::invalid_argument("clearance: there are " + std::to_string(robot.size()) + " parts, but pairs of " +
                                std::to_string(pairs.parts()));
  const std::vector<PartView> parts = on.copy_out(robot.parts, robot.size());
  std::vector<part_before_others<On, PartView>> all;
  for (std::uint32_t a = 0; a < parts.size(); ++a)
    if (std::vector<std::uint32_t> above = pairs.above(a); !above.empty()) all.emplace_back(on, a, above, parts);
  return all;
}

}  // namespace detail

/// Asks how far a robot is from itself, in every frame with new poses. It is prepared as a `query` is: it keeps memory,
/// and the robot must outlive it. Parts are inner spheres, on `On`, a host or a device.
template <class On, class PartView>
class self_query {
 public:
  /// Throws std::invalid_argument if the pairs are of another number of parts.
  template <robot Robot>
  self_query(const On& on, const Robot& robot, const part_pairs& pairs)
      : on_(on), parts_(view_of(robot).size()), groups_(detail::parts_before_others(on, view_of(robot), pairs)) {
    for (const group& g : groups_) asks_.emplace_back(on, g.view(), min_distance_per_part{});
    for (const PartView& part : on.copy_out(view_of(robot).parts, parts_)) {
      const auto placed_in_tree = on.copy_out(part.tree.primitives, part.tree.primitive_count);
      const auto ids = on.copy_out(part.tree.ids, placed_in_tree.size());
      std::vector<inner_sphere>& its = given_.emplace_back();
      for (std::size_t i = 0; i < ids.size(); ++i) {
        its.resize(std::max(its.size(), std::size_t(ids[i]) + 1));
        its[ids[i]] = placed_in_tree[i];
      }
    }
    found_ = on.copy_in(std::span<const min_distance_result>(std::vector<min_distance_result>(groups_.size())));
    minima_ = on.copy_in(std::span<const part_minimum>(std::vector<part_minimum>(pairs.size())));
  }
  template <owning_robot Robot>
  self_query(const On&, const Robot&&, const part_pairs&) = delete;  // it would be gone when it is asked; name it
  self_query(const self_query&) = delete;                            // what was prepared looks at its memory
  self_query(self_query&&) = default;

  /// `poses` are world-from-part, one for each part. Throws std::invalid_argument if their number is wrong or one is
  /// not rigid.
  self_distance_result operator()(std::span<const Eigen::Isometry3d> poses) {
    if (poses.size() != parts_)
      throw std::invalid_argument("clearance: there are " + std::to_string(parts_) + " parts, but " +
                                  std::to_string(poses.size()) + " poses");
    std::size_t first = 0;
    std::vector<frames::float_error> errors;
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      const group& g = groups_[k];
      its_poses_.clear();
      for (const std::uint32_t b : g.others) its_poses_.push_back(poses[b]);
      const placed balls{g.balls, poses[g.a]};
      asks_[k].enqueue(its_poses_, balls, {found_.data() + k, minima_.data() + first});
      errors.push_back(ahead_.facts_of(g.facts, its_poses_, balls).error);
      first += g.others.size();
    }
    const std::vector<min_distance_result> found = on_.copy_out(found_);
    const std::vector<part_minimum> minima = on_.copy_out(minima_);
    self_distance_result all;
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      const group& g = groups_[k];
      g.lower_to(all, found[k], {});
      const bool anywhere = found[k].dropped[int(drop_reason::too_close)] != 0;
      for (std::size_t n = 0; n < g.others.size(); ++n) {
        const part_minimum& its = minima[all.pairs.size()];
        pair_clearance& pair = all.pairs.emplace_back(pair_clearance{.a = g.a, .b = g.others[n]});
        if (its.point == none) continue;
        const double lower = frames::certain_distance(its.distance, frames::slop(g.facts[n]), errors[k]);
        pair.distance = its.distance;
        pair.lower = lower > 0 && !anywhere ? rounded_down(lower) : 0;
        pair.sphere_a = g.ids[its.point];
        pair.sphere_b = its.primitive;
        detail::put_places(pair, given_[pair.a][pair.sphere_a], poses[pair.a], given_[pair.b][pair.sphere_b],
                           poses[pair.b]);
      }
    }
    return all;
  }
  self_distance_result operator()(const std::vector<Eigen::Isometry3d>& poses) { return (*this)(std::span(poses)); }

 private:
  using group = detail::part_before_others<On, PartView>;

  On on_;
  std::size_t parts_;
  std::vector<group> groups_;
  std::deque<query<min_distance_per_part, On, PartView>> asks_;  // they stay where they are
  std::vector<std::vector<inner_sphere>> given_;                 // each part's, by their numbers
  typename On::template buffer<min_distance_result> found_;
  typename On::template buffer<part_minimum> minima_;
  std::vector<Eigen::Isometry3d> its_poses_;
  frames::frame_ahead ahead_;
};
template <class On, class Robot>
self_query(const On&, const Robot&, const part_pairs&) -> self_query<On, typename detail::part_view_of<Robot>::type>;

/// The same once.
template <class On, robot Robot>
self_distance_result self_distance(const On& on, const Robot& robot, std::span<const Eigen::Isometry3d> poses,
                                   const part_pairs& pairs) {
  return self_query(on, robot, pairs)(poses);
}

}  // namespace clearance
