// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The laws of bounds, as room that is left (climb.hpp). What is true is computed in double, of floats: its errors are
// 2^-29 of what room is measured in.

#include "bounds/climb.hpp"
#include "reference/exact.hpp"

#include <clearance/frames/bracket.hpp>
#include <clearance/frames/root_test.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/primitive/triangle.hpp>

#include <cstring>
#include <vector>

namespace bounds {

using clearance::ball, clearance::capsule, clearance::inner_sphere, clearance::real, clearance::triangle,
    clearance::vec3;
using reference::wider;
using wide = reference::vec<double>;

inline constexpr double unit = 0x1p-24, underflow = 0x1p-72;

inline vec3 vector_at(const float* x) { return {x[0], x[1], x[2]}; }

/// Draws numbers about `middle`, and at times straight or flat ones: one or two coordinates of all are alike.
inline void draw_near(float* x, std::size_t count, vec3 middle, float size, chance& c) {
  const float about[3] = {middle.x, middle.y, middle.z};
  const std::uint32_t flat = c.below(4) == 0 ? 1 + c.below(6) : 0;
  for (std::size_t k = 0; k < count; ++k) x[k] = about[k % 3] + ((flat >> k % 3 & 1) != 0 ? 0 : size * c.number());
}
inline vec3 somewhere(chance& c, float size) {
  if (c.below(2) == 0) return {0, 0, 0};
  const float far = size * c.power(0, 12);
  return {far * c.number(), far * c.number(), far * c.number()};
}

/// How primitives are made of numbers, and what is true of them.
template <class P>
struct about;
template <>
struct about<inner_sphere> {
  static constexpr std::size_t numbers = 4, together = 3;
  static void draw(float* x, vec3 middle, float size, chance& c) {
    draw_near(x, 3, middle, size, c), x[3] = size * std::abs(c.number()) * c.power(-8, 1);
  }
  static inner_sphere make(const float* x) { return {vector_at(x), std::abs(x[3])}; }
  static double distance(const inner_sphere& s, wide q) {
    return reference::length(q - wider<double>(s.center)) - double(s.radius);
  }
  static double distance(const inner_sphere& s, wide from, wide to) {
    const wide c = wider<double>(s.center);
    return reference::length(reference::nearest_of_segment(from - c, to - c)) - double(s.radius);
  }
};
template <>
struct about<triangle> {
  static constexpr std::size_t numbers = 9, together = 1;
  static void draw(float* x, vec3 middle, float size, chance& c) {
    draw_near(x, 9, middle, size, c);
    if (c.below(8) == 0)  // a side about the origin
      for (int k = 0; k < 3; ++k) x[3 + k] = -x[k];
    if (c.below(4) != 0) return;
    const float thin = c.power(-20, -1);  // a needle: one corner near another
    const float* const other = x + 3 * c.below(2);
    for (int k = 0; k < 3; ++k) x[6 + k] = other[k] + thin * size * c.number();
  }
  static triangle make(const float* x) { return triangle::from(vector_at(x), vector_at(x + 3), vector_at(x + 6)); }
  static double distance(const triangle& t, wide q) {
    return reference::to_triangle(q, wider<double>(t.a), wider<double>(t.b), wider<double>(t.c));
  }
  static double distance(const triangle& t, wide from, wide to) {
    return reference::segment_to_triangle(from, to, wider<double>(t.a), wider<double>(t.b), wider<double>(t.c));
  }
};

/// The most units by which `passes` still holds if its argument is lowered. Only powers of two are tried.
template <class Passes>
double units_until(double from, double scale, Passes passes) {
  if (!passes(clearance::rounded_up(from))) return -1;
  for (int k = 1; k <= 32; k *= 2)
    if (!passes(clearance::rounded_up(from - k * scale))) return k;
  return 64;
}

/// A few primitives, and balls around them.
template <class P>
struct pieces {
  static constexpr std::size_t numbers = about<P>::numbers * about<P>::together;

