// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The laws of the concepts as checks. To test a new model, name it.

#include "support/catch.hpp"
#include "support/oracle.hpp"
#include "support/random.hpp"

#include <clearance/concepts.hpp>

#include <cstring>
#include <string>

namespace testing {

using clearance::infinity;
using oracle::wide, oracle::wider;

/// Counts violations and keeps the first; millions of REQUIRE would be slow.
class verdict {
 public:
  template <class... Words>
  void require(bool holds, const Words&... words) {
    ++checked_;
    if (holds) return;
    if (++broken_ == 1) ((first_ += text(words)), ...);
  }
  ~verdict() noexcept(false) {
    if (std::uncaught_exceptions() > 0) return;
    INFO(broken_ << " of " << checked_ << " checks fail; the first: " << first_);
    REQUIRE(broken_ == 0);
    REQUIRE(checked_ > 0);
  }

 private:
  static std::string text(const char* s) { return s; }
  static std::string text(const std::string& s) { return s; }
  static std::string text(vec3 p) { return "(" + text(p.x) + ", " + text(p.y) + ", " + text(p.z) + ")"; }
  template <class T>
  static std::string text(T x) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, " %.12Lg", wide(x));
    return buffer;
  }

  std::size_t checked_ = 0, broken_ = 0;
  std::string first_;
};

