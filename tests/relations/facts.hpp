// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What any answer says, one fact at a time, whatever its clouds are called. Facts are found by the names of members, so
// that a new question needs no line here.

#include "support/same_answer.hpp"

#include <clearance/concepts/answer.hpp>
#include <clearance/points/masked.hpp>

#include <algorithm>

namespace testing {

enum class fact_kind : std::uint8_t {
  other,
  near,    ///< A length that falls, or stays, where something comes nearer.
  pair,    ///< The distance of one pair of a point and a part, or of a point and the robot.
  count,   ///< Of points.
  state,   ///< How bad it is.
  who,     ///< Which point is the nearest.
  lowest,  ///< The lowest of several points: it depends on their order.
  place,   ///< In world coordinates.
  lone,    ///< About points that are not confirmed, uncertain, or nobody's: they become fewer as well as more.
};

struct fact {
  std::uint64_t path, id;  ///< Where in the result it stands; and of which point it is, and of which part.
  fact_kind kind;
  bool whole, real;  ///< A number of points; a number with a rounding.
  std::uint64_t bits;
  double value;

  friend bool operator<(const fact& a, const fact& b) { return std::tie(a.path, a.id) < std::tie(b.path, b.id); }
};

/// Which point is which: `ids[cloud][point]`.
using point_ids = std::vector<std::vector<std::uint64_t>>;

class facts {
 public:
  template <class Result>
  facts(const Result& r, const point_ids& ids) : ids_(ids) {
    for (const auto& cloud : ids) flat_.insert(flat_.end(), cloud.begin(), cloud.end());
    walk(fnv, r, fact_kind::other);
    std::stable_sort(all_.begin(), all_.end());
    // Two points of one name say the same, or `contradicts` is set.
    const auto same = [this](const fact& a, const fact& b) {
      const bool one = !(a < b) && !(b < a);
      contradicts |= one && a.bits != b.bits;
      return one;
    };
    all_.erase(std::unique(all_.begin(), all_.end(), same), all_.end());
  }

  const std::vector<fact>& all() const { return all_; }
  const fact* find(const fact& f) const {
    const auto at = std::lower_bound(all_.begin(), all_.end(), f);
    return at != all_.end() && !(f < *at) ? &*at : nullptr;
  }
  /// Does it name this point, or say that it, or some point, is inside?
  bool notice(std::uint64_t point) const {
    return std::any_of(all_.begin(), all_.end(), [&](const fact& f) {
      const bool named = f.kind == fact_kind::who || f.kind == fact_kind::lowest || f.kind == fact_kind::lone;
      return (named && f.bits == point) || (f.kind == fact_kind::pair && f.id == point && f.value <= 0) ||
             (f.kind == fact_kind::other && f.id == point && f.value == double(clearance::point_label::own)) ||
             (f.kind == fact_kind::state && clearance::state(f.bits) == clearance::state::collision);
    });
  }
  bool contradicts = false;

 private:
  static constexpr std::uint64_t fnv = 0xcbf29ce484222325, nobody = ~std::uint64_t(0);
  static std::uint64_t next(std::uint64_t path, std::uint64_t i) { return (path ^ (i + 1)) * 0x100000001b3; }