  std::vector<P> all;
  std::vector<ball> balls;
  double size = 0;  ///< From the first ball's middle to the farthest place, and no less than any ball's diameter.
  double far = 0;   ///< The largest coordinate, about.

  void make(const float* x) {
    all.clear(), balls.clear(), size = far = 0;
    for (std::size_t k = 0; k < about<P>::together; ++k) {
      all.push_back(about<P>::make(x + k * about<P>::numbers));
      for (const ball& b : all.back().balls()) balls.push_back(b);
    }
    for (const ball& b : balls) {
      const wide way = wider<double>(b.center) - wider<double>(balls[0].center);
      size = std::max(size, reference::length(way) + double(b.radius) + double(balls[0].radius));
      far = std::max(far, reference::length(wider<double>(b.center)) + double(b.radius));
    }
  }
  double distance(vec3 q) const {
    double least = std::numeric_limits<double>::infinity();
    for (const P& p : all) least = std::min(least, about<P>::distance(p, wider<double>(q)));
    return least;
  }
  real computed(vec3 q) const {
    real least = clearance::infinity;
    for (const P& p : all) least = clearance::min(least, p.distance(q));
    return least;
  }
  static void draw(float* x, float& size, vec3& middle, chance& c) {
    size = c.power(-20, 20), middle = somewhere(c, size);
    for (std::size_t k = 0; k < about<P>::together; ++k) about<P>::draw(x + k * about<P>::numbers, middle, size, c);
  }
};

/// Draws what is asked about: near the content, at it, or far away.
inline void draw_asked(float* x, std::size_t count, const float* content, chance& c) {
  const vec3 start = vector_at(content);
  float size = std::abs(content[3] - content[0]) + std::abs(content[3]) * 0x1p-20f + 1e-12f;
  size *= c.power(-12, 8);
  for (std::size_t k = 0; k < count; ++k) x[k] = size * c.number();
  x[0] += start.x, x[1] += start.y, x[2] += start.z;
}

/// Room of a tangent's lower limit.
inline double below(const clearance::tangent& t, wide e, double computed, double size) {
  const double way = reference::length(e);
  const double least =
      double(t.distance) + reference::dot(wider<double>(t.direction), e) - double(clearance::slack) * way;
  return (computed - least) / (unit * (std::abs(computed) + size + way) + underflow);
}

/// Volumes: the lower bound of what is true (0) and of what is computed (1), what may be within reach (2), the tangent
/// (3), and that a volume which is a ball holds all balls (4).
template <class V, class P>
struct volume_law {
  static constexpr std::size_t content = pieces<P>::numbers, numbers = content + 6;
  using traits = clearance::bounding_volume_traits<V>;

  mutable pieces<P> of;
  mutable V volume;
  mutable std::array<float, content> made = {};

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    float size;
    vec3 middle;
    if (from == 0) pieces<P>::draw(x.data(), size, middle, c);
    draw_asked(x.data() + content, 3, x.data(), c);
    float scale = c.power(-12, 2);
    for (int k = 0; k < 3; ++k) x[content + 3 + k] = scale * (x[content + k] - x[k]) * c.number();
  }
  room operator()(const std::array<float, numbers>& x) const {
    if (of.all.empty() || std::memcmp(made.data(), x.data(), sizeof made) != 0) {
      std::copy_n(x.begin(), content, made.begin());
      of.make(made.data());
      volume = traits::fit(of.balls);
    }
    const vec3 q = vector_at(&x[content]), p = q + vector_at(&x[content + 3]);
    const double exact = of.distance(q), computed = double(of.computed(q)),
                 bound = double(traits::lower_bound(volume, q));
    const double scale = unit * (std::abs(exact) + of.size) + underflow;
    room r;
    r.add((exact - bound) / scale, 0);
    r.add((computed - bound) / scale, 1);
    if constexpr (clearance::rootless_volume<V>)
      r.add(units_until(computed, scale, [&](real reach) { return traits::may_reach(volume, q, reach); }), 2);
    if constexpr (clearance::tangent_volume<V>)
      r.add(below(traits::tangent_at(volume, q), wider<double>(p) - wider<double>(q), double(of.computed(p)), of.size),
            3);
    if constexpr (clearance::round_volume<V>) {
      const ball around = traits::as_ball(volume);
      for (const ball& b : of.balls) {
        const double away = reference::length(wider<double>(b.center) - wider<double>(around.center));
        r.add((double(around.radius) - away - double(b.radius)) / (unit * of.size + underflow), 4);
      }
    }
    return r;
  }
};

