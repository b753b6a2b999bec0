// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud that is read in chunks, and the least distance from it. The first answer is a bound for what is read
// afterwards.

#include <clearance/frames/bracket.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/minimum/host_search.hpp>
#include <clearance/points/loaded.hpp>
#include <clearance/scan/boxes.hpp>

#include <future>

namespace clearance {

// A cloud that is read in chunks, and what its first reading has shown.

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
      for (int r = 1; r < drop_reasons; ++r) {
        all.dropped[r] += piece.dropped[r];
        all.valid -= piece.dropped[r];
      }
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
template <point_container C>
chunked(const C&, std::size_t = 0) -> chunked<in_memory<points_in<C>>>;

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
    iterator& operator++() {
      ++k;
      return *this;
    }
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
loaded_source<C> load_range(const C& cloud, const point_range& range, std::byte* memory) {
  const loaded_source<C> source = cloud.load(range.begin, range.end, memory);
  if (source.size() != range.end - range.begin)
    throw std::runtime_error("clearance: a cloud was to load " + std::to_string(range.end - range.begin) +
                             " points, and loaded " + std::to_string(source.size()));
  return source;
}

/// Renumbers what was found: point i of range k becomes point `number(k, i)` of the cloud.
template <class Number>
void number_as_in_cloud(min_distance_result& result, std::span<part_minimum> minima, const Number& number) {
  const auto put = [&](auto& r) {
    if (r.cloud != none) {
      r.point = number(r.cloud, r.point);
      r.cloud = 0;
    }
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
            its < least[part]) {
          least[part] = its;
          nearest[part] = k;
        }
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
  std::vector<real> extra;  // something farther may decide what is certain
  if (minima.empty()) frames::extra_reaches(facts, extra);
  for (std::size_t part = 0; part < extra.size(); ++part) reach[part] = frames::farther(reach[part], extra[part]);
  const auto matters = [&](const scan::boxed_piece& seen) {
    const extent box = seen.box_from(frame.origin);
    for (std::size_t part = 0; part < facts.size(); ++part)
      if (scan::may_reach(frame.places[part].around, reach[part] + seen.wide, box)) return true;
    return false;
  };
  search(cloud.where(matters), result, nullptr);
  // Counts are those of the whole cloud.
  const point_counts counts = cloud.counts();
  result.seen = counts.seen;
  result.valid = counts.valid;
  std::ranges::copy(counts.dropped, result.dropped);
  frames::allow_for_too_close(result);
  return result;
}

}  // namespace minimum

}  // namespace clearance

namespace clearance::minimum {

/// Asks about ranges of a chunked cloud on a backend: `(cloud, ranges, poses, pose, result, minima, seen)`. Points are
/// numbered as in the cloud. `minima` has one per part, or is empty. If `seen` is not null, it gets what was seen of
/// each piece.
template <class On, class PartView>
class chunked_search {
  static_assert(!sizeof(On), "a host or a device reads a least distance in chunks, no other backend");
};

/// On the CPU: one chunk is searched while the next is loaded. Ranges of a cloud in one place are searched as one, all
/// at once or a chunk of points at a time, because each search costs the host tens of microseconds to begin.
template <class PartView>
class chunked_search<host, PartView> {
 public:
  chunked_search(const host& on, const model_view<PartView>& model) : search_(on, model) {}

  std::size_t parts() const { return search_.parts(); }

