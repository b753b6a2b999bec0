// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from everything that its sensors see?

#include <clearance/minimum/engine.hpp>
#include <clearance/minimum/merge.hpp>
#include <clearance/query/query.hpp>

#include <ranges>

namespace clearance {

namespace minimum {

/// Answers about pieces of all clouds, up to that of one call.
template <class Q, class PartView>
class joined {
 public:
  joined(const Q&, std::span<const part_facts>) {}

  static min_distance_result& least(typename Q::result& r) {
    if constexpr (Q::per_part)
      return r.all;
    else
      return r;
  }
  void add(typename Q::result piece, const piece_place& place) {
    const auto put = [&](auto& r) {
      if (r.cloud != none) r.point += place.first[r.cloud];
    };
    put(least(piece));
    const of_pieces its(least(piece));
    any_ ? pieces_.add(its) : void(pieces_ = its);
    if constexpr (Q::per_part) {
      parts_.resize(piece.parts.size());
      for (std::size_t k = 0; k < piece.parts.size(); ++k) {
        put(piece.parts[k]);
        parts_[k] = merge(parts_[k], piece.parts[k]);
      }
    }
    any_ = true;
  }
  /// How near a point must be to change the answer.
  real reach() const { return any_ && pieces_.all.part != none ? pieces_.all.distance : infinity; }
  typename Q::result result() const {
    const min_distance_result all = any_ ? pieces_.answer(scan::has_interior<PartView>) : min_distance_result{};
    if constexpr (Q::per_part)
      return {all, parts_};
    else
      return all;
  }

 private:
  of_pieces pieces_;
  std::vector<part_minimum> parts_;
  bool any_ = false;
};

/// For a chunked cloud: minimum/chunked_search.hpp.
template <class On, class PartView, class Q>
class chunks;

/// A point that is unseen may be anywhere.
inline void allow_for_unseen(min_distance_result& r, std::uint64_t unseen) {
  if (unseen == 0) return;
  r.lower = 0;
  if (r.state == state::free) r.state = state::possible;
}

}  // namespace minimum

/// The least distance over all parts and all points, with its bracket and witness.
struct min_distance {
  using result = min_distance_result;
  using can = clearance::can<joining, chunking, partial>;
  using out = min_distance_result*;  ///< In memory that the backend writes.
  static constexpr bool per_part = false;
  template <class On, class PartView>
  using engine = minimum::engine<On, PartView, min_distance>;
  template <class PartView>
  using joined = minimum::joined<min_distance, PartView>;
  template <class On, class PartView>
  using chunks = minimum::chunks<On, PartView, min_distance>;

  static void so_far(result& r, std::uint64_t unseen) { minimum::allow_for_unseen(r, unseen); }
};

/// The least distance of the robot, and of each part.
struct min_distance_per_part_result {
  min_distance_result all;
  std::vector<part_minimum> parts;
};

/// The least distance of the robot, and of each part: each has its own bound.
struct min_distance_per_part {
  using result = min_distance_per_part_result;
  using can = clearance::can<joining, chunking, partial>;
  struct out {
    min_distance_result* result;
    part_minimum* minima;  ///< One per part.
  };
  static constexpr bool per_part = true;
  template <class On, class PartView>
  using engine = minimum::engine<On, PartView, min_distance_per_part>;
  template <class PartView>
  using joined = minimum::joined<min_distance_per_part, PartView>;
  template <class On, class PartView>
  using chunks = minimum::chunks<On, PartView, min_distance_per_part>;

  static void so_far(result& r, std::uint64_t unseen) { minimum::allow_for_unseen(r.all, unseen); }
};

/// Asks about several robots and the same clouds, which are copied once if `on` cannot read them. `robots` is a range
/// of models or views, `poses` a range of their parts' poses. Throws std::invalid_argument as `ask`, and if the ranges
/// differ in size.
template <class On, std::ranges::forward_range Robots, std::ranges::forward_range Poses, class Clouds>
std::vector<min_distance_result> min_distance_per_robot(const On& on, const Robots& robots, const Poses& poses,
                                                        const Clouds& clouds) {
  static_assert(explain_clouds<Clouds>());
  const auto count = std::size_t(std::ranges::distance(robots));
  if (count != std::size_t(std::ranges::distance(poses)))
    throw std::invalid_argument("clearance: there are " + std::to_string(count) + " robots, but poses for " +
                                std::to_string(std::ranges::distance(poses)));
  auto next = std::ranges::begin(poses);
  if constexpr (requires { typename On::several; }) {
    std::vector<min_distance_result> results;
    for (const auto& robot : robots) results.push_back(ask(on, robot, *next++, clouds, min_distance{}));
    return results;
  } else {
    return detail::one_call<On>::of(on, [&](auto... memory) {
      frames::readable_clouds<On> copies(on, memory...);
      const auto& here = copies(clouds);
      auto results = on.template make_scratch<min_distance_result>(count);
      auto* result = results.data();
      for (const auto& robot : robots) query(on, robot, min_distance{}, memory...).enqueue(*next++, here, result++);
      return on.copy_out(results.data(), count);
    });
  }
}

}  // namespace clearance