/// Primitives: the distance (0), its quick bound (1), what may be within reach (2), the tangent below (3) and above
/// (4), the ball (5), and that the nearest place is on it (6) and as far as it is said (7).
template <class P>
struct primitive_law {
  static constexpr std::size_t content = about<P>::numbers, numbers = content + 6;
  static constexpr double leaf_units = 5;  ///< See frames::unit_error.

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    const float size = c.power(-20, 20);
    if (from == 0) about<P>::draw(x.data(), somewhere(c, size), size, c);
    draw_asked(x.data() + content, 3, x.data(), c);
    const float scale = c.power(-12, 2);
    for (int k = 0; k < 3; ++k) x[content + 3 + k] = scale * (x[content + k] - x[k]) * c.number();
  }
  room operator()(const std::array<float, numbers>& x) const {
    const P one = about<P>::make(x.data());
    const vec3 q = vector_at(&x[content]), p = q + vector_at(&x[content + 3]);
    const double exact = about<P>::distance(one, wider<double>(q)), computed = double(one.distance(q));
    double size = 0, far = 0;
    for (const ball& b : one.balls()) {
      size =
          std::max(size, reference::length(wider<double>(b.center) - wider<double>(one.balls()[0].center)) + b.radius);
      far = std::max(far, reference::length(wider<double>(b.center)) + b.radius);
    }
    const double whole = unit * (reference::length(wider<double>(q)) + far) + underflow;
    const double scale = unit * (std::abs(exact) + size) + underflow;
    room r;
    r.add(leaf_units - std::abs(computed - exact) / whole, 0);
    if constexpr (clearance::bounded_primitive<P>) r.add((computed - double(one.lower_bound(q))) / scale, 1);
    if constexpr (requires { one.may_reach(q, 1.0f); })
      r.add(units_until(computed, scale, [&](real reach) { return one.may_reach(q, reach); }), 2);
    const clearance::primitive_tangent t = one.tangent_at(q);
    const wide e = wider<double>(p) - wider<double>(q);
    const double there = double(one.distance(p)), way = reference::length(e);
    r.add(below(t, e, there, size), 3);
    double most = double(t.most) + way;
    if (t.radius > 0)
      most = std::min(
          most, double(t.most) + reference::dot(wider<double>(t.direction), e) + way * way / (2 * double(t.radius)));
    r.add((most + double(clearance::slack) * way - there) / (unit * (std::abs(there) + size + way) + underflow), 4);
    if constexpr (requires { one.as_ball(); }) {
      const ball around = one.as_ball();
      for (const ball& b : one.balls()) {
        const double away = reference::length(wider<double>(b.center) - wider<double>(around.center));
        r.add((double(around.radius) - away) / (unit * (size + far) + underflow), 5);
      }
    }
    const wide place = wider<double>(one.nearest(q));
    const double off = about<P>::distance(one, place), said = reference::length(wider<double>(q) - place);
    r.add(16 - std::abs(off) / whole, 6);
    r.add(16 - std::abs(said - std::abs(exact)) / whole, 7);
    return r;
  }
};

/// Capsules: the nearest place along the way (0), the volume's bound (1), the primitive's quick test (2), and the tests
/// of a ball around it: by differences (3), and as the scan does it (4).
template <class V, class P>
struct capsule_law {
  static constexpr std::size_t content = about<P>::numbers, numbers = content + 7;
  using traits = clearance::bounding_volume_traits<V>;

