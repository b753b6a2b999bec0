// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots and clouds of extreme numbers: parts, spheres in one part, points, metres between them.

#include "support/product.hpp"

#include <clearance/volume/sphere.hpp>

#include <cfloat>

namespace testing {

/// Spheres of the largest part. Sanitizers take ten times as long.
#if defined(CLEARANCE_SANITIZED)
inline constexpr std::size_t very_many = 4000;
#else
inline constexpr std::size_t very_many = 100000;
#endif

/// Parts around the origin, about a metre across together.
inline void add_robot(scene<inner_sphere>& s, dice& d, int parts, int spheres,
                      const Eigen::Isometry3d& at = shifted(0, 0, 0)) {
  for (int k = 0; k < parts; ++k) {
    s.parts.push_back(random_spheres(d, std::size_t(spheres), 0.15, 0.05));
    s.poses.push_back(at * d.pose(0.4));
  }
}
inline void add_points(scene<inner_sphere>& s, dice& d, std::size_t n, double half, vec3 center = {0, 0, 0}) {
  const auto more = d.points(n, half, center);
  s.points.insert(s.points.end(), more.begin(), more.end());
}

inline constexpr const char* deep_scene = "a tree as deep as trees become";

/// Split rule: most go with those nearest the origin. Of `very_many` in leaves of 4 it makes a tree as deep as may be,
/// whose stack is full: depth 9 of width 8, and (without sanitizers) 63 of width 2.
struct lopsided_split {
  double share = very_many == 100000 ? 0.86 : 0.9;

