// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The certified gap of a packing: how far a place in the solid can be from the spheres. Also what measuring it shares
// with packing: the steps of a host, and spheres in a backend's memory.

#include <clearance/backends/host.hpp>
#include <clearance/packing/compass.hpp>
#include <clearance/packing/grid.hpp>
#include <clearance/packing/growing.hpp>
#include <clearance/packing/room_view.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/solid/box_tree.hpp>

namespace clearance {

/// What packing in rounds needs from a host besides a backend. The result does not depend on threads.
class host_steps {
 public:
  static constexpr std::size_t cells = 1u << 20;

  explicit host_steps(const host&) {}

  /// Takes only a few of the largest keys at once, so that little work is wasted. Large ones are kept in a heap, the
  /// rest, whose turn may never come, in a pile. Each call adds the new cells, and those chosen last time; after any
  /// other change call `forget`.
  std::size_t next(const double* keys, std::size_t n, std::size_t most, std::uint32_t* out, double& least) {
    const auto add = [&](std::uint32_t i) {
      if (!(keys[i] > 0)) return;
      const turn its{keys[i], numbers_++, i};
      if (its.key < large_) return pile_.push_back(its);
      turns_.push_back(its);
      std::push_heap(turns_.begin(), turns_.end());
    };
    for (const std::uint32_t i : chosen_) add(i);
    for (; known_ < n; ++known_) add(std::uint32_t(known_));
    refill();
    chosen_.clear();
    const double top = turns_.empty() ? 0 : turns_.front().key;
    least = 0.93 * top;  // a cell that lost little to a new sphere touches it: prefer it to places far from all
    while (!turns_.empty() && turns_.front().key >= 0.98 * top && chosen_.size() < std::min(most, batch)) {
      chosen_.push_back(turns_.front().cell);
      std::pop_heap(turns_.begin(), turns_.end());
      turns_.pop_back();
      refill();
    }
    std::copy(chosen_.begin(), chosen_.end(), out);
    return chosen_.size();
  }
  void forget() {
    turns_.clear();
    pile_.clear();
    chosen_.clear();
    known_ = numbers_ = 0;
    large_ = double(infinity);
  }

  template <class F>
  void each(std::size_t n, const F& f) const {
    tbb::parallel_for(std::size_t(0), n, f);
  }
  template <class F>
  void eighths(std::size_t n, const F& f) const {
    tbb::parallel_for(std::size_t(0), n, [&](std::size_t i) { f.all_eight(i); });
  }
  template <class F>
  void climbers(std::size_t n, const F& f) const {
    tbb::parallel_for(std::size_t(0), n, [&](std::size_t i) { f(i, one_lane{}); });
  }
  template <class F>
  std::size_t select(std::size_t n, const F& f, std::uint32_t* out) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      out[count] = std::uint32_t(i);
      count += f(i);
    }
    return count;
  }
  template <class F>
  double largest(std::size_t n, const F& f) const {
    double most = 0;
    for (std::size_t i = 0; i < n; ++i) most = std::max(most, f(i));
    return most;
  }

 private:
  static constexpr std::size_t batch = 256;
  struct turn {
    double key;
    std::uint32_t number;  // of two equal keys the earlier one
    std::uint32_t cell;

    friend bool operator<(const turn& a, const turn& b) { return a.key != b.key ? a.key < b.key : a.number > b.number; }
  };

  /// Fills an empty heap from the pile, with the keys from 0.9 of its largest.
  void refill() {
    if (!turns_.empty() || pile_.empty()) return;
    large_ = 0.9 * std::max_element(pile_.begin(), pile_.end())->key;
    const auto first = std::partition(pile_.begin(), pile_.end(), [&](const turn& each) { return each.key < large_; });
    turns_.assign(first, pile_.end());
    pile_.erase(first, pile_.end());
    std::make_heap(turns_.begin(), turns_.end());
  }

  std::vector<turn> turns_;            // a heap of all keys from large_
  std::vector<turn> pile_;             // the rest, in no order
  std::vector<std::uint32_t> chosen_;  // chosen last time; in neither
  double large_ = double(infinity);
  std::size_t known_ = 0;
  std::uint32_t numbers_ = 0;
};

/// A growing list of spheres, here and in B's memory, and a tree over most of them.
template <backend B>
class spheres_there {
 public:
  explicit spheres_there(const B& on) : on_(on), there_(on), nodes_(on), order_(on) {}

  std::size_t size() const { return here_.size(); }
  const std::vector<solid_sphere>& here() const { return here_; }

  template <solid_view V>
  room_view<V> room_in(const V& solid) {
    return {solid,
            there_.data(),
            std::uint32_t(size()),
            {nodes_.data(), order_.data(), tree_.view().items, tree_.view().root}};
  }

