// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree over a cloud on the host.

#include <clearance/backends/host.hpp>
#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/scan/drops.hpp>

#include <algorithm>
#include <tuple>

namespace clearance::cloud_tree {

/// Owns a tree that is built anew for every frame, in memory that is kept. The valid points are sorted along a Z-curve:
/// a depth image's rows are lines with few points near one another, and other clouds have no order at all.
class host_tree {
 public:
  using view_type = tree_view<8, 8>;

  /// Builds it. Adds invalid points to `dropped`.
  template <point_source S>
  void build(host_workers& workers, const S& source, scan::drop_counts& dropped) {
    static_assert(points_or_balls<S>());
    with_radii_ = ball_source<S>;
    read(workers, source, dropped);
    encode(workers);
    for (int shift = 0; shift < 3 * morton_grid::bits; shift += morton_grid::bits) sort_by(workers, shift);
    sort_dense_cells(workers);
    put_up(workers);
  }
  const view_type& view() const { return view_; }
  /// If it was built over such a source.
  template <point_source S>
  auto view_of() const {
    return view_over<S>(view_, radii_.data(), widest_.data());
  }

 private:
  static constexpr std::size_t piece = 16384;
  static constexpr std::uint32_t digits = 1 << morton_grid::bits;
  static constexpr std::size_t dense = 256;
  struct coded {
    std::uint32_t code, at;
  };
  struct cell {
    std::size_t begin, end;
  };

  static std::size_t pieces(std::size_t n) { return (n + piece - 1) / piece; }

  /// Reads the valid points, each piece's to its beginning, and how many each has.
  template <point_source S>
  void read(host_workers& workers, const S& source, scan::drop_counts& dropped) {
    const std::size_t n = source.size();
    if constexpr (ball_source<S>) read_radii_.resize(n);
    read_.resize(n);
    kept_.assign(pieces(n) + 1, 0);
    workers.for_pieces(n, piece, [&](std::size_t begin, std::size_t end) {
      scan::drop_tally mine;
      std::size_t to = begin;
      for (std::size_t i = begin; i < end; ++i)
        if (const sample s = source[i]; mine.counts(s)) {
          if constexpr (ball_source<S>) read_radii_[to] = source.around(i, s.position).radius;
          read_[to++] = {s.position, std::uint32_t(i)};
        }
      kept_[begin / piece + 1] = std::uint32_t(to - begin);
      mine.add_to(dropped);
    });
    for (std::size_t k = 1; k < kept_.size(); ++k) kept_[k] += kept_[k - 1];
    view_ = view_type(kept_.back());
  }

  void encode(host_workers& workers) {
    const morton_grid grid = grid_of_samples();
    codes_.resize(view_.count);
    others_.resize(view_.count);
    workers.for_pieces(read_.size(), piece, [&](std::size_t begin, std::size_t) {
      const std::uint32_t first = kept_[begin / piece], count = kept_[begin / piece + 1] - first;
      for (std::uint32_t j = 0; j < count; ++j)
        codes_[first + j] = {grid(read_[begin + j].at), std::uint32_t(begin) + j};
    });
  }
  morton_grid grid_of_samples() const {
    std::vector<real> along[3];
    const std::size_t stride = std::max<std::size_t>(1, read_.size() / morton_grid::samples);
    for (std::size_t i = 0; i < read_.size(); i += stride)
      if (i % piece < kept_[i / piece + 1] - kept_[i / piece]) {
        const vec3 p = read_[i].at;
        along[0].push_back(p.x);
        along[1].push_back(p.y);
        along[2].push_back(p.z);
      }
    if (along[0].empty()) return {};
    const auto count = std::uint32_t(along[0].size());
    const auto quantile = [&](std::uint32_t rank) {
      for (auto& a : along) std::nth_element(a.begin(), a.begin() + rank, a.end());
      return vec3{along[0][rank], along[1][rank], along[2][rank]};
    };
    return {quantile(morton_grid::low_rank(count)), quantile(morton_grid::high_rank(count))};
  }

  /// Sorts by one digit; equal digits keep their order.
  void sort_by(host_workers& workers, int shift) {
    const std::size_t n = codes_.size(), rows = pieces(n);
    const auto digit = [shift](const coded& c) { return c.code >> shift & (digits - 1); };
    starts_.assign(rows * digits, 0);
    workers.for_pieces(n, piece, [&](std::size_t begin, std::size_t end) {
      std::uint32_t* const count = starts_.data() + begin / piece * digits;
      for (std::size_t i = begin; i < end; ++i) ++count[digit(codes_[i])];
    });
    std::uint32_t sum = 0;
    for (std::uint32_t d = 0; d < digits; ++d)
      for (std::size_t row = 0; row < rows; ++row) {
        std::uint32_t& start = starts_[row * digits + d];
        const std::uint32_t count = start;
        start = sum;
        sum += count;
      }
    workers.for_pieces(n, piece, [&](std::size_t begin, std::size_t end) {
      std::uint32_t* const start = starts_.data() + begin / piece * digits;
      for (std::size_t i = begin; i < end; ++i) others_[start[digit(codes_[i])]++] = codes_[i];
    });
    codes_.swap(others_);
  }

