// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points on the host that walk by tangents. A few thousand points that follow one another in a cloud are put in order
// along a curve through space, so that those near to one another become groups, whatever their order was: an image's
// rows are long and narrow.

#include <clearance/cloud_tree/morton.hpp>
#include <clearance/pointwise/host_packets.hpp>
#include <clearance/scan/group_walk.hpp>

#include <utility>

namespace clearance::pointwise {

/// What one thread keeps from group to group.
template <class PartView>
class host_groups {
 public:
  host_groups(host_packets<PartView>& packets, const PartView* parts, std::span<const frames::placement> places,
              real d_max)
      : packets_(packets), walk_(parts, places), d_max_(d_max) {}

  void add(vec3 p, std::uint32_t number) { points_.push_back({p, number}), box_.add(p); }

  /// Finds what is nearest to each point that was added, and calls `take(number, found)`.
  template <class Take>
  void answer(const Take& take) {
    if (points_.empty()) return;
    if (packets_.look_around(box_)) {
      parts_.clear();
      for (const auto& [away, k] : packets_.near()) parts_.push_back(k);
      put_in_order();
      for (std::size_t i = 0; i < points_.size(); i += most) groups(i, std::min(most, points_.size() - i), take);
    } else {
      for (const auto& p : points_) take(p.number, found{});
    }
    points_.clear(), box_ = {};
  }

 private:
  static constexpr std::size_t most = scan::neighbours::most;
  static constexpr std::size_t few = 4;  ///< So few points that do not lie together walk alone.
  struct coded {
    std::uint32_t code, at;
  };
  struct numbered {
    vec3 at;
    std::uint32_t number;
  };

  /// A group, or its halves if its points do not lie together.
  template <class Take>
  void groups(std::size_t begin, std::size_t count, const Take& take) {
    scan::neighbours near;
    for (std::size_t j = 0; j < count; ++j) near.add(points_[begin + j].at, d_max_);
    if (walk_.look_around(near, parts_)) {
      walk_.search(near, parts_);
      for (std::size_t j = 0; j < count; ++j)
        take(points_[begin + j].number,
             near.part[j] == none ? found{} : found{near.within[j], near.part[j], near.primitive[j]});
    } else if (count > few) {
      groups(begin, count / 2, take), groups(begin + count / 2, count - count / 2, take);
    } else {
      found best[few];
      with_vectors([&] { packets_.ask(count, [&](std::size_t j) { return points_[begin + j].at; }, best); });
      for (std::size_t j = 0; j < count; ++j) take(points_[begin + j].number, best[j]);
    }
  }

  void put_in_order() {
    if (points_.size() <= most) return;
    const cloud_tree::morton_grid grid(box_.lower, box_.upper);
    codes_.resize(points_.size()), sorted_.resize(points_.size());
    with_vectors([&] {
      for (std::size_t i = 0; i < codes_.size(); ++i) codes_[i] = {grid(points_[i].at), std::uint32_t(i)};
    });
    constexpr int bits = cloud_tree::morton_grid::bits;
    for (int shift = 0; shift < 3 * bits; shift += bits) {
      std::uint32_t to[1 << bits] = {}, before = 0;
      const auto digit = [&](const coded& c) { return c.code >> shift & ((1 << bits) - 1); };
      for (const coded& c : codes_) ++to[digit(c)];
      for (std::uint32_t& t : to) before += std::exchange(t, before);
      for (const coded& c : codes_) sorted_[to[digit(c)]++] = c;
      codes_.swap(sorted_);
    }
    others_.clear();
    for (const coded& c : codes_) others_.push_back(points_[c.at]);
    points_.swap(others_);
  }

  host_packets<PartView>& packets_;
  scan::group_walk<PartView> walk_;
  real d_max_;
  std::vector<numbered> points_, others_;
  std::vector<coded> codes_, sorted_;
  std::vector<std::uint32_t> parts_;
  extent box_;
};

}  // namespace clearance::pointwise
