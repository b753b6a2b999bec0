// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A chain of links of spheres, and what a loop over all pairs of spheres says of two of them.

#include "support/oracle.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

#include <clearance/make_model.hpp>
#include <clearance/self_distance.hpp>
#include <clearance/volume/sphere.hpp>

namespace testing {

using oracle::wide, oracle::wider;

/// Five links of spheres, each `spread` away from the one before. Each link's spheres fill something to within its gap.
struct chain_of_spheres {
  std::vector<std::vector<inner_sphere>> links;
  std::vector<double> gaps;
  double spread;

  chain_of_spheres(dice& d, double gap, double spread) : spread(spread) {
    for (int k = 0; k < 5; ++k) {
      links.push_back(random_spheres(d, k == 2 ? 1 : 20 + 5 * std::size_t(k), 0.15, 0.06));
      gaps.push_back(gap * (1 + k));
    }
  }

  std::vector<std::uint32_t> parents() const {
    std::vector<std::uint32_t> all;
    for (std::uint32_t k = 0; k < links.size(); ++k) all.push_back(k == 0 ? clearance::none : k - 1);
    return all;
  }
  auto model() const {
    std::vector<clearance::part<clearance::bvh<clearance::sphere, inner_sphere>>> parts;
    for (std::size_t k = 0; k < links.size(); ++k)
      parts.push_back(clearance::make_part(clearance::build<clearance::sphere>(links[k]), gaps[k]));
    return clearance::model(std::move(parts));
  }
  std::vector<Eigen::Isometry3d> poses(dice& d) const {
    std::vector<Eigen::Isometry3d> all{d.pose(0.1)};
    while (all.size() < links.size()) {
      Eigen::Isometry3d next = d.pose(0);
      next.translation() << spread * d.uniform(0.3, 1), 0, 0;
      all.push_back(all.back() * next);
    }
    return all;
  }
};

/// The least distance of spheres of two links in long double.
inline wide between_links(const std::vector<inner_sphere>& a, const Eigen::Isometry3d& pose_a,
                          const std::vector<inner_sphere>& b, const Eigen::Isometry3d& pose_b) {
  wide least = clearance::infinity;
  for (const inner_sphere& x : a)
    for (const inner_sphere& y : b)
      least = std::min(least, oracle::between(oracle::moved(pose_a.matrix(), wider(x.center)),
                                              oracle::moved(pose_b.matrix(), wider(y.center))) -
                                  x.radius - y.radius);
  return least;
}

struct least_pair {
  wide distance;
  std::uint32_t a, b;
};
inline least_pair least_of(const chain_of_spheres& one, const std::vector<Eigen::Isometry3d>& poses,
                           const chain_of_spheres& other, const std::vector<Eigen::Isometry3d>& there) {
  least_pair least{clearance::infinity, 0, 0};
  for (std::uint32_t a = 0; a < one.links.size(); ++a)
    for (std::uint32_t b = 0; b < other.links.size(); ++b)
      if (const wide its = between_links(one.links[a], poses[a], other.links[b], there[b]); its < least.distance)
        least = {its, a, b};
  return least;
}

inline bool same_pair(const clearance::pair_clearance& x, const clearance::pair_clearance& y) {
  const auto same = [](clearance::position p, clearance::position q) { return p.x == q.x && p.y == q.y && p.z == q.z; };
  return x.a == y.a && x.b == y.b && x.distance == y.distance && x.lower == y.lower && x.sphere_a == y.sphere_a &&
         x.sphere_b == y.sphere_b && x.normal == y.normal && same(x.at_a, y.at_a) && same(x.at_b, y.at_b);
}
inline bool same_self(const clearance::self_distance_result& x, const clearance::self_distance_result& y) {
  return same_pair(x, y) && x.state == y.state && x.upper == y.upper && std::ranges::equal(x.pairs, y.pairs, same_pair);
}

/// The answer about a robot itself, by all pairs of spheres.
template <class Verdict>
void check_itself(const chain_of_spheres& robot, const std::vector<Eigen::Isometry3d>& poses,
                  const clearance::part_pairs& pairs, const clearance::self_distance_result& r, Verdict& v) {
  const auto sphere_of = [&](std::uint32_t link, std::uint32_t number) { return robot.links.at(link).at(number); };
  wide least = clearance::infinity, lower = clearance::infinity;
  std::size_t n = 0;
  const auto check_places = [&](const clearance::pair_clearance& its) {
    const Eigen::Vector3d at_a(its.at_a.x, its.at_a.y, its.at_a.z), at_b(its.at_b.x, its.at_b.y, its.at_b.z),
        normal(its.normal.x, its.normal.y, its.normal.z);
    v.require((at_a - at_b - double(its.distance) * normal).norm() < 1e-5, "the places are as far apart");
    const auto off = [](const clearance::inner_sphere& s, const Eigen::Isometry3d& pose, const Eigen::Vector3d& at) {
      return (at - pose * Eigen::Vector3d(s.center.x, s.center.y, s.center.z)).norm() - double(s.radius);
    };
    v.require(std::abs(off(sphere_of(its.a, its.sphere_a), poses[its.a], at_a)) < 1e-5 &&
                  std::abs(off(sphere_of(its.b, its.sphere_b), poses[its.b], at_b)) < 1e-5,
              "and on their spheres");
  };
  for (std::uint32_t a = 0; a < robot.links.size(); ++a)
    for (const std::uint32_t b : pairs.above(a)) {
      const clearance::pair_clearance& its = r.pairs.at(n++);
      const wide is = between_links(robot.links[a], poses[a], robot.links[b], poses[b]);
      v.require(its.a == a && its.b == b && std::abs(its.distance - is) < 1e-5, "links", a, " and", b, " are", is,
                " apart, and not", its.distance);
      const wide named = between_links({sphere_of(a, its.sphere_a)}, poses[a], {sphere_of(b, its.sphere_b)}, poses[b]);
      v.require(std::abs(named - is) < 1e-5, "their spheres");
      check_places(its);
      const wide certain = is - robot.gaps[a] - robot.gaps[b];
      v.require(its.lower <= std::max(certain, wide(0)) && its.lower > certain - 1e-5, "at least", its.lower,
                " and not", certain);
      least = std::min(least, is);
      lower = std::min(lower, certain);
    }
  v.require(n == r.pairs.size(), n, " pairs");
  v.require(std::abs(r.distance - least) < 1e-5, "the least is", least, " and not", r.distance);
  v.require(r.lower <= std::max(lower, wide(0)) && r.lower > lower - 1e-5, "at least", r.lower, " and not", lower);
  v.require(r.upper >= std::max(least, wide(0)) && r.upper < std::max(least, wide(0)) + 1e-5, "at most", r.upper);
  if (n != 0) check_places(r);
}

}  // namespace testing
