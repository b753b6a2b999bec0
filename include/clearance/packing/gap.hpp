// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/cells.hpp>
#include <clearance/packing/sphere_field.hpp>

namespace clearance {

struct gap_report {
  double certified = 0;        ///< No point of the solid, surface and interior, is farther from the spheres. Metres.
  double mean = 0, p95 = 0;    ///< Over the surface, from samples.
};

/// One branch of the search: cubes are divided until none can hold a point of the solid with a larger gap than `least`
/// (grown by the tolerance), for the gap changes by no more than the way from the cube's middle. Spheres that cannot be
/// the nearest to any point of a cube are left out below it.
template <solid S>
class gap_search {
 public:
  gap_search(const S& s, const sphere_field& spheres, double least, double relative, double absolute)
      : solid_(s), spheres_(spheres), least_(least), relative_(relative), absolute_(absolute) {}

  /// An upper bound of the gap over the solid's points in the cell; infinite if that takes more than `visits` cubes, of
  /// which each costs one.
  double operator()(const solid_cell& root, std::size_t visits) {
    left_ = visits;
    std::vector<std::uint32_t> near(spheres_.size());
    for (std::uint32_t i = 0; i < near.size(); ++i) near[i] = i;
    visit(root, near);
    return left_ == 0 ? std::numeric_limits<double>::infinity() : upper_;
  }

 private:
  void visit(const solid_cell& cell, const std::vector<std::uint32_t>& near) {
    const double reach = cell.reach();
    if (left_ == 0 || --left_ == 0) return;
    if (cell.depth < -reach * (1 + 1e-12)) return;  // no point of the solid here
    double gap = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : near) gap = std::min(gap, spheres_[i].distance(cell.middle));
    if (cell.depth >= 0) least_ = std::max(least_, gap);
    const double bound = gap + reach, slack = std::max(least_ * relative_, absolute_);
    // The solid is less than `reach` away from the middle, so a small cell is too high by twice its reach at most.
    if (bound <= std::max(least_ + slack, upper_) || 4 * reach <= slack) {
      upper_ = std::max(upper_, bound);
      return;
    }
    std::vector<std::uint32_t> nearer;
    for (const std::uint32_t i : near)
      if (spheres_[i].distance(cell.middle) <= gap + 2.0000001 * reach) nearer.push_back(i);
    for (int k = 0; k < 8; ++k) visit(eighth(solid_, cell, k), nearer);
  }

  const S& solid_;
  const sphere_field& spheres_;
  double least_, relative_, absolute_, upper_ = 0;
  std::size_t left_ = 0;
};

/// The largest distance from any point of the solid to the nearest sphere, 0 if they cover it: a proven upper bound, by
/// branch and bound in double rounded up, at most `tolerance` (relative) or 10 um or 1e-5 of the solid above the truth;
/// more only where the search would take too long.
template <solid S>
gap_report measure_gap(const S& s, const sphere_field& spheres, double tolerance = 0.01) {
  gap_report report;
  const double diagonal = s.bounds().diagonal().norm();
  if (spheres.size() == 0) {
    report.certified = report.mean = report.p95 = std::numeric_limits<double>::infinity();
    return report;
  }
  // Any gap that is met bounds the largest from below; the better that bound, the less is searched.
  double least = 0;
  const auto gap = [&](const Eigen::Vector3d& p) {
    return std::max(0.0, spheres.distance(p, std::numeric_limits<double>::infinity()));
  };
  if constexpr (requires { s.corners(); })
    for (const auto& p : s.corners()) least = std::max(least, gap(p));
  if constexpr (requires { s.surface_points(std::size_t(1)); }) {
    std::vector<double> gaps;
    for (const auto& p : s.surface_points(20000)) gaps.push_back(gap(p));
    for (const double g : gaps) report.mean += g / double(gaps.size()), least = std::max(least, g);
    const auto at = gaps.begin() + std::ptrdiff_t(gaps.size() * 95 / 100);
    std::nth_element(gaps.begin(), at, gaps.end());
    report.p95 = *at;
  }
  // Finer and finer by a quarter, until it is as fine as asked or takes too long: the gap of a ball in a ball, say, is the same all over
  // the surface, which no search can narrow down.
  const double finest = std::min(1e-5, 1e-5 * diagonal);
  const std::vector<solid_cell> roots = cover(s, 16);
  std::vector<double> upper(roots.size(), std::numeric_limits<double>::infinity());
  for (double absolute = 0.05 * diagonal;; absolute = std::max(finest, absolute / 4)) {
    constexpr std::size_t visits = 10000;  // for one of about a thousand cells
    std::vector<double> finer = upper;
    tbb::parallel_for(std::size_t(0), roots.size(), [&](std::size_t i) {
      if (upper[i] > least * (1 + tolerance)) finer[i] = gap_search<S>(s, spheres, least, tolerance, absolute)(roots[i], visits);
    });
    double bound = least;
    for (std::size_t i = 0; i < roots.size(); ++i) bound = std::max(bound, upper[i] = std::min(upper[i], finer[i]));
    report.certified = bound;
    const bool gave_up = std::find(finer.begin(), finer.end(), std::numeric_limits<double>::infinity()) != finer.end();
    if (gave_up || absolute <= std::max(finest, least * tolerance)) break;
  }
  report.certified = report.certified * (1 + 1e-12) + 1e-12 * diagonal;
  return report;
}

}  // namespace clearance
