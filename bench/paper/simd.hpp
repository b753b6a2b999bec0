// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The competitor in the paper's Fig. 9, Algorithm 1 on a CPU "hand optimized to support modern SIMD", as one would
// write it today for AVX2 and FMA: eight points at a volume, one point at eight children, or each where it suits.
// Vectors only compute bounds, which `slack` makes conservative. For what is within reach the library's formula is
// used, so all bits are right.

#include "bounds.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/frames/root_test.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/traversal/near_first.hpp>

#if defined(__AVX2__) && defined(__FMA__)
#define CLEARANCE_BENCH_SIMD
#include <immintrin.h>

#include <atomic>
#include <bit>

namespace bench::paper {

using clearance::vec3;

/// The bound that all threads share.
class shared_least {
 public:
  real reach() const { return least_.load(std::memory_order_relaxed); }
  void offer(real distance) {
    real now = reach();
    while (distance < now && !least_.compare_exchange_weak(now, distance, std::memory_order_relaxed)) {
    }
  }

 private:
  std::atomic<real> least_ = clearance::infinity;
};

struct eight {
  __m256 x, y, z;

  vec3 operator[](int lane) const {
    alignas(32) real all[3][8];
    _mm256_store_ps(all[0], x), _mm256_store_ps(all[1], y), _mm256_store_ps(all[2], z);
    return {all[0][lane], all[1][lane], all[2][lane]};
  }
};

inline eight splat(vec3 p) { return {_mm256_set1_ps(p.x), _mm256_set1_ps(p.y), _mm256_set1_ps(p.z)}; }
inline eight operator-(const eight& a, const eight& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// 24 floats (x y z, x y z, ...), separated by shuffles.
inline eight load_eight(const real* f) {
  const auto halves = [](const real* low, const real* high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1);
  };
  const __m256 a = halves(f, f + 12), b = halves(f + 4, f + 16), c = halves(f + 8, f + 20);
  const __m256 xy = _mm256_shuffle_ps(b, c, _MM_SHUFFLE(2, 1, 3, 2)),
               yz = _mm256_shuffle_ps(a, b, _MM_SHUFFLE(1, 0, 2, 1));
  return {_mm256_shuffle_ps(a, xy, _MM_SHUFFLE(2, 0, 3, 0)), _mm256_shuffle_ps(yz, xy, _MM_SHUFFLE(3, 1, 2, 0)),
          _mm256_shuffle_ps(yz, c, _MM_SHUFFLE(3, 0, 3, 1))};
}
/// Points 8n .. 8n + 7; NaN beyond the last.
inline eight load_eight(const clearance::point_span& cloud, std::size_t n) {
  const auto* from = reinterpret_cast<const real*>(cloud.points) + 24 * n;
  if (8 * n + 8 <= cloud.size()) return load_eight(from);
  real few[24];
  std::fill(std::copy(from, reinterpret_cast<const real*>(cloud.points + cloud.size()), few), few + 24,
            clearance::not_a_number);
  return load_eight(few);
}

/// The same as rigid_transform, to the bit.
inline eight transformed(const clearance::rigid_transform& t, const eight& p) {
  const auto row = [&](vec3 r, real at) {
    return _mm256_fmadd_ps(
        _mm256_set1_ps(r.x), p.x,
        _mm256_fmadd_ps(_mm256_set1_ps(r.y), p.y, _mm256_fmadd_ps(_mm256_set1_ps(r.z), p.z, _mm256_set1_ps(at))));
  };
  return {row(t.row[0], t.translation.x), row(t.row[1], t.translation.y), row(t.row[2], t.translation.z)};
}

inline __m256 square(const eight& d) { return _mm256_fmadd_ps(d.x, d.x, _mm256_fmadd_ps(d.y, d.y, d.z * d.z)); }

/// No distance to the contents of these balls is less.
inline __m256 lower_bounds(const eight& way, __m256 radius) {
  return _mm256_fmsub_ps(_mm256_sqrt_ps(square(way)), _mm256_set1_ps(1 - clearance::slack), radius);
}
/// The lanes that are not above `reach`; NaN counts as above.
inline unsigned within(__m256 bounds, real reach) {
  return unsigned(_mm256_movemask_ps(_mm256_cmp_ps(bounds, _mm256_set1_ps(reach), _CMP_LE_OQ)));
}
template <class F>
void for_lanes(unsigned lanes, F f) {
  for (; lanes != 0; lanes &= lanes - 1) f(std::countr_zero(lanes));
}
inline real least_of(__m256 bounds) {
  const __m256 numbers = _mm256_min_ps(bounds, _mm256_set1_ps(clearance::infinity));  // takes the second for NaN
  __m128 m = _mm_min_ps(_mm256_castps256_ps128(numbers), _mm256_extractf128_ps(numbers, 1));
  m = _mm_min_ps(m, _mm_movehl_ps(m, m));
  return _mm_cvtss_f32(_mm_min_ss(m, _mm_movehdup_ps(m)));
}

/// Walks one tree with eight points together, near children first.
template <class Tree>
void walk_together(const Tree& tree, const eight& p, shared_least& best) {
  using entry = clearance::near_first::entry_of<Tree>;
  const auto bounds = [&](const auto& ball) {
    return lower_bounds(p - splat(ball.center), _mm256_set1_ps(ball.radius));
  };
  if (within(bounds(tree.volume(tree.root())), best.reach()) == 0) return;
  entry pending[clearance::near_first::capacity];
  std::uint32_t count = 0;
  pending[count++] = {-clearance::infinity, tree.root()};
  while (count > 0) {
    const entry top = pending[--count];
    if (!(top.bound <= best.reach())) continue;
    const std::uint32_t base = count, size = tree.size(top.node);
    for (std::uint32_t k = 0; k < size; ++k)
      if (tree.is_leaf(top.node)) {
        const auto& primitive = tree.primitive(top.node, k);
        for_lanes(within(bounds(primitive), best.reach()), [&](int lane) { best.offer(primitive.distance(p[lane])); });
      } else {
        const auto child = tree.child(top.node, k);
        const __m256 all = bounds(tree.volume(child));
        if (within(all, best.reach()) != 0)
          clearance::near_first::push<Tree>(pending, base, count, {least_of(all), child});
      }
  }
}

/// The contents of each node of a tree of up to eight children and primitives, so that one load gets all.
template <class Tree>
class wide_tree {
 public:
  explicit wide_tree(const Tree& tree) : tree_(tree), below_(tree.node_count) {
    for (std::uint32_t n = 0; n < tree.node_count; ++n) {
      if (tree.size(n) > 8) throw std::invalid_argument("a node with more than eight children");
      for (std::uint32_t k = 0; k < tree.size(n); ++k)
        if (tree.is_leaf(n))
          below_[n].put(k, tree.primitive(n, k));
        else
          below_[n].put(k, tree.volume(tree.child(n, k)));
    }
  }