  mutable std::array<float, content> made = {};
  mutable P one;
  mutable V volume;
  mutable ball around;
  mutable double far = -1;

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    const float size = c.power(-20, 20);
    if (from == 0) about<P>::draw(x.data(), somewhere(c, size), size, c);
    draw_asked(x.data() + content, 3, x.data(), c);
    float way[6] = {};
    std::copy_n(x.data() + content, 3, way);
    draw_asked(way + 3, 3, x.data(), c);
    for (int k = 0; k < 3; ++k) x[content + 3 + k] = c.below(16) == 0 ? 0 : (way[3 + k] - way[k]) * c.power(-8, 1);
    x[content + 6] = std::abs(c.number()) * size * c.power(-12, 0) * float(c.below(2));
  }
  room operator()(const std::array<float, numbers>& x) const {
    if (far < 0 || std::memcmp(made.data(), x.data(), sizeof made) != 0) {
      std::copy_n(x.begin(), content, made.begin());
      one = about<P>::make(made.data());
      const auto its = one.balls();
      volume = traits::fit(its), around = clearance::enclosing_ball(its), far = 0;
      for (const ball& b : its) far = std::max(far, reference::length(wider<double>(b.center)) + b.radius);
    }
    const capsule c{vector_at(&x[content]), vector_at(&x[content + 3]), std::abs(x[content + 6])};
    const wide from = wider<double>(c.from), along = wider<double>(c.along);
    const double exact = about<P>::distance(one, from, from + along) - double(c.radius);
    const real computed = clearance::distance_to(one, c);
    const double scale =
        unit * (reference::length(from) + reference::length(along) + far + double(c.radius)) + underflow;
    room r;
    r.add(16 - std::abs(double(computed) - exact) / scale, 0);
    r.add((double(computed) - double(clearance::lower_bound(volume, c, computed))) / scale, 1);
    r.require(clearance::may_reach(one, c, computed), 2);
    r.add(units_until(computed, scale, [&](real reach) { return clearance::frames::may_reach(around, reach, c); }), 3);
    const clearance::frames::capsule_test quick(c);
    const auto scans = [&](real reach) {  // as scan::limit_for
      const real limit = clearance::max(clearance::frames::limit(around, reach), 0);
      return clearance::frames::root_test(clearance::frames::root_ball(around), limit).passes(quick);
    };
    r.add(units_until(computed, scale, scans), 4);
    return r;
  }
};

/// The tests of a part's ball in the cloud's frame, which is larger as frames::place makes it: by differences (0), and
/// by the root test (1).
struct ball_law {
  static constexpr std::size_t content = 4, numbers = 7;

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    const float size = c.power(-20, 20);
    if (from == 0) about<inner_sphere>::draw(x.data(), somewhere(c, size), size, c);
    draw_asked(x.data() + 4, 3, x.data(), c);
  }
  room operator()(const std::array<float, numbers>& x) const {
    const inner_sphere s = about<inner_sphere>::make(x.data());
    const double extent = reference::length(wider<double>(s.center)) + double(s.radius);
    const ball around{s.center,
                      clearance::rounded_up(double(s.radius) + 2 * clearance::frames::arithmetic_error(extent))};
    const vec3 q = vector_at(&x[4]);
    const double computed = double(s.distance(q)), scale = unit * (std::abs(computed) + extent) + underflow;
    room r;
    r.add(units_until(computed, scale, [&](real reach) { return clearance::frames::may_reach(around, reach, q); }), 0);
    r.add(
        units_until(computed, scale, [&](real reach) { return clearance::frames::root_test(around, reach).passes(q); }),
        1);
    return r;
  }
};