  /// A cell of the curve with very many points gets its own curve, so that neighbours come together. Equal points
  /// always do.
  void sort_dense_cells(host_workers& workers) {
    cells_.clear();
    const auto code_less = [](const coded& a, const coded& b) { return a.code < b.code; };
    for (std::size_t i = 0; i + dense < codes_.size(); i += dense)
      if (codes_[i].code == codes_[i + dense].code && (cells_.empty() || i >= cells_.back().end)) {
        const auto its = std::equal_range(codes_.begin(), codes_.end(), codes_[i], code_less);
        cells_.push_back({std::size_t(its.first - codes_.begin()), std::size_t(its.second - codes_.begin())});
      }
    workers.for_pieces(cells_.size(), 1,
                       [&](std::size_t k, std::size_t) { sort_cell(cells_[k].begin, cells_[k].end); });
  }
  void sort_cell(std::size_t begin, std::size_t end) {
    extent box;
    for (std::size_t i = begin; i < end; ++i) box.add(read_[codes_[i].at].at);
    if (box.lower == box.upper) return;
    const morton_grid grid(box.lower, box.upper);
    for (std::size_t i = begin; i < end; ++i) codes_[i].code = grid(read_[codes_[i].at].at);
    std::sort(codes_.begin() + std::ptrdiff_t(begin), codes_.begin() + std::ptrdiff_t(end),
              [this](const coded& a, const coded& b) {
                const vec3 p = read_[a.at].at, q = read_[b.at].at;
                return std::tie(a.code, p.x, p.y, p.z, a.at) < std::tie(b.code, q.x, q.y, q.z, b.at);
              });
  }

  void put_up(host_workers& workers) {
    points_.resize(view_.count);
    boxes_.resize(view_.nodes());
    balls_.resize(view_.nodes());
    least_.resize(view_.nodes());
    if (with_radii_) {
      radii_.resize(view_.count);
      widest_.resize(view_.nodes());
    }
    view_.points = points_.data();
    view_.balls = balls_.data();
    view_.boxes = boxes_.data();
    view_.least = least_.data();
    for (std::uint32_t level = 0; level < view_.levels; ++level)
      workers.for_pieces(view_.size(level), piece / view_type::tile, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
          level == 0 ? put_tile(std::uint32_t(n)) : put_node(level, std::uint32_t(n));
      });
  }
  void put_tile(std::uint32_t n) {
    const std::uint32_t begin = view_.first_below(0, n), end = view_.end_below(0, n);
    extent box;
    std::uint32_t least = ~0u;
    for (std::uint32_t i = begin; i < end; ++i) {
      points_[i] = read_[codes_[i].at];
      box.add(points_[i].at);
      least = std::min(least, points_[i].number);
    }
    const vec3 center = middle(box);
    real radius = 0;
    for (std::uint32_t i = begin; i < end; ++i) radius = max(radius, rough_length_up(points_[i].at - center));
    boxes_[n] = box;
    balls_[n] = {center, radius};
    least_[n] = least;
    if (!with_radii_) return;
    widest_[n] = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      radii_[i] = read_radii_[codes_[i].at];
      widest_[n] = max(widest_[n], radii_[i]);
    }
  }
  void put_node(std::uint32_t level, std::uint32_t n) {
    const std::uint32_t below = view_.begin[level - 1], begin = below + view_.first_below(level, n),
                        end = below + view_.end_below(level, n);
    extent box;
    std::uint32_t least = ~0u;
    for (std::uint32_t i = begin; i < end; ++i) {
      box.add(boxes_[i].lower);
      box.add(boxes_[i].upper);
      least = std::min(least, least_[i]);
    }
    const vec3 center = middle(box);
    real radius = 0;
    for (std::uint32_t i = begin; i < end; ++i)
      radius = max(radius, (rough_length_up(balls_[i].center - center) + balls_[i].radius) * (1 + slack));
    const std::uint32_t me = view_.begin[level] + n;
    boxes_[me] = box;
    balls_[me] = {center, min(radius, farthest(box, center))};
    least_[me] = least;
    if (!with_radii_) return;
    widest_[me] = 0;
    for (std::uint32_t i = begin; i < end; ++i) widest_[me] = max(widest_[me], widest_[i]);
  }

  view_type view_;
  std::vector<numbered_point> read_, points_;
  std::vector<std::uint32_t> kept_, starts_, least_;
  std::vector<coded> codes_, others_;
  std::vector<cell> cells_;
  std::vector<extent> boxes_;
  std::vector<ball> balls_;
  std::vector<real> read_radii_, radii_, widest_;  // of balls
  bool with_radii_ = false;
};

}  // namespace clearance::cloud_tree