  template <class T>
  void add(std::uint64_t path, std::uint64_t id, fact_kind kind, const T& a) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &a, sizeof a);
    const bool whole = std::is_integral_v<T> && sizeof a == 8;
    if (whole && kind == fact_kind::other) kind = fact_kind::count;
    if constexpr (std::is_same_v<T, clearance::state>)
      if (kind == fact_kind::other) kind = fact_kind::state;
    all_.push_back({path, id, kind, whole, std::is_floating_point_v<T>, bits, double(a)});
  }
  void add_name(std::uint64_t path, fact_kind kind, std::uint32_t cloud, std::uint32_t point) {
    all_.push_back({path, nobody, kind, false, false, name(cloud, point), 0});
  }
  template <class A, class B>
  static bool same(const A& a, const B& b) {
    return std::is_same_v<A, B> && static_cast<const void*>(&a) == static_cast<const void*>(&b);
  }

  template <class T>
  void walk(std::uint64_t path, const T& a, fact_kind kind) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      add(path, nobody, kind, a);
    } else if constexpr (requires { a.begin(), a.size(); }) {
      list(path, a, kind);
    } else if constexpr (std::is_same_v<T, counts_by_reason>) {
      walk(path, a.dropped, kind);
    } else if constexpr (std::is_array_v<T>) {
      for (std::size_t i = 0; i < std::size(a); ++i) walk(next(path, i), a[i], kind);
    } else {
      std::uint64_t i = 99;
      with_members(a, [&](const auto&... each) { (member(next(path, ++i), a, each, kind), ...); });
      const fact_kind its = kind == fact_kind::lone ? kind : fact_kind::who;
      if constexpr (requires { a.cloud, a.point, a.distance; })
        add_name(path, its, a.cloud, a.point);
      else if constexpr (requires { a.cloud, a.point; })
        add_name(path, fact_kind::lowest, a.cloud, a.point);
      if constexpr (requires { a.nearest_cloud; }) add_name(next(path, 1), its, a.nearest_cloud, a.nearest_point);
      if constexpr (requires { a.first_cloud; })
        add_name(next(path, 2), fact_kind::lowest, a.first_cloud, a.first_point);
    }
  }

  template <class T, class M>
  void member(std::uint64_t path, const T& a, const M& m, fact_kind kind) {
    const auto is = [&](const auto&... others) { return (same(m, others) || ...); };
    if constexpr (requires { a.cloud, a.point; })
      if (is(a.cloud, a.point)) return;
    if constexpr (requires { a.cloud, a.point, a.part; } && !requires { a.distance; })
      if (is(a.part)) kind = fact_kind::lowest;
    if constexpr (requires { a.nearest_cloud; })
      if (is(a.nearest_cloud, a.nearest_point)) return;
    if constexpr (requires { a.first_cloud; })
      if (is(a.first_cloud, a.first_point)) return;
    if constexpr (requires { a.offsets; })  // how lists are divided is no fact of its own
      if (is(a.offsets)) return;
    if constexpr (std::is_integral_v<M>) {
      if constexpr (requires { a.per_part; })
        if (is(a.per_part)) return;
      if constexpr (requires { a.parts; })
        if (is(a.parts)) return;
    }
    if constexpr (requires { a.rest; })
      if (is(a.rest)) return numbers(path, m);
    if (kind != fact_kind::lone) {
      if constexpr (requires { a.isolated, a.nearest_isolated; })
        if (is(a.isolated, a.nearest_isolated)) kind = fact_kind::lone;
      if constexpr (requires { a.own, a.uncertain; })
        if (is(a.uncertain)) kind = fact_kind::lone;
      if constexpr (requires { a.distance; })
        if (is(a.distance)) kind = fact_kind::near;
      if constexpr (requires { a.lower; })
        if (is(a.lower)) kind = fact_kind::near;
      if constexpr (requires { a.upper; })
        if (is(a.upper)) kind = fact_kind::near;
      if constexpr (requires { a.at, a.normal; })
        if (is(a.at, a.normal)) kind = fact_kind::place;
      if constexpr (requires { a.nearest; })
        if (is(a.nearest)) kind = std::is_floating_point_v<M> ? fact_kind::near : fact_kind::place;
    }
    walk(path, m, kind);
  }

  template <class List>
  void list(std::uint64_t path, const List& a, fact_kind kind) {
    using element = std::remove_cvref_t<decltype(*a.begin())>;
    if constexpr (std::is_same_v<element, clearance::pair_distance>) {
      for (const auto& each : a)
        if (each.cloud != clearance::none) {
          const std::uint64_t its = next(path, each.part), who = name(each.cloud, each.point);
          add(its, who, fact_kind::pair, each.distance), add(next(its, 0), who, fact_kind::other, each.primitive);
        }
    } else if constexpr (std::is_arithmetic_v<element> || std::is_enum_v<element>) {
      const std::size_t n = flat_.size();
      if (n == 0 || a.size() < n || a.size() % n != 0) {
        for (std::size_t i = 0; i < a.size(); ++i) add(next(path, i), nobody, kind, a[i]);
        return;
      }
      if (kind == fact_kind::near) kind = fact_kind::pair;
      for (std::size_t i = 0; i < a.size(); ++i) add(next(path, i / n), flat_[i % n], kind, a[i]);
    } else {
      for (std::size_t i = 0; i < a.size(); ++i) walk(next(path, i), a[i], kind);
    }
  }
  /// Numbers of points through all clouds.
  template <class List>
  void numbers(std::uint64_t path, const List& a) {
    if constexpr (requires { flat_[a[0]]; })
      for (const auto number : a) add(path, flat_.at(number), fact_kind::lone, true);
  }

  std::uint64_t name(std::uint32_t cloud, std::uint32_t point) const {
    return cloud == clearance::none ? nobody : ids_.at(cloud).at(point);
  }

  const point_ids& ids_;
  std::vector<std::uint64_t> flat_;
  std::vector<fact> all_;
};

}  // namespace testing