/// The bracket of a distance, from poses in double and a point in floats to the end: its lower (0) and upper end (1).
/// Where a part's ball is tested, it contains what is within reach (2).
template <class P>
struct bracket_law {
  static constexpr std::size_t content = about<P>::numbers, numbers = content + 3 + 14;

  void draw(std::array<float, numbers>& x, std::size_t from, chance& c) const {
    const float size = c.power(-12, 8);
    if (from == 0) about<P>::draw(x.data(), somewhere(c, size), size, c);
    float* const pose = x.data() + content + 3;
    const float away = size * c.power(-8, 16);
    for (int k = 0; k < 14; ++k) pose[k] = (k % 7 < 4 ? 1 : away) * c.number();
    if (c.below(4) == 0) std::copy_n(pose, 7, pose + 7);
    draw_asked(x.data() + content, 3, x.data(), c);
    if (c.below(2) == 0) return;
    // Near the part, wherever it is: the cloud's own coordinates of a place that is drawn in the part's frame.
    const auto p = (pose_of(pose + 7).inverse() * pose_of(pose)) *
                   Eigen::Vector3d(double(x[content]), double(x[content + 1]), double(x[content + 2]));
    for (int k = 0; k < 3; ++k) x[content + std::size_t(k)] = float(p[k]);
  }
  static Eigen::Isometry3d pose_of(const float* x) {
    Eigen::Quaterniond turn{double(x[0]), double(x[1]), double(x[2]), double(x[3])};
    if (!(turn.squaredNorm() > 1e-20)) turn = Eigen::Quaterniond::Identity();
    Eigen::Isometry3d pose(turn.normalized());
    pose.translation() << double(x[4]), double(x[5]), double(x[6]);
    return pose;
  }
  /// The point in the part's frame, in long double.
  static reference::vec<long double> moved(const Eigen::Isometry3d& part, const Eigen::Isometry3d& cloud, vec3 p) {
    using L = long double;
    const reference::vec<L> at = wider<L>(p);
    L d[3], q[3] = {};
    for (int r = 0; r < 3; ++r)
      d[r] = L(cloud(r, 0)) * at.x + L(cloud(r, 1)) * at.y + L(cloud(r, 2)) * at.z + L(cloud(r, 3)) - L(part(r, 3));
    for (int k = 0; k < 3; ++k)
      for (int r = 0; r < 3; ++r) q[k] += L(part(r, k)) * d[r];
    return {q[0], q[1], q[2]};
  }
  room operator()(const std::array<float, numbers>& x) const {
    const P one = about<P>::make(x.data());
    const auto its = one.balls();
    const ball around = clearance::enclosing_ball(its);
    const clearance::part_facts facts{around.center, around.radius, 0, 0};
    const vec3 p = vector_at(&x[content]);
    const Eigen::Isometry3d part = pose_of(&x[content + 3]), cloud = pose_of(&x[content + 10]);
    const clearance::frames::cloud_frame frame(std::span(&facts, 1), std::span(&part, 1), cloud);
    const auto& place = frame.places[0];
    const vec3 q = place.part_from_cloud(p - frame.origin);
    const auto true_q = moved(part, cloud, p);
    const double exact = double(about<P>::distance(one, wide{double(true_q.x), double(true_q.y), double(true_q.z)}));
    const real computed = one.distance(q);
    const double error = frame.error.at(computed);
    const double scale = unit * (double(reference::length(true_q)) +
                                 reference::length(wider<double>(place.part_from_cloud.translation)) +
                                 reference::length(wider<double>(around.center)) + double(around.radius)) +
                         underflow;
    room r;
    if (!(error < std::numeric_limits<double>::infinity())) return r;
    r.add((exact - clearance::frames::certain_distance(computed, 0, frame.error)) / scale, 0);
    r.add((double(computed) + error - exact) / scale, 1);
    r.add(units_until(computed, scale,
                      [&](real reach) { return clearance::frames::may_reach(place.around, reach, p - frame.origin); }),
          2);
    return r;
  }
};

}  // namespace bounds