inline bool same_bits(real a, real b) { return std::memcmp(&a, &b, sizeof a) == 0; }
template <class T>
bool same_bytes(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Points to try volumes at: near the balls, on their surfaces, at their centres, and far away.
inline std::vector<vec3> probes(dice& d, const std::vector<ball>& balls, double size) {
  std::vector<vec3> all;
  for (const double half : {0.3, 1.0, 3.0, 100.0, 1e5})
    for (int k = 0; k < 60; ++k) all.push_back(d.point(half * size, balls[0].center));
  for (std::size_t k = 0; k < 60; ++k) {
    const ball& b = balls[k % balls.size()];
    all.push_back(b.center);
    all.push_back(clearance::fma(b.radius, d.direction(), b.center));
    all.push_back(clearance::fma(b.radius + real(1e-6 * size), d.direction(), b.center));
  }
  return all;
}

/// Something whose computed distance is `distance` must not be ruled out.
template <clearance::bounding_volume V>
void check_reach(const V& volume, vec3 q, real distance, verdict& v) {
  if constexpr (clearance::rootless_volume<V>)
    v.require(clearance::bounding_volume_traits<V>::may_reach(volume, q, distance), "ruled out at ", q, ", though",
              distance, " away");
}

/// A point's computed distance is between what the tangent at another point says.
inline void check_tangent(const clearance::tangent& t, vec3 q, vec3 p, real computed, verdict& v) {
  const auto e = wider(p) - wider(q);
  const wide along = wide(t.direction.x) * e.x + wide(t.direction.y) * e.y + wide(t.direction.z) * e.z;
  const wide least = wide(t.distance) + along - wide(clearance::slack) * oracle::length(e);
  v.require(least <= computed, "the tangent at ", q, " says", least, ", though", computed, " away at ", p);
}

template <clearance::primitive P>
void check_tangents(const P& primitive, vec3 q, vec3 p, verdict& v) {
  if constexpr (clearance::tangent_primitive<P>) {
    const clearance::primitive_tangent t = primitive.tangent_at(q);
    const real computed = primitive.distance(p);
    check_tangent(t, q, p, computed, v);
    const auto e = wider(p) - wider(q);
    const wide way = oracle::length(e),
               along = wide(t.direction.x) * e.x + wide(t.direction.y) * e.y + wide(t.direction.z) * e.z;
    wide most = wide(t.most) + way;
    if (t.radius > 0) most = std::min(most, wide(t.most) + along + way * way / (2 * wide(t.radius)));
    v.require(computed <= most + wide(clearance::slack) * way, "the tangent at ", q, " says at most", most, ", though",
              computed, " away at ", p);
  }
}

/// No lower bound exceeds the signed distance to an enclosed ball, or to a primitive as computed. At every centre it is
/// negative.
template <clearance::bounding_volume V>
void check_bounds(dice& d, const std::vector<ball>& balls, double size, verdict& v) {
  using traits = clearance::bounding_volume_traits<V>;
  const V volume = traits::fit(balls);
  if constexpr (clearance::round_volume<V>) {
    const ball around = traits::as_ball(volume);
    for (const ball& b : balls) {
      const wide deepest = oracle::to_sphere(wider(b.center), wider(around.center), around.radius);
      v.require(deepest + b.radius <= 0, "a ball at ", b.center, b.radius, " sticks out of the volume that is one");
    }
  }
  const auto all = probes(d, balls, size);
  for (const vec3 q : all) {
    const real bound = traits::lower_bound(volume, q);
    if constexpr (clearance::tangent_volume<V>) {
      const auto t = traits::tangent_at(volume, q);
      v.require(std::abs(oracle::length(wider(t.direction)) - 0.5L) < 0.501L, "a direction is too long at ", q);
      for (int other = 0; other < 4; ++other) {
        const vec3 p = all[d.below(unsigned(all.size()))];
        for (const ball& b : balls) check_tangent(t, q, p, inner_sphere{b.center, b.radius}.distance(p), v);
        for (std::size_t k = 0; k + 2 < balls.size() && k < 4; ++k)
          check_tangent(t, q, p, triangle::from(balls[k].center, balls[k + 1].center, balls[k + 2].center).distance(p),
                        v);
      }
    }
    for (const ball& b : balls) {
      const wide exact = oracle::to_sphere(wider(q), wider(b.center), b.radius);
      v.require(bound <= exact, "bound", bound, " above distance", exact, " at ", q, " of ball ", b.center, b.radius);
      const real computed = inner_sphere{b.center, b.radius}.distance(q);
      v.require(bound <= computed, "bound", bound, " above computed", computed, " at ", q, " of ball ", b.center,
                b.radius);
      check_reach(volume, q, computed, v);
    }
    for (std::size_t k = 0; k + 2 < balls.size() && k < 30; ++k) {
      const auto face = triangle::from(balls[k].center, balls[k + 1].center, balls[k + 2].center);
      v.require(bound <= face.distance(q), "bound", bound, " above a triangle's computed", face.distance(q), " at ", q);
      check_reach(volume, q, face.distance(q), v);
    }
  }
  for (const ball& b : balls)
    if (b.radius > 0) v.require(traits::lower_bound(volume, b.center) < 0, "not negative at ", b.center);
}

template <clearance::bounding_volume V>
void check_volume_laws() {
  static_assert(clearance::explain_bounding_volume<V>());
  for (const double size : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    for (const vec3 offset : {vec3{0, 0, 0}, vec3{3, -2, 1}, vec3{5e6f, -4.5e6f, 900}}) {
      verdict v;
      dice d(unsigned(size * 7 + offset.x));
      for (const std::size_t n : {1, 2, 3, 8, 60}) {
        for (const double thickness : {0.0, 0.1, 1.0}) {  // points, small balls, overlapping balls
          std::vector<ball> balls(n);
          for (ball& b : balls) b = {d.point(size, offset), d.number(0, thickness * size)};
          check_bounds<V>(d, balls, size, v);
          for (ball& b : balls) b.center.z = offset.z;  // flat
          check_bounds<V>(d, balls, size, v);
          for (ball& b : balls) b.center.y = offset.y;  // on a line
          check_bounds<V>(d, balls, size, v);
          for (ball& b : balls) b = balls[0];  // coincident
          check_bounds<V>(d, balls, size, v);
        }
      }
      // One giant among small ones.
      std::vector<ball> balls(20);
      for (ball& b : balls) b = {d.point(size, offset), real(1e-4 * size)};
      balls[7].radius = real(50 * size);
      check_bounds<V>(d, balls, size, v);
    }
  }
}

/// `reach()` never grows, a farther offer changes nothing, and the order of offers does not matter.
template <clearance::visitor Q, class Same>
void check_visitor_laws(const Q& start, Same same) {
  static_assert(clearance::explain_visitor<Q>());
  dice d(11);
  verdict v;
  for (int round = 0; round < 300; ++round) {
    std::vector<std::pair<std::uint32_t, real>> offers(1 + d.below(12));
    for (std::uint32_t k = 0; k < offers.size(); ++k) offers[k] = {k, real(d.below(7)) / 4 - 0.25f};  // many ties
    Q first = start;
    for (const auto& [id, distance] : offers) {
      const real before = first.reach();
      const auto result = first.result();
      first.offer(id, distance);
      v.require(first.reach() <= before, "reach grew from", before, " to", first.reach());
      v.require(distance <= before || same(result, first.result()), "an offer beyond reach changed the result");
    }
    for (int shuffle = 0; shuffle < 4; ++shuffle) {
      for (std::size_t k = offers.size(); k > 1; --k) std::swap(offers[k - 1], offers[d.below(unsigned(k))]);
      Q other = start;
      for (const auto& [id, distance] : offers) other.offer(id, distance);
      v.require(same(first.result(), other.result()), "the order of offers changed the result");
    }
  }
}

/// Reading has no effects, a valid sample is finite, and a copy of the bytes gives the same samples.
template <clearance::point_source S>
void check_point_source_laws(const S& source) {
  static_assert(clearance::explain_point_source<S>());
  verdict v;
  const auto bytes = source.bytes();
  std::vector<std::byte> copy(bytes.begin(), bytes.end());
  const S moved = source.at(copy.data());
  v.require(moved.size() == source.size(), "the copy has another size");
  for (std::size_t i = 0; i < source.size(); ++i) {
    const clearance::sample s = source[i];
    const clearance::sample again = source[i], there = moved[i];
    v.require(!s.valid() || clearance::is_finite(s.position), "sample", i, " is valid but not finite");
    v.require(s.dropped == again.dropped && same_bytes(s.position, again.position), "sample", i, " is not pure");
    v.require(s.dropped == there.dropped && same_bytes(s.position, there.position), "sample", i, " differs in a copy");
  }
}

/// Every primitive is below the root exactly once, volumes bound everything below them, and depth and width are right.
template <clearance::hierarchy H>
class hierarchy_check {
 public:
  using P = typename H::primitive_type;

  hierarchy_check(const H& tree, const std::vector<P>& primitives, verdict& v)
      : tree_(tree), input_(primitives), verdict_(v), times_(primitives.size()) {
    static_assert(clearance::explain_hierarchy<H>());
    dice d(5);
    for (const P& p : primitives) {
      const ball b = p.balls()[0];
      probes_.push_back(b.center);
      probes_.push_back(b.center + d.point(0.1));
      if (probes_.size() > 40) break;
    }
    std::vector<std::uint32_t> below;
    walk(tree.root(), 0, below);
    for (std::size_t k = 0; k < times_.size(); ++k)
      v.require(times_[k] == 1, "primitive", k, " occurs", times_[k], " times");
    v.require(tree.depth() == deepest_, "depth() is", tree.depth(), " but the tree's is", deepest_);
    v.require(tree.width() == widest_, "width() is", tree.width(), " but the tree's is", widest_);
  }

 private:
  void walk(typename H::node_type n, std::uint32_t depth, std::vector<std::uint32_t>& below) {
    deepest_ = std::max(deepest_, depth);
    verdict_.require(tree_.size(n) > 0, "a node is empty");
    if (tree_.is_leaf(n)) {
      for (std::uint32_t k = 0; k < tree_.size(n); ++k) {
        const std::uint32_t id = tree_.id(n, k);
        verdict_.require(id < input_.size(), "id", id, " does not exist");
        if (id >= input_.size()) continue;
        ++times_[id];
        verdict_.require(same_bytes<P>(tree_.primitive(n, k), input_[id]), "primitive", id, " is not the input's");
        below.push_back(id);
      }
    } else {
      widest_ = std::max(widest_, tree_.size(n));
      for (std::uint32_t k = 0; k < tree_.size(n); ++k) {
        std::vector<std::uint32_t> ids;
        walk(tree_.child(n, k), depth + 1, ids);
        below.insert(below.end(), ids.begin(), ids.end());
      }
    }
    using traits = clearance::bounding_volume_traits<typename H::volume_type>;
    for (const vec3 q : probes_) {
      const real bound = traits::lower_bound(tree_.volume(n), q);
      for (const std::uint32_t id : below)
        verdict_.require(bound <= input_[id].distance(q), "a node does not bound", id);
    }
  }

  const H& tree_;
  const std::vector<P>& input_;
  verdict& verdict_;
  std::vector<int> times_;
  std::vector<vec3> probes_;
  std::uint32_t deepest_ = 0, widest_ = 1;
};

}  // namespace testing
