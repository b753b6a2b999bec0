// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks for the least distance on one backend, frame after frame.

#include <clearance/backends/kept_memory.hpp>
#include <clearance/backends/readback.hpp>
#include <clearance/frames/readable.hpp>
#include <clearance/minimum/host_search.hpp>

namespace clearance::minimum {

/// Where a question about the least distance writes: `Q::per_part` decides whether also every part's.
template <class Q>
auto minima_of(const typename Q::out& to) {
  if constexpr (Q::per_part)
    return std::pair(to.result, to.minima);
  else
    return std::pair(to, static_cast<part_minimum*>(nullptr));
}

/// For a backend without a search of its own: a loop over points, which keeps nothing from frame to frame.
template <class On, class PartView, class Q>
class engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : parts_(model.size()), memory_(on, from...), back_(on, from...), readable_(on, from...), search_(on, model) {}

  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&) {
    memory_.begin();
    there_ = memory_.template space<min_distance_result>(1).data();
    minima_ = Q::per_part ? memory_.template space<part_minimum>(parts_).data() : nullptr;
    search_(poses, readable_(clouds), there_, minima_);
  }
  const typename Q::result& finish() {
    if constexpr (Q::per_part)
      back_(backends::read_value<min_distance_result>{result_.all, there_},
            backends::read_array{result_.parts, minima_, parts_});
    else
      back_(backends::read_value<min_distance_result>{result_, there_});
    return result_;
  }
  template <class Clouds>
  void start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&, const typename Q::out& to) {
    const auto [result, minima] = minima_of<Q>(to);
    search_(poses, clouds, result, minima);
  }
  void forget() const {}

 private:
  std::size_t parts_;
  backends::kept_memory<On> memory_;
  backends::readback<On> back_;
  frames::readable_clouds<On> readable_;
  plain_search<On, PartView> search_;
  min_distance_result* there_ = nullptr;
  part_minimum* minima_ = nullptr;
  typename Q::result result_;
};

/// On the CPU, with any tree. After the first frames of a size it allocates nothing.
template <class PartView, class Q>
class engine<host, PartView, Q> {
 public:
  engine(const host& on, const model_view<PartView>& model) : search_(on, model) {}

  /// A host has nothing to wait for.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&) {
    if constexpr (Q::per_part) {
      result_.parts.resize(search_.parts());
      search_(poses, clouds, &result_.all, result_.parts.data());
    } else {
      search_(poses, clouds, &result_);
    }
  }
  const typename Q::result& finish() const { return result_; }
  template <class Clouds>
  void start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q&, const typename Q::out& to) {
    const auto [result, minima] = minima_of<Q>(to);
    search_(poses, clouds, result, minima);
  }

  /// For the next frame only: pairs farther than `within` metres need not be found, unless they may decide what is
  /// certain. If none is found, the answer has no witness and the state `no_data`, whatever points there were.
  void bound_by(real within)
    requires(!Q::per_part)
  {
    search_.bound_by(within);
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  host_search<PartView> search_;
  typename Q::result result_;
};

}  // namespace clearance::minimum
