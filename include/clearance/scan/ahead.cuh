// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads points of fetched sources one round ahead, with few wide loads.

#include <clearance/scan/reader.cuh>

namespace clearance::scan {

/// How many rounds of all `blocks` are read ahead: those in which every thread has its points.
template <point_source Source>
std::uint32_t rounds_ahead(const Source& source, std::uint32_t points, std::uint32_t blocks) {
  if constexpr (fetched_source<Source>) return source.fetches() ? points / (in_block_round * blocks) : 0;
  return 0;
}

/// Reads points that are not read ahead; also with few wide loads, if there are four.
template <point_source Source>
__device__ quad_points look_wide(const Source& source, std::uint32_t points, std::uint32_t first) {
  if constexpr (fetched_source<Source>)
    if (source.fetches() && first < points && points - first >= quad) {
      quad_points p;
      p.reasons = source.look(source.fetch(source.seek(first)), first, p.at);
      return p;
    }
  return look_closely(source, points, first);
}

/// The rounds that are read ahead.
template <class Source, class Tally>
class point_reader {
 public:
  __device__ point_reader(const Source&, std::uint32_t, const cards<Tally>&) {}
  __device__ void fetch(std::uint32_t) {}
  __device__ quad_points take(std::uint32_t) { return {}; }
  __device__ quad_points peek() const { return {}; }
};

template <fetched_source Source, class Tally>
class point_reader<Source, Tally> {
 public:
  __device__ point_reader(const Source& source, std::uint32_t rounds, const cards<Tally>& all)
      : source_(source), rounds_(rounds), all_(all), from_(source.seek(all.index(0))) {}

  /// Starts to read the points of a round. Rounds come in order.
  __device__ void fetch(std::uint32_t round) {
    if (round < rounds_) next_ = source_.fetch(from_);
    from_ = source_.skip(from_, in_block_round * gridDim.x);
  }
  /// This thread's points of `round`. Starts to read those of the next.
  __device__ quad_points take(std::uint32_t round) {
    const typename Source::four now = next_;
    fetch(round + 1);
    return look(now, all_.index(round));
  }
  /// The first round's points, before they are taken.
  __device__ quad_points peek() const { return look(next_, all_.index(0)); }

 private:
  __device__ quad_points look(const typename Source::four& four, std::uint32_t first) const {
    quad_points p;
    p.reasons = source_.look(four, first, p.at);
    return p;
  }

  const Source& source_;
  std::uint32_t rounds_;
  const cards<Tally>& all_;
  typename Source::cursor from_;
  typename Source::four next_;
};

}  // namespace clearance::scan
