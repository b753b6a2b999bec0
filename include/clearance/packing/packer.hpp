// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/ascent.hpp>
#include <clearance/packing/gap.hpp>
#include <clearance/packing/limits.hpp>
#include <clearance/packing/rules.hpp>

#include <chrono>
#include <numeric>
#include <random>

namespace clearance {

/// Fills a solid with spheres, the largest first. The room at a point is its distance to the surface and to the spheres so
/// far; it changes by no more than the way between two points, so a cube's room is at most that of its middle plus half
/// its diagonal, and the cube with the largest such bound is divided, or, once it is small against its room, climbed from
/// (branch and bound on ProtoSphere's field, Weller & Zachmann 2010). So a sphere is never smaller than three quarters of
/// the largest that fits, except where `gap_per_radius` asks for it, and in solids whose largest room is nearly the same
/// in a great many places, such as thin shells: there bounds are trusted less and less as cubes pile up.
template <solid S>
class packer {
 public:
  packer(const S& s, const pack_options& options)
      : solid_(s), options_(options), limits_(s.bounds(), options),
        rules_(options.gap_per_radius, limits_.smallest) {}

  packing run() {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    packing out;
    out.stopped_by = fill(seconds);
    for (std::size_t i = 0; i < spheres_.size(); ++i) out.spheres.push_back(rounded(spheres_[i]));
    out.room = std::max(limits_.smallest, given_up_);
    for (const turn& t : turns_) out.room = std::max(out.room, cells_[t.at].bound());
    const gap_report gap = measure_gap(solid_, spheres_, options_.gap_tolerance);
    out.gap = gap.certified, out.gap_mean = gap.mean, out.gap_p95 = gap.p95;
    double volume = std::numeric_limits<double>::infinity();
    if constexpr (requires { solid_.volume(); }) volume = solid_.volume();
    arrange(out, volume);
    out.seconds = seconds();
    return out;
  }

 private:
  struct entry {
    solid_cell cell;
    double gap;   ///< From the middle to the first `seen` spheres.
    double key;
    std::uint32_t seen;

    double room() const { return std::min(cell.depth, gap); }
    double bound() const { return room() + cell.reach(); }  ///< No room in the cell is larger.
  };
  /// What the heap moves about: small, for it is as deep as there are many cells, and each level is a miss of the cache.
  struct turn {
    double key;
    std::uint32_t number;  ///< Of two with one key the one that came first.
    std::uint32_t at;      ///< In cells_.

    friend bool operator<(const turn& a, const turn& b) { return a.key != b.key ? a.key < b.key : a.number > b.number; }
  };
  static constexpr std::size_t batch = 256, most_cells = 1u << 22;  // alive,
  static constexpr std::size_t most_divided = 1u << 20;              // and between two spheres

  static inner_sphere rounded(const sphere_field::sphere& s) {
    return {{real(s.center.x()), real(s.center.y()), real(s.center.z())}, real(s.radius)};  // floats already: see `fit`
  }

  /// The sphere with a float centre and radius that surely fits, or radius 0.
  sphere_field::sphere fit(const sphere_field::sphere& wanted) const {
    const auto& [at, expected] = wanted;
    const Eigen::Vector3d c(to_float(at.x()), to_float(at.y()), to_float(at.z()));
    if ((c - at).norm() > 0.5 * expected) return {c, 0};
    double r = distance_within(solid_, c, 2 * expected + (c - at).norm());
    if (!options_.allow_overlap) r = spheres_.distance(c, r);
    r = r * (1 - 1e-12) - 1e-13 * limits_.scale;  // what rounding may have added
    if (!(r > 0)) return {c, 0};
    const double f = to_float(r);
    return {c, f > r ? double(std::nextafter(float(f), 0.0f)) : f};
  }

  double key(const solid_cell& cell, double gap) const { return rules_.key(cell.depth, cell.reach(), gap); }
  void push(const solid_cell& cell, double gap, std::uint32_t seen) {
    if (!(std::min(cell.depth, gap) + cell.reach() >= limits_.smallest)) return;
    const entry e = {cell, gap, key(cell, gap), seen};
    turns_.push_back({e.key, numbers_++, free_.empty() ? std::uint32_t(cells_.size()) : free_.back()});
    if (free_.empty())
      cells_.push_back(e);
    else
      cells_[free_.back()] = e, free_.pop_back();
    std::push_heap(turns_.begin(), turns_.end());
  }
  entry pop() {
    std::pop_heap(turns_.begin(), turns_.end());
    const std::uint32_t at = turns_.back().at;
    turns_.pop_back();
    free_.push_back(at);
    return cells_[at];
  }
  void trust_less() {
    rules_.trust *= 0.6, pile_ += pile_ / 2;
    for (turn& t : turns_) {
      entry& e = cells_[t.at];
      t.key = e.key = key(e.cell, e.gap);
    }
    std::make_heap(turns_.begin(), turns_.end());
  }

