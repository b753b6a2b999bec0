// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A cloud in one kernel. It finds a first bound, reads every point once and tests it against the parts' balls in the
// cloud's frame. The few near points go to the trees. The last block to finish writes the answer.

#include <clearance/backends/own_stream.cuh>
#include <clearance/scan/filter.cuh>
#include <clearance/scan/finish.cuh>
#include <clearance/scan/reader.cuh>

namespace clearance::scan {

// Reads points of fetched sources one round ahead, with few wide loads.

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
  __device__ quad_points points_of(std::uint32_t) { return {}; }
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
  __device__ quad_points points_of(std::uint32_t round) {
    const typename Source::four now = next_;
    fetch(round + 1);
    return unpacked(now, all_.index(round));
  }
  /// The first round's points, before they are taken.
  __device__ quad_points peek() const { return unpacked(next_, all_.index(0)); }

 private:
  __device__ quad_points unpacked(const typename Source::four& four, std::uint32_t first) const {
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

/// After how many rounds the block synchronizes, by how full the table of pairs became last time.
CLEARANCE_HD constexpr std::uint32_t rounds_of_batch(std::uint32_t pairs, std::uint32_t capacity) {
  return pairs <= capacity / 8 ? 32 : pairs <= capacity / 4 ? 16 : 8;
}

template <class Tally, class Source>
__global__ void __launch_bounds__(block_threads, 2)
    scan_kernel(const __grid_constant__ Source source, const __grid_constant__ scan_arguments<Tally> a) {
  using pairs = pair_search<Tally>;
  auto& s = memory_of_block<Tally>();
  const std::uint32_t t = threadIdx.x, rounds = a.rounds, ahead = a.ahead, clusters = (a.parts + cluster - 1) / cluster;
  start_early();
  typename Tally::seeds before(a);
  const cards<Tally> all(rounds);
  point_reader<Source, Tally> reader(source, ahead, all);

  pairs::prepare(a, [&] {
    reader.fetch(0);
    before.seed_from(a, source);
  });
  before.seed(a);
  __syncthreads();
  std::uint32_t bound = Tally::seeds::found(a.parts);
  pairs::fetch_tops(a.parts);

  const bool cold = bound == no_bound;
  if (cold && rounds > 0) {
    __pipeline_wait_prior(0);
    __syncthreads();  // the tops have arrived
    quad_points p = ahead > 0 ? reader.peek() : look_closely(source, a.points, all.index(0));
    if (s.shifted) shift<Tally>(p);
    Tally::seed_cold(p);
    __syncthreads();
    bound = Tally::common_bound(s);
  }

  // Everything that these loops call is inlined: what lives across a call would be kept in memory, for every point. A
  // warp that finds no room for a pair stops, and goes on from there when the table of pairs is empty.
  drop_counter dropped;
  unfinished left;
  std::uint32_t r = 0, end = 0, batch = cold ? 8 : 16;
  for (bool crowd = false; crowd || end < rounds;) {
    sharpen<Tally>(t, bound);
    __syncthreads();
    const bool shifted = s.shifted;
    if (!crowd) end = rounds - end < batch ? rounds : end + batch;

#pragma unroll 1
    for (; r < end; ++r) {
      const bool again = left.clusters != 0;
      const auto points_now = [&] {
        if constexpr (Tally::goes_ahead) return look_wide(source, a.points, all.index(r));
        return look_closely(source, a.points, all.index(r));
      };
      quad_points p = r < ahead && !again ? reader.points_of(r) : points_now();
      if (p.reasons != 0 && !again) dropped.add(p.reasons, s.dropped);
      if (!again) Tally::meet(s, p.reasons, all.index(r));
      if (shifted) shift<Tally>(p);
      if (!hand_over<Tally>(p, [&] { return all.index(r); }, clusters, left)) break;
    }

    __pipeline_wait_prior(0);  // the tops have arrived
    dropped.report(s.dropped);
    __syncthreads();
    const std::uint32_t found = s.pairs;
    crowd = found > pair_capacity;
    if (end == rounds || found > pair_capacity * 3 / 4) pairs::drain(found);
    bound = Tally::common_bound(s);
    batch = rounds_of_batch(found, pair_capacity);
  }

  if (rounds == 0) __pipeline_wait_prior(0);
  finish_block<Tally>(a, source);
}

/// How this scan is launched.
struct by_pairs {
  static constexpr std::uint32_t in_block = in_block_round;  ///< Points that a block takes at once.

  template <class Tally, class Source>
  static auto kernel() {
    return scan_kernel<Tally, Source>;
  }

  template <class Tally, class Source>
  static void plan(const Source& source, scan_arguments<Tally>& a, unsigned blocks) {
    a.rounds = (a.points + in_block * blocks - 1) / (in_block * blocks);
    a.ahead = rounds_ahead(source, a.points, blocks);
  }
};

/// By pairs, with fewer points per block, so that small clouds also fill the device. It is for answers that want many
/// pairs: a pair takes longer than reading its point.
struct by_many_pairs : by_pairs {
  static constexpr std::uint32_t in_block = in_block_round / 2;
};

}  // namespace clearance::scan