  std::size_t operator()(std::span<clearance::split_item> items) const {
    const auto near = std::clamp<std::size_t>(std::size_t(double(items.size()) * share), 1, items.size() - 1);
    const auto away = [](const auto& i) { return std::pair(i.center().squaredNorm(), i.id); };
    std::ranges::nth_element(items, items.begin() + std::ptrdiff_t(near), {}, away);
    return near;
  }
};

/// Spheres ever smaller towards the origin, on a spiral.
inline std::vector<inner_sphere> towards_the_origin(std::size_t n) {
  std::vector<inner_sphere> all;
  for (std::size_t k = 0; k < n; ++k) {
    const double away = std::exp(-60.0 * double(k) / double(n)), turn = 0.7 * double(k);
    all.push_back({{real(away * std::cos(turn)), real(away * std::sin(turn)), real(away * std::cos(0.37 * turn))},
                   real(away * 0.01)});
  }
  return all;
}
/// All equally far from the origin, but for rounding: of a point there no bound prunes anything.
inline std::vector<inner_sphere> shell(dice& d, std::size_t n) {
  std::vector<inner_sphere> all;
  for (std::size_t k = 0; k < n; ++k) all.push_back({d.direction(), 0.01f});
  return all;
}

/// Every number that is no coordinate, and those that are only just one.
inline std::vector<vec3> strange_points() {
  const real odd[] = {clearance::not_a_number,
                      clearance::infinity,
                      -clearance::infinity,
                      1e30f,
                      -1e30f,
                      FLT_MAX,
                      1.001e18f,
                      -1.001e18f,
                      1e18f,
                      -1e18f,
                      FLT_TRUE_MIN,
                      -FLT_TRUE_MIN,
                      FLT_MIN,
                      -0.0f};
  std::vector<vec3> all;
  for (const real a : odd)
    for (const real b : {0.5f, a})
      for (const vec3 p : {vec3{a, b, 0.25f}, vec3{0.25f, a, b}, vec3{b, 0.25f, a}}) all.push_back(p);
  return all;
}

inline std::vector<scene<inner_sphere>> edge_scenes() {
  dice d(77);
  std::vector<scene<inner_sphere>> all;
  const auto start = [&](const std::string& name) -> scene<inner_sphere>& {
    all.push_back({name, {}, {}, {}});
    return all.back();
  };
  for (const double apart : {20.0, 1000.0})
    for (const bool in_turn : {false, true}) {  // the robots' parts one after another, or alternating
      auto& s = start("two robots " + std::to_string(int(apart)) + " m apart" + (in_turn ? ", parts in turn" : ""));
      for (int k = 0; k < 14; ++k) add_robot(s, d, 1, 40, shifted((in_turn ? k % 2 : k / 7) * apart, 0, 0));
      add_points(s, d, 3000, 2);
      add_points(s, d, 3000, 2, {real(apart), 0, 0});
      add_points(s, d, 500, apart);
      if (in_turn) s.cloud_pose = d.pose(1), s.points.resize(3000);  // and one of the robots sees nothing
    }
  for (const int parts : {64, 128, 129})
    for (const std::size_t points : {1, 31, 33, 4099}) {
      auto& s = start(std::to_string(parts) + " parts, " + std::to_string(points) + " points");
      add_robot(s, d, parts, 9);
      add_points(s, d, points, 1.5);
      s.cloud_pose = d.pose(0.1);
    }
  {
    auto& s = start("millimetres taken for metres");
    add_robot(s, d, 7, 40);
    for (vec3 p : d.points(5000, 1.5)) s.points.push_back(clearance::scaled(1000, p + vec3{2, 0, 0}));
    s.cloud_pose = d.pose(1);
  }
  for (const int zeros : {3, 6, 12, 18}) {
    const double off = std::pow(10.0, zeros);
    auto& s = start("a robot 1e" + std::to_string(zeros) + " m off");
    add_robot(s, d, 7, 40, shifted(-0.6 * off, 0.8 * off, 0));
    add_points(s, d, 5000, 2);
    s.cloud_pose = d.pose(1);
  }
  {
    auto& s = start("strange points among good ones");
    add_robot(s, d, 7, 40);
    s.points = strange_points();
    add_points(s, d, 5000, 2);
  }
  {
    auto& s = start("strange points alone");
    add_robot(s, d, 3, 40);
    while (s.points.size() < 3000)
      for (const vec3 p : strange_points()) s.points.push_back(p);
    s.poses = {shifted(3, 0, 0), shifted(0, 3, 0), shifted(0, 0, 3)};
  }
  {
    auto& s = start("points that are only just finite");
    add_robot(s, d, 3, 40);
    for (int k = 0; k < 3000; ++k)
      s.points.push_back({k % 2 ? 1e18f : -1e18f, k % 3 ? 1e18f : real(k) * 1e14f, -1e18f});
  }
  {
    auto& s = start("no valid point");
    add_robot(s, d, 64, 9);
    s.points.assign(5000, {0, clearance::not_a_number, 0});
  }
  {
    auto& s = start("every point inside");
    s.parts = {{{{0, 0, 0}, 2}, {{0.5f, 0, 0}, 1.5f}, {{0.1f, 0, 0}, 0.1f}}, {{{0, 0, 0}, 3}}};
    s.poses = {d.pose(0.1), d.pose(0.1)};
    add_points(s, d, 5000, 0.7);
  }
  {
    auto& s = start("spheres too small to be normal numbers");
    for (int k = 0; k < 2; ++k) {
      s.parts.emplace_back();
      for (int i = 0; i < 30; ++i) s.parts[k].push_back({d.point(1e-38), 1e-41f});
      s.poses.push_back(shifted(k * 1e-38, 0, 0));
    }
    add_points(s, d, 500, 1e-38);
    for (vec3& p : s.points) p.x += 5e-38f;
    add_points(s, d, 500, 1, {2, 0, 0});
  }
  {
    auto& s = start("parts of one sphere, and of very many");
    s.parts = {random_spheres(d, 1, 0.3), random_spheres(d, very_many, 0.3, 0.01), random_spheres(d, 1, 0.3)};
    s.poses = {shifted(0, 0, 0.4), d.pose(0.1), shifted(0.5, 0, 0)};
    add_points(s, d, 60, 1);
  }
  {
    auto& s = start(deep_scene);
    s.parts = {towards_the_origin(very_many), random_spheres(d, 1, 0.3)};
    s.poses = {shifted(0, 0, 0), shifted(3, 0, 0)};
    for (const double half : {1e-25, 1e-10, 1e-3, 0.1, 1.0}) add_points(s, d, 12, half);
  }
  {
    auto& s = start("nothing to prune");
    s.parts = {shell(d, very_many)};
    s.poses = {shifted(0, 0, 0)};
    s.points.assign(10, {0, 0, 0});
    add_points(s, d, 20, 1e-4);
  }
  return all;
}

/// Large parts get the fit that builds fast.
template <class V = clearance::sphere>
auto edge_model(const scene<inner_sphere>& s, const clearance::build_options& options = {}) {
  std::vector<clearance::part<clearance::bvh<V, inner_sphere>>> parts;
  for (const auto& p : s.parts) {
    if (s.name == deep_scene)
      parts.push_back(clearance::make_part(clearance::build<V>(p, options, clearance::layered{}, lopsided_split{})));
    else if (p.size() > 1000)
      parts.push_back(clearance::make_part(clearance::build<V>(p, options, clearance::layered{})));
    else
      parts.push_back(clearance::make_part(clearance::build<V>(p, options)));
  }
  return clearance::model(std::move(parts));
}

/// A cloud of any size that takes no memory, the same on host and device in every bit. x is 3 m and more; every 1024th
/// is no point; and one, `planted`, is nearer than all others to what is near the origin.
struct endless_points {
  CLEARANCE_HD static constexpr vec3 near() { return {1.5f, 0.125f, -0.25f}; }

  std::size_t count;
  std::size_t planted = ~std::size_t(0);

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD clearance::sample operator[](std::size_t i) const {
    if (i == planted) return {near()};
    if (i % 1024 == 7) return {{clearance::not_a_number, 0, 0}, clearance::drop_reason::not_finite};
    std::uint32_t h = std::uint32_t(i) * 2654435761u;
    h ^= h >> 15;
    h *= 2246822519u;
    const auto step = [](std::uint32_t bits) { return real(bits & 1023u) * 0.0625f; };
    return {{3 + step(h), step(h >> 10) - 32, step(h >> 20) - 32}};
  }
  std::uint64_t valid() const { return count - (count + 1016) / 1024 + (planted % 1024 == 7 ? 1 : 0); }
};
static_assert(clearance::point_source<endless_points>);

/// Three small parts within a metre of the origin: each of endless_points but the planted one is 2 m and more away.
inline scene<inner_sphere> small_robot() {
  dice d(78);
  scene<inner_sphere> s{"small",
                        {random_spheres(d, 5, 0.2), random_spheres(d, 1, 0.2), random_spheres(d, 8, 0.2)},
                        {},
                        {endless_points::near()}};
  s.poses = {d.pose(0.3), d.pose(0.3), d.pose(0.3)};
  return s;
}

}  // namespace testing
