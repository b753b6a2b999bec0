// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud that is read in chunks, and what its first reading has shown.

#include <clearance/frame/bracket.hpp>
#include <clearance/frame/clouds.hpp>
#include <clearance/points/loaded.hpp>
#include <clearance/scan/boxes.hpp>

namespace clearance {

/// Points `begin` to `end - 1`.
struct point_range {
  std::size_t begin, end;
};

/// Owns a cloud that is read in chunks, and boxes around its points from the first question. Later questions read only
/// the chunks that can matter. If the cloud changes, call `forget()`. Ask one question at a time.
template <loaded_cloud C>
class chunked {
 public:
  static constexpr std::size_t usual_chunk = std::size_t(1) << 22;

  /// `chunk`: points at a time, rounded up to whole pieces of 4096, the points of one box. Throws std::invalid_argument
  /// if there are more points than answers have numbers for.
  explicit chunked(C cloud, std::size_t chunk = usual_chunk)
      : cloud_(std::move(cloud)),
        size_(cloud_.size()),
        chunk_((std::clamp<std::size_t>(chunk, 1, none) + scan::piece_points - 1) / scan::piece_points *
               scan::piece_points) {
    if (size_ >= none)
      throw std::invalid_argument("clearance: a cloud of " + std::to_string(size_) +
                                  " points; one has at most 2^32 - 2");
  }

  const C& cloud() const { return cloud_; }
  /// The size at construction: a file that grows is another cloud.
  std::size_t size() const { return size_; }
  std::size_t chunk() const { return chunk_; }
  /// What was seen, in order. Empty until the whole cloud was read.
  const std::vector<scan::boxed_piece>& pieces() const { return pieces_; }
  /// Counts of the whole cloud, once it was read.
  point_counts counts() const {
    point_counts all{size_, size_};
    for (const scan::boxed_piece& piece : pieces_)
      for (int r = 1; r < drop_reasons; ++r) all.dropped[r] += piece.dropped[r], all.valid -= piece.dropped[r];
    return all;
  }
  void forget() { pieces_.clear(); }
  void keep(std::vector<scan::boxed_piece> seen) { pieces_ = std::move(seen); }

  /// All of it in chunks.
  std::vector<point_range> all() const {
    std::vector<point_range> ranges;
    for (std::size_t at = 0; at < size(); at += chunk_) ranges.push_back({at, std::min(size(), at + chunk_)});
    return ranges;
  }
  /// The ranges whose pieces satisfy `matters(piece)`. Short gaps are read, too: that is faster than another chunk.
  template <class Matters>
  std::vector<point_range> where(const Matters& matters) const {
    constexpr std::size_t short_gap = 16 * scan::piece_points;
    std::vector<point_range> ranges;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      if (pieces_[k].empty() || !matters(pieces_[k])) continue;
      const point_range its = piece(k);
      if (!ranges.empty() && its.begin <= ranges.back().end + short_gap && its.end - ranges.back().begin <= chunk_)
        ranges.back().end = its.end;
      else
        ranges.push_back(its);
    }
    return ranges;
  }
  point_range piece(std::size_t k) const {
    return {k * scan::piece_points, std::min(size(), (k + 1) * scan::piece_points)};
  }

 private:
  C cloud_;
  std::size_t size_, chunk_;
  std::vector<scan::boxed_piece> pieces_;
};
template <point_source S>
chunked(S, std::size_t = 0) -> chunked<in_memory<S>>;

namespace minimum {

/// The clouds of a call, each loaded when its turn comes: `load(k)` returns the k-th, placed.
template <class Load>
class as_they_come {
 public:
  as_they_come(std::size_t count, const Load& load) : count_(count), load_(&load) {}

  struct iterator {
    using iterator_category = std::input_iterator_tag;
    using difference_type = std::ptrdiff_t;
    std::size_t k;
    const Load* load;
    auto operator*() const { return (*load)(k); }
    iterator& operator++() { return ++k, *this; }
    friend bool operator==(const iterator& a, const iterator& b) { return a.k == b.k; }
  };
  iterator begin() const { return {0, load_}; }
  iterator end() const { return {count_, load_}; }
  std::size_t size() const { return count_; }