  /// Where `n` more can be written in B's memory; `add` makes them count.
  solid_sphere* reserve(std::size_t n) { return there_.reserve(size() + n, size()) + size(); }
  void add(std::span<const solid_sphere> written) { here_.insert(here_.end(), written.begin(), written.end()); }
  void insert(std::span<const solid_sphere> some) {
    on_.stage(some, reserve(some.size()));
    add(some);
  }

  /// Builds the tree anew once more than `most` spheres are not in it.
  void plant(std::size_t most) {
    if (size() - tree_.size() <= most) return;
    std::vector<Eigen::AlignedBox3d> boxes;
    boxes.reserve(size());
    for (const solid_sphere& s : here_) {
      const Eigen::Vector3d c = s.center, r = Eigen::Vector3d::Constant(s.radius);
      boxes.emplace_back(c - r, c + r);
    }
    tree_ = box_tree(boxes);
    on_.stage(tree_.nodes(), nodes_.reserve(tree_.nodes().size()));
    on_.stage(tree_.order(), order_.reserve(tree_.order().size()));
  }

 private:
  B on_;
  std::vector<solid_sphere> here_;
  growing<solid_sphere, B> there_;
  box_tree tree_;
  growing<box_pair, B> nodes_;
  growing<std::uint32_t, B> order_;
};

struct gap_report {
  double certified = 0;      ///< No point of the solid, surface and interior, is farther from the spheres. Metres.
  double mean = 0, p95 = 0;  ///< Over samples of the surface, metres.
};

namespace detail {

struct gap_cell {
  vec3d middle;
  double half;
  double depth;  ///< Signed: the parent cell's until visited, then its own; 0 if unknown.
};

/// Bounds the gap over the solid's points in a cell.
template <solid_view V>
struct gap_visit {
  room_view<V> in;
  gap_cell* cells;
  double* met;     ///< The gap at the middle, if that is in the solid.
  double* open;    ///< An upper bound of the gap, if it is above `target` and can be narrowed down.
  double* closed;  ///< An upper bound of the gap, if it is not above `target` or cannot be narrowed down.
  double least, target, slack;

  CLEARANCE_HD void operator()(std::size_t i) const {
    gap_cell& c = cells[i];
    const double reach = corner_reach(c.half);
    met[i] = open[i] = closed[i] = 0;
    const double gap = in.gap(c.middle, double(infinity), least - reach);
    if (gap + reach <= least) return;
    c.depth = signed_depth(in.solid, c.middle, c.depth, reach);  // also the way to its parent's middle
    judge(i, gap, reach);
  }
  /// All eight of parent `i`, on the host.
  void all_eight(std::size_t i) const {
    gap_cell* const c = cells + 8 * i;
    const double reach = corner_reach(c->half);
    const eighths at([c](std::uint32_t k) { return c[k].middle; });
    eight gap = eight::of(double(infinity)), depth;
    in.gaps(at, gap, least - reach);
    for (int k = 0; k < 8; ++k) depth.v[k] = gap.v[k] + reach <= least ? 0 : 1;
    signed_depths(in.solid, at, c->depth, reach, depth);
    for (std::size_t k = 0; k < 8; ++k) {
      met[8 * i + k] = open[8 * i + k] = closed[8 * i + k] = 0;
      if (gap.v[k] + reach <= least) continue;
      c[k].depth = depth.v[k];
      judge(8 * i + k, gap.v[k], reach);
    }
  }

 private:
  CLEARANCE_HD void judge(std::size_t i, double gap, double reach) const {
    const double bound = gap + reach;
    if (cells[i].depth < -reach * (1 + 1e-12)) return;  // no point of the solid is here
    if (cells[i].depth >= 0) met[i] = gap;
    // The solid is less than `reach` from the middle, so a small cell's bound is at most twice `reach` too high.
    (bound <= target || 4 * reach <= slack ? closed : open)[i] = bound;
  }
};

struct gap_spread {
  const gap_cell* from;
  const std::uint32_t* some;
  gap_cell* to;
  CLEARANCE_HD void operator()(std::size_t i) const {
    const gap_cell& c = from[some[i / 8]];
    to[i] = {eighth_middle(c.middle, c.half, std::uint32_t(i % 8)), c.half / 2, c.depth};
  }
};

struct gap_roots {
  cube_grid grid;
  gap_cell* to;
  CLEARANCE_HD void operator()(std::size_t i) const { to[i] = {grid.middle(i), grid.half, 0}; }
};

template <solid_view V>
struct gap_at {
  room_view<V> in;
  const vec3d* points;
  double* gaps;
  CLEARANCE_HD void operator()(std::size_t i) const {
    const double g = in.gap(points[i], double(infinity));
    gaps[i] = g > 0 ? g : 0;
  }
};

struct value_of {
  const double* values;
  CLEARANCE_HD double operator()(std::size_t i) const { return values[i]; }
};
struct if_not_above {
  const double* values;
  double most;
  CLEARANCE_HD double operator()(std::size_t i) const { return values[i] > most ? 0 : values[i]; }
};
struct is_above {
  const double* values;
  double least;
  CLEARANCE_HD bool operator()(std::size_t i) const { return values[i] > least; }
};

}  // namespace detail