  /// One point; the root has been tested.
  void walk(vec3 p, shared_least& best) const {
    using entry = clearance::near_first::entry_of<Tree>;
    const eight point = splat(p);
    entry pending[clearance::near_first::capacity];
    std::uint32_t count = 0;
    pending[count++] = {-clearance::infinity, tree_.root()};
    while (count > 0) {
      const entry top = pending[--count];
      const real reach = best.reach();
      if (!(top.bound <= reach)) continue;
      const balls& b = below_[top.node];
      const __m256 bounds = lower_bounds(point - eight{_mm256_load_ps(b.x), _mm256_load_ps(b.y), _mm256_load_ps(b.z)},
                                         _mm256_load_ps(b.radius));
      if (tree_.is_leaf(top.node)) {
        for_lanes(within(bounds, reach),
                  [&](int k) { best.offer(tree_.primitive(top.node, std::uint32_t(k)).distance(p)); });
        continue;
      }
      alignas(32) real each[8];
      _mm256_store_ps(each, bounds);
      const std::uint32_t base = count;
      for_lanes(within(bounds, reach), [&](int k) {
        clearance::near_first::push<Tree>(pending, base, count, {each[k], tree_.child(top.node, std::uint32_t(k))});
      });
    }
  }

 private:
  struct alignas(32) balls {
    real x[8] = {}, y[8] = {}, z[8] = {}, radius[8];

    balls() { std::fill(radius, radius + 8, -clearance::infinity); }  // empty: infinitely far
    void put(std::uint32_t k, const auto& ball) {
      x[k] = ball.center.x, y[k] = ball.center.y, z[k] = ball.center.z, radius[k] = ball.radius;
    }
  };

  Tree tree_;
  std::vector<balls> below_;
};

/// Algorithm 1 with eight points of the cloud at once.
template <class PartView>
real eight_points(const clearance::host& cpu, clearance::model_view<PartView> model,
                  const clearance::frames::cloud_frame& frame, const clearance::point_span& cloud) {
  shared_least best;
  cpu.for_ranges((cloud.size() + 7) / 8, [&](clearance::indices range) {
    for (std::size_t k = 0; k < model.size(); ++k)
      for (std::size_t n = range.begin; n < range.end; ++n)
        walk_together(model.parts[k].tree,
                      transformed(frame.places[k].part_from_cloud, load_eight(cloud, n) - splat(frame.origin)), best);
  });
  return best.reach();
}

template <class PartView>
using wide_trees = std::vector<wide_tree<decltype(PartView::tree)>>;

template <class PartView>
wide_trees<PartView> make_wide_trees(clearance::model_view<PartView> model) {
  wide_trees<PartView> trees;
  for (std::size_t k = 0; k < model.size(); ++k) trees.emplace_back(model.parts[k].tree);
  return trees;
}

/// Algorithm 1 with eight children at once.
template <class PartView>
real eight_children(const clearance::host& cpu, clearance::model_view<PartView> model,
                    const wide_trees<PartView>& trees, const clearance::frames::cloud_frame& frame,
                    const clearance::point_span& cloud) {
  shared_least best;
  cpu.for_ranges(cloud.size(), [&](clearance::indices range) {
    for (std::size_t k = 0; k < model.size(); ++k)
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const vec3 p = frame.places[k].part_from_cloud(cloud.points[i] - frame.origin);
        if (model.parts[k].tree.volume(0).may_reach(p, best.reach())) trees[k].walk(p, best);
      }
  });
  return best.reach();
}

/// Eight points at the ball of each part, in the cloud's frame; survivors one by one at eight children.
template <class PartView>
real eight_of_each(const clearance::host& cpu, clearance::model_view<PartView> model, const wide_trees<PartView>& trees,
                   const clearance::frames::cloud_frame& frame, const clearance::point_span& cloud) {
  shared_least best;
  cpu.for_ranges((cloud.size() + 7) / 8, [&](clearance::indices range) {
    for (std::size_t n = range.begin; n < range.end; ++n) {
      const eight p = load_eight(cloud, n) - splat(frame.origin);
      for (std::size_t k = 0; k < model.size(); ++k) {
        const clearance::ball& around = frame.places[k].around;
        const real most = clearance::frames::limit(around, best.reach());
        if (!(most >= 0)) continue;
        for_lanes(within(square(p - splat(around.center)), most * most),
                  [&](int lane) { trees[k].walk(frame.places[k].part_from_cloud(p[lane]), best); });
      }
    }
  });
  return best.reach();
}

}  // namespace bench::paper
#endif