  /// Ends, because each turn of the loop does one of these to the cell whose key is the largest, and none for ever: it is
  /// divided or given up (a cell becomes half as large, down to `finest`); a sphere is added (there are at most `count`); or the
  /// cell comes back having met all spheres (once a cell and sphere). It does not take for ever either: of a plate that is
  /// thinner than any sphere looked for there are 1e12 cells, so the search also ends where so many find no sphere.
  template <class Clock>
  pack_stop fill(Clock seconds) {
    std::mt19937_64 random(options_.seed);
    Eigen::Vector3d shift;
    for (int k = 0; k < 3; ++k) shift[k] = options_.seed == 0 ? 0 : double(random() >> 11) * 0x1p-53;
    for (const solid_cell& c : cover(solid_, 8, shift)) push(c, std::numeric_limits<double>::infinity(), 0);

    std::vector<work> works;
    std::vector<std::uint32_t> order;
    stop_check check(options_);
    const auto certified = [this] { return measure_gap(solid_, spheres_, options_.gap_tolerance).certified; };
    for (;;) {
      if (const auto why = check(spheres_.size(), seconds, certified)) return *why;
      if (turns_.empty()) return limits_.exhausted();
      if (turns_.size() > most_cells || divided_ > most_divided) return pack_stop::search_limit;
      if (turns_.size() > pile_) trust_less();

      works.clear();
      const double top = turns_.front().key;
      while (!turns_.empty() && works.size() < batch && turns_.front().key >= 0.98 * top)
        works.push_back({pop(), work::stale, {}});
      const std::uint32_t seen = std::uint32_t(spheres_.size());
      tbb::parallel_for(std::size_t(0), works.size(), [&](std::size_t i) {
        work& w = works[i];
        entry& e = w.from;
        if (e.seen < seen) {
          e.gap = spheres_.update(e.seen, e.cell.middle, e.gap);
          e.seen = seen;
          if (key(e.cell, e.gap) < 0.95 * e.key) return;
        }
        if (rules_.small(e.room(), e.cell.reach())) {
          w.what = work::climbed;
          // Taken before its turn: stay here, there is more room elsewhere.
          const double way = e.key > e.bound() ? e.room() / 2 : std::numeric_limits<double>::infinity();
          w.sphere = ascend(solid_, spheres_, e.cell.middle, e.room(), way);
          if (options_.allow_overlap) w.grown = grow(solid_, w.sphere);
        } else {
          divide(w);
        }
      });
      order.resize(works.size());
      std::iota(order.begin(), order.end(), 0);
      std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        const work &a = works[i], &b = works[j];
        return (a.what == work::climbed ? a.sphere.radius : -1) > (b.what == work::climbed ? b.sphere.radius : -1);
      });
      for (const std::uint32_t i : order) {
        work& w = works[i];
        if (w.what == work::climbed) {
          const bool untouched = spheres_.size() == seen;
          // One of the same batch may be in the way; the cell then comes back with less room.
          const double least = std::max(limits_.smallest, 0.98 * w.sphere.radius);
          if (spheres_.size() < options_.count && (untouched || spheres_.distance(w.sphere.center, least) >= least)) {
            const sphere_field::sphere s = options_.allow_overlap ? fit(w.grown) : fit(w.sphere);
            if (s.radius >= least) spheres_.insert(s), divided_ = 0;
          }
          if (untouched && spheres_.size() == seen) divide(w);  // too small, or lost in rounding
        }
        if (w.what == work::given_up) {
          given_up_ = std::max(given_up_, w.from.bound());
        } else if (w.what == work::divided) {
          ++divided_;
          for (const auto& [cell, gap] : w.eighths) push(cell, gap, seen);
        } else {
          push(w.from.cell, w.from.gap, w.from.seen);
        }
      }
    }
  }

  struct work {
    entry from;
    enum { stale, divided, climbed, given_up } what;
    std::array<std::pair<solid_cell, double>, 8> eighths;
    sphere_field::sphere sphere = {Eigen::Vector3d::Zero(), 0}, grown = sphere;
  };
  void divide(work& w) const {
    w.what = rules_.finest(w.from.cell.reach()) ? work::given_up : work::divided;
    for (int k = 0; k < 8; ++k) {
      const solid_cell c = eighth(solid_, w.from.cell, k);
      const double bound = c.depth + c.reach();
      w.eighths[k] = {c, bound < limits_.smallest ? 0 : spheres_.distance(c.middle, rules_.farthest_gap(bound))};
    }
  }

  const S& solid_;
  const pack_options& options_;
  pack_limits limits_;
  sphere_field spheres_;
  std::vector<entry> cells_;
  std::vector<std::uint32_t> free_;  // places in cells_
  std::vector<turn> turns_;          // a heap
  pack_rules rules_;
  std::size_t pile_ = 1u << 20;
  std::uint32_t numbers_ = 0;
  std::size_t divided_ = 0;  // since the last sphere
  double given_up_ = 0;  // the largest bound of cells that are neither divided nor climbed from any more
};

}  // namespace clearance