 private:
  std::size_t count_;
  const Load* load_;
};

/// `load` of a range. Throws std::runtime_error if it loads another number of points, because the known pieces have no
/// room for others.
template <loaded_cloud C>
loaded_source<C> load_range(const C& cloud, const point_range& range, std::byte* room) {
  const loaded_source<C> source = cloud.load(range.begin, range.end, room);
  if (source.size() != range.end - range.begin)
    throw std::runtime_error("clearance: a cloud was to load " + std::to_string(range.end - range.begin) +
                             " points, and loaded " + std::to_string(source.size()));
  return source;
}

/// Renumbers what was found: point i of range k becomes point `number(k, i)` of the cloud.
template <class Number>
void number_as_in_cloud(min_distance_result& result, std::span<part_minimum> minima, const Number& number) {
  const auto put = [&](auto& r) {
    if (r.cloud != none) r.point = number(r.cloud, r.point), r.cloud = 0;
  };
  put(result);
  for (part_minimum& m : minima) put(m);
}

/// Asks a question about a chunked cloud, on any backend. `search(ranges, result, pieces)` searches some ranges; it
/// also writes to `minima` if these are not empty, and what it sees to `pieces` if that is not null.
///
/// After the first question there are two steps. The boxes nearest to the parts give a first answer, which is a bound.
/// Then the boxes within that bound are searched.
template <class C, class Search>
min_distance_result ask_chunked(chunked<C>& cloud, std::span<const part_facts> facts,
                                std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& pose,
                                std::span<part_minimum> minima, const Search& search) {
  const std::size_t pieces = (cloud.size() + scan::piece_points - 1) / scan::piece_points;
  min_distance_result result;
  if (cloud.pieces().empty()) {
    std::vector<scan::boxed_piece> seen(pieces);
    search(cloud.all(), result, &seen);
    cloud.keep(std::move(seen));
    return result;
  }
  // The balls include the errors of arithmetic and poses. What a source has lost does not matter here.
  const frames::cloud_frame frame(facts, poses, pose);
  std::vector<std::size_t> nearest(facts.size(), pieces);
  std::vector<double> least(facts.size(), double(infinity));
  for (std::size_t k = 0; k < pieces; ++k)
    if (!cloud.pieces()[k].empty())
      for (std::size_t part = 0; part < facts.size(); ++part)
        if (const double its = scan::away(frame.places[part].around, cloud.pieces()[k], frame.origin);
            its < least[part])
          least[part] = its, nearest[part] = k;
  if (minima.empty()) {  // the robot's nearest box is enough
    const auto best = std::size_t(std::ranges::min_element(least) - least.begin());
    nearest = {nearest[best]};
  }
  std::ranges::sort(nearest);
  nearest.erase(std::unique(nearest.begin(), nearest.end()), nearest.end());
  std::vector<point_range> first;
  for (const std::size_t k : nearest)
    if (k != pieces) first.push_back(cloud.piece(k));
  search(first, result, nullptr);
  std::vector<real> reach(facts.size(), result.part == none ? infinity : result.distance);
  for (std::size_t part = 0; part < minima.size(); ++part) reach[part] = minima[part].distance;
  const auto matters = [&](const scan::boxed_piece& seen) {
    const extent box = seen.box_from(frame.origin);
    for (std::size_t part = 0; part < facts.size(); ++part)
      if (scan::may_reach(frame.places[part].around, reach[part] + seen.wide, box)) return true;
    return false;
  };
  search(cloud.where(matters), result, nullptr);
  // Counts are those of the whole cloud.
  const point_counts counts = cloud.counts();
  result.seen = counts.seen, result.valid = counts.valid;
  std::ranges::copy(counts.dropped, result.dropped);
  allow_for_too_close(result);
  return result;
}

}  // namespace minimum

}  // namespace clearance
