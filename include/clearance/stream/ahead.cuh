// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points that lie as one array are read a round ahead, with few wide loads.

#include <clearance/stream/parts.cuh>
#include <clearance/stream/reader.cuh>

namespace clearance::stream {

template <class Source>
struct raw_of {
  struct alignas(16) type {};
};
template <class Source>
  requires requires { typename Source::raw4; }
struct raw_of<Source> {
  using type = typename Source::raw4;
};

/// Rounds of all `blocks` that are read ahead: those in which no thread lacks a point.
template <class Source>
std::uint32_t rounds_ahead(const Source& source, std::uint32_t points, std::uint32_t blocks) {
  if constexpr (requires { typename Source::raw4; }) return source.fours() == nullptr ? 0 : points / (in_block_round * blocks);
  return 0;
}

/// The rounds that are read ahead.
template <class Source, bool Each>
class point_reader {
 public:
  using raw4 = typename raw_of<Source>::type;

  __device__ point_reader(const Source& source, std::uint32_t rounds, const cards<Each>& all) : source_(source), rounds_(rounds) {
    if constexpr (exists) from_ = source.fours() + all.index(0) / quad;
  }

  /// Starts to read the points of a round, of one after the other.
  __device__ void fetch(std::uint32_t round) {
    if constexpr (exists) {
      if (round < rounds_) next_ = far(from_);
      from_ += in_block_round / quad * gridDim.x;
    }
  }

  /// This thread's points of `round`; those of the next are on their way.
  __device__ quad_points take(std::uint32_t round, const cards<Each>& all) {
    const raw4 raw = next_;
    fetch(round + 1);
    return look(raw, all.index(round));
  }
  /// The first round's points, before they are taken.
  __device__ quad_points peek(const cards<Each>& all) const { return look(next_, all.index(0)); }

 private:
  static constexpr bool exists = requires { typename Source::raw4; };

  /// The quick way, if that suffices.
  __device__ quad_points look(const raw4& raw, std::uint32_t first) const {
    quad_points p{};
    if constexpr (exists) {
      p.reasons = source_.positions4(raw, first, p.at);
      if (p.reasons == unknown) {
        sample s[quad];
        source_.look4(raw, first, s);
        p.reasons = 0;
#pragma unroll
        for (int j = 0; j < quad; ++j) p.reasons |= unsigned(s[j].dropped) << 8 * j;
      }
    }
    return p;
  }

  const Source& source_;
  std::uint32_t rounds_;
  const raw4* from_ = nullptr;
  raw4 next_;
};

}  // namespace clearance::stream
