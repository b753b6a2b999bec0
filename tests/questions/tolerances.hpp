// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots whose parts have gaps and tolerances of their own, and one rule in every question: from each part's distance
// its own are taken.

#include "support/chunked.hpp"
#include "support/closed.hpp"
#include "support/laws.hpp"
#include "support/same_result.hpp"

#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/volume/obb.hpp>

namespace testing {

/// A part with a gap and a tolerance of its own; of a few robots none has any.
template <class Part>
Part with_slop(dice& d, Part part, bool any) {
  if (any) {
    const double gap = d.below(2) == 0 ? 0 : d.uniform(0, 0.2), tolerance = d.below(3) == 0 ? 0 : d.uniform(0, 0.1);
    part.facts.gap = real(gap), part.facts.tolerance = real(tolerance);
  }
  return part;
}

template <class V>
auto sloppy_spheres(dice& d, bool any) {
  std::vector<clearance::part<clearance::bvh<V, inner_sphere>>> parts;
  for (unsigned k = 2 + d.below(4); k-- > 0;)
    parts.push_back(with_slop(d, clearance::make_part(clearance::build<V>(random_spheres(d, 12, 0.2))), any));
  return clearance::model(std::move(parts));
}
/// Solids, which know their inside.
inline auto sloppy_solids(dice& d, bool any) {
  const auto ball = clearance::close_mesh(shapes::globe({0, 0, 0}, 0.2));
  const auto box = clearance::close_mesh(shapes::box({-0.1, -0.2, -0.2}, {0.1, 0.2, 0.3}));
  std::vector<decltype(clearance::make_part<clearance::obb>(ball))> parts;
  for (unsigned k = 2 + d.below(3); k-- > 0;)
    parts.push_back(with_slop(d, clearance::make_part<clearance::obb>(k % 2 == 0 ? ball : box), any));
  return clearance::model(std::move(parts));
}

inline std::vector<Eigen::Isometry3d> some_poses(dice& d, std::size_t parts) {
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t k = 0; k < parts; ++k) poses.push_back(d.pose(0.5));
  return poses;
}

/// Counts how often another part than the nearest decides.
struct rule_of_slop {
  verdict v = {};
  std::size_t other = 0;

  /// Every least distance, in every form, against that of each part.
  template <class On, class Model>
  void least(const On& on, const Model& model, dice& d, bool any, const std::string& what) {
    const auto there = model.on(on);
    const std::size_t parts = model.view().size();
    const auto poses = some_poses(d, parts);
    std::vector<vec3> points;
    for (vec3& p : d.points(d.below(2) == 0 ? 9000 : 60, 1.0)) {
      const real away = d.below(30) == 0 ? d.number(0.5, 1.6) : d.number(1, 1.6);
      points.push_back(clearance::scaled(away / std::max(0.1f, clearance::length(p)), p));
    }
    const clearance::point_span cloud(points);
    const auto each = ask(clearance::host{}, model, poses, cloud, clearance::min_distance_per_part{});
    double lower = infinity;
    for (std::size_t k = 0; k < parts; ++k)
      lower = std::min(lower, double(each.parts[k].distance) - clearance::frames::slop(model.view().facts[k]));
    const auto& all = each.all;
    v.require(std::abs(double(all.lower) - std::max(lower, 0.0)) < 1e-5, what, ": each part's own is not taken");
    other += any && all.lower > 0 &&
             double(all.lower) < double(all.distance) - clearance::frames::slop(model.view().facts[all.part]) - 1e-4;
    const auto same = [&](const clearance::min_distance_result& r, const char* form) {
      v.require(same_result(r, all), what, ", ", form, ": at least", r.lower, ", and not", all.lower);
    };
    clearance::query query(on, there, clearance::min_distance{});
    same(query(poses, cloud), "min_distance");
    same(query(poses, cloud), "again");
    same(ask_by(query, poses, cloud, std::chrono::hours(1), clearance::min_distance{}, {.piece = 700}).result,
         "in pieces");
    clearance::chunked chunks(cloud, 4096);
    clearance::chunked_query in_chunks(on, there, clearance::min_distance{});
    for (int round = 0; round < 3; ++round) same(in_chunks(poses, chunks), "in chunks");
    std::vector<Eigen::Isometry3d> many = poses;
    many.insert(many.end(), poses.begin(), poses.end());
    clearance::query plan(on, there, clearance::min_distances{});
    const auto plans = [&](auto& asks, const auto& source, const clearance::min_distance_result& expected,
                           const char* form) {
      const double least = double(expected.distance);
      for (const double d_max : {double(infinity), least + 0.1 * std::abs(least), least}) {
        const auto r = asks(many, source, clearance::min_distances{d_max});
        v.require(same_result(r.of[0], expected) && same_result(r.of[1], expected), what, ", ", form, " within", d_max,
                  ": at least", r.of[1].lower, ", and not", expected.lower);
      }
      if (!(least > 0)) return;
      const auto none_near = asks(many, source, clearance::min_distances{0.95 * least}).of[1];
      v.require(none_near.part == clearance::none && none_near.lower <= expected.lower, what, ", ", form,
                ": a witness beyond d_max, or at least", none_near.lower, ", and not", expected.lower);
    };
    plans(plan, cloud, all, "min_distances");
    const auto fielded = clearance::with_fields(on, model, {1 << 16}).model.on(on);
    clearance::query by_fields(on, fielded, clearance::min_distances{});
    plans(by_fields, cloud, all, "min_distances by fields");
    const clearance::uncertain balls(cloud, clearance::lidar_noise{0.01f});
    const auto of_balls = ask(clearance::host{}, model, poses, balls, clearance::min_distance_per_part{}).all;
    if constexpr (std::is_same_v<On, clearance::host>) {
      v.require(same_result(ask(on, there, poses, balls, clearance::min_distance{}), of_balls), what, ": balls");
      plans(plan, balls, of_balls, "min_distances of balls");
    }
    // A radius is a tolerance.
    std::vector<double> radii;
    for (std::size_t k = 0; k < parts; ++k) radii.push_back(any ? d.uniform(0, 0.1) : 0.05);
    double wide = infinity;
    for (std::size_t k = 0; k < parts; ++k)
      wide = std::min(wide, double(each.parts[k].distance) - clearance::frames::slop(model.view().facts[k]) - radii[k]);
    const auto by_radii = plan(many, cloud, clearance::min_distances{infinity, radii}).of[1];
    v.require(std::abs(double(by_radii.lower) - std::max(wide, 0.0)) < 1e-5, what, ": radii of parts");
  }
};

}  // namespace testing