/// The largest distance from any point of the solid to the nearest sphere, 0 if they cover it. It is a proven upper
/// bound, by branch and bound in double, rounded up. It exceeds the truth by at most `tolerance` (relative), 10 um or
/// 1e-5 of the solid, or by more if the search would take too long. All cells of one size go at once and know the same
/// gap so far, so the result does not depend on their order.
template <backend B, class Steps, solid S, solid_view V>
gap_report measure_gap(const B& on, Steps& steps, const S& s, const room_view<V>& in, double tolerance) {
  gap_report report;
  if (in.count == 0) {
    report.certified = report.mean = report.p95 = double(infinity);
    return report;
  }
  // Every gap found bounds the largest from below; a better bound shortens the search.
  std::vector<vec3d> points;
  if constexpr (requires { s.surface_points(std::size_t(1)); })
    for (const auto& p : s.surface_points(20000)) points.push_back(p);
  const std::size_t samples = points.size();
  if constexpr (requires { s.corners(); })
    for (const auto& p : s.corners()) points.push_back(p);
  double least = 0;
  if (!points.empty()) {
    const auto there = on.copy_in(std::span<const vec3d>(points));
    auto gaps_there = on.template make_scratch<double>(points.size());
    steps.each(points.size(), detail::gap_at<V>{in, there.data(), gaps_there.data()});
    std::vector<double> gaps = on.copy_out(gaps_there.data(), gaps_there.size());
    least = *std::max_element(gaps.begin(), gaps.end());
    gaps.resize(samples);
    for (const double g : gaps) report.mean += g / double(samples);
    const auto at = gaps.begin() + std::ptrdiff_t(samples * 95 / 100);
    std::nth_element(gaps.begin(), at, gaps.end());
    if (samples != 0) report.p95 = *at;
  }

  const double diagonal = Eigen::AlignedBox3d(s.bounds()).diagonal().norm(), finest = std::min(1e-5, 1e-5 * diagonal);
  growing<detail::gap_cell, B> cells(on), next(on);
  growing<double, B> met(on), open(on), closed(on);
  growing<std::uint32_t, B> some(on);
  const cube_grid grid(s.bounds(), 16);
  std::size_t n = grid.size();
  steps.each(n, detail::gap_roots{grid, cells.reserve(n)});
  double upper = 0;
  bool roots = true;
  while (n > 0) {  // cells halve until 4 * reach <= slack, which is at least `finest`
    const double slack = std::max(least * tolerance, finest);
    const detail::gap_visit<V> visit{.in = in,
                                     .cells = cells.data(),
                                     .met = met.reserve(n),
                                     .open = open.reserve(n),
                                     .closed = closed.reserve(n),
                                     .least = least,
                                     .target = least + slack,
                                     .slack = slack};
    if (std::exchange(roots, false))
      steps.each(n, visit);
    else
      steps.eighths(n / 8, visit);
    least = std::max(least, steps.largest(n, detail::value_of{met.data()}));
    upper = std::max(upper, steps.largest(n, detail::value_of{closed.data()}));
    const double enough = std::max(upper, least + std::max(least * tolerance, finest));
    upper = std::max(upper, steps.largest(n, detail::if_not_above{open.data(), enough}));
    const std::size_t split = steps.select(n, detail::is_above{open.data(), enough}, some.reserve(n));
    if (8 * split >
        Steps::cells) {  // the gap of a ball in a ball, say, is the same all over, which no search can narrow down
      upper = std::max(upper, steps.largest(n, detail::value_of{open.data()}));
      break;
    }
    steps.each(8 * split, detail::gap_spread{cells.data(), some.data(), next.reserve(8 * split)});
    std::swap(cells, next);
    n = 8 * split;
  }
  report.certified = std::max(least, upper) * (1 + 1e-12) + 1e-12 * diagonal;
  return report;
}

/// The same on the host, for spheres from anywhere.
template <solid S>
gap_report measure_gap(const S& s, std::span<const inner_sphere> spheres, double tolerance = 0.01) {
  const host on;
  host_steps steps(on);
  std::vector<solid_sphere> wide;
  for (const inner_sphere& each : spheres) wide.push_back({{each.center.x, each.center.y, each.center.z}, each.radius});
  spheres_there<host> all(on);
  all.insert(wide);
  all.plant(0);
  return measure_gap(on, steps, s, all.room_in(solid_there<host, S>(on, s).view()), tolerance);
}

class mesh_solid;
/// The same for a mesh, compiled once.
gap_report measure_gap(const mesh_solid& s, std::span<const inner_sphere> spheres, double tolerance = 0.01);

}  // namespace clearance