  template <class C>
  void operator()(const chunked<C>& chunks, const std::vector<point_range>& ranges,
                  std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& pose, min_distance_result& result,
                  std::span<part_minimum> minima, std::vector<scan::boxed_piece>* seen) {
    const C& cloud = chunks.cloud();
    const std::vector<turn> turns = put_together(chunks, ranges);
    const auto load = [&](std::size_t k) { return load_part(cloud, ranges, turns[k], room_[k % 2]); };
    using part = decltype(load(0));
    std::future<part> ahead;
    const auto next = [&](std::size_t k) {
      const auto make = [&](const part& source) {
        scan::boxed_piece* const to =
            seen == nullptr || turns[k].points == 0 ? nullptr : seen->data() + numbers_[turns[k].piece];
        if constexpr (capsule_source<part>) {  // a scan sees no boxes around capsules
          if (to != nullptr) scan::box_points(source, to);
          return placed<part>{source, pose};
        } else {
          const scan::boxing<part> boxing{source, to};
          boxing.add_rest();
          return placed<scan::boxing<part>>{boxing, pose};
        }
      };
      if constexpr (requires { requires C::in_place; }) return make(load(k));
      const part source = k == 0 ? load(0) : ahead.get();
      if (k + 1 < turns.size()) ahead = std::async(std::launch::async, load, k + 1);
      return make(source);
    };
    search_(poses, as_they_come(turns.size(), next), &result, minima.empty() ? nullptr : minima.data());
    number_as_in_cloud(result, minima, [&](std::uint32_t k, std::uint32_t i) {
      return numbers_[turns[k].piece + i / scan::piece_points] * std::uint32_t(scan::piece_points) +
             i % std::uint32_t(scan::piece_points);
    });
  }

 private:
  /// Ranges that are searched as one, its pieces' numbers from `numbers_[piece]` on.
  struct turn {
    std::size_t first, last, piece, points;
  };
  template <class C>
  std::vector<turn> put_together(const chunked<C>& chunks, const std::vector<point_range>& ranges) {
    const std::size_t most = requires { requires C::in_place; } ? none : chunks.chunk();
    std::vector<turn> turns;
    numbers_.clear();
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      const std::size_t points = ranges[r].end - ranges[r].begin;
      if (!addressed_cloud<C> || turns.empty() || turns.back().points + points > most)
        turns.push_back({r, r, numbers_.size(), 0});
      turns.back().last = r + 1;
      turns.back().points += points;
      for (std::size_t at = ranges[r].begin; at < ranges[r].end; at += scan::piece_points)
        numbers_.push_back(std::uint32_t(at / scan::piece_points));
    }
    return turns;
  }

  struct alignas(64) cache_line {
    std::byte bytes[64];
  };
  template <class C>
  auto load_part(const C& cloud, const std::vector<point_range>& ranges, const turn& its,
                 std::vector<cache_line>& room) const {
    std::size_t bytes = 0;
    for (std::size_t r = its.first; r < its.last; ++r)
      bytes = std::max(bytes, cloud.bytes_for(ranges[r].end - ranges[r].begin));
    room.resize((bytes + sizeof(cache_line) - 1) / sizeof(cache_line));
    std::byte* const memory = room.empty() ? nullptr : room[0].bytes;
    if constexpr (addressed_cloud<C>) {
      for (std::size_t r = its.first; r < its.last; ++r) load_range(cloud, ranges[r], memory);
      return scan::listed_pieces<std::remove_cvref_t<decltype(cloud.whole())>>{cloud.whole(),
                                                                               numbers_.data() + its.piece, its.points};
    } else {
      return load_range(cloud, ranges[its.first], memory);
    }
  }

  host_search<PartView> search_;
  std::vector<std::uint32_t> numbers_;  ///< Of the pieces that are asked about.
  std::vector<cache_line> room_[2];
};

/// As `query`, for a chunked cloud.
template <class On, class PartView, class Q>
class chunks {
 public:
  chunks(const On& on, const model_view<PartView>& model) : facts_(model.facts), search_(on, model) {}

  template <class C>
  typename Q::result run(std::span<const Eigen::Isometry3d> poses, chunked<C>& cloud, const Eigen::Isometry3d& pose,
                         const Q&) {
    std::vector<part_minimum> minima(Q::per_part ? search_.parts() : 0);
    loaded_ = 0;
    const min_distance_result all = ask_chunked(
        cloud, facts_, poses, pose, minima,
        [&](const std::vector<point_range>& ranges, min_distance_result& result, std::vector<scan::boxed_piece>* seen) {
          search_(cloud, ranges, poses, pose, result, minima, seen);
          for (const point_range& r : ranges) loaded_ += r.end - r.begin;
        });
    if constexpr (Q::per_part)
      return {all, std::move(minima)};
    else
      return all;
  }
  std::uint64_t loaded() const { return loaded_; }

 private:
  std::span<const part_facts> facts_;
  chunked_search<On, PartView> search_;
  std::uint64_t loaded_ = 0;
};

}  // namespace clearance::minimum
