// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The order of points along a Z-curve, by one counting pass.

#include <clearance/backend/device.cuh>
#include <clearance/cloud_tree/morton.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/threads.cuh>

#include <algorithm>
#include <bit>

namespace clearance::cloud_tree {

/// Sums of counts, by CUB: device_sums.cuh, which the questions about plans include.
template <class Count>
struct device_sums;

namespace detail {

inline constexpr std::uint32_t samples = 128, grid_threads = 3 * samples;

/// Its first block makes the grid from a sample of the points: each thread finds the rank of one point along one axis.
/// The other blocks clear the counts.
template <class Source>
__global__ void __launch_bounds__(grid_threads)
    grid_kernel(const __grid_constant__ Source source, morton_grid* grid, std::uint32_t* counts, std::uint32_t cells) {
  if (blockIdx.x != 0) {
    for (std::uint32_t i = (blockIdx.x - 1) * grid_threads + threadIdx.x; i < cells;
         i += (gridDim.x - 1) * grid_threads)
      counts[i] = 0;
    return;
  }
  __shared__ real along[3][samples];
  __shared__ vec3 ends[2];
  const std::uint32_t t = threadIdx.x % samples, axis = threadIdx.x / samples;
  const std::size_t size = source.size(), stride = size < samples ? 1 : size / samples;
  sample s{{not_a_number, not_a_number, not_a_number}, drop_reason::missing};
  if (t * stride < size) s = source[t * stride];
  const real mine = s.valid() ? (&s.position.x)[axis] : not_a_number;
  along[axis][t] = mine;
  const std::uint32_t count = std::uint32_t(__syncthreads_count(s.valid())) / 3;
  if (s.valid()) {
    std::uint32_t rank = 0;
    for (std::uint32_t j = 0; j < samples; ++j) rank += along[axis][j] < mine || (along[axis][j] == mine && j < t);
    if (rank == morton_grid::low_rank(count)) (&ends[0].x)[axis] = mine;
    if (rank == morton_grid::high_rank(count)) (&ends[1].x)[axis] = mine;
  }
  __syncthreads();
  if (threadIdx.x == 0) *grid = count == 0 ? morton_grid() : morton_grid(ends[0], ends[1]);
}

inline constexpr std::uint32_t count_threads = 256;

/// A point's code, its cell, and its rank there. Which of a cell's points comes first is chance, but those of a warp
/// stay in order. Invalid points are counted in `dropped`, and in a cell after all others.
struct coded_point {
  std::uint32_t code, rank;
};
template <class Source>
__global__ void __launch_bounds__(count_threads)
    count_kernel(const __grid_constant__ Source source, const morton_grid* grid, int shift, std::uint32_t* counts,
                 coded_point* coded, scan::drop_counts* dropped) {
  const std::size_t i = blockIdx.x * std::size_t(count_threads) + threadIdx.x;
  const bool any = i < source.size();
  scan::drop_tally mine;
  std::uint32_t code = ~0u;
  if (any)
    if (const sample s = source[i]; mine.counts(s)) code = (*grid)(s.position);
  mine.add_to(*dropped);
  const std::uint32_t cell = any ? scan::lower_of(code >> shift, 1u << (3 * morton_grid::bits - shift)) : ~0u,
                      lane = threadIdx.x % 32;
  const unsigned same = __match_any_sync(scan::all_lanes, cell);
  const std::uint32_t first = std::uint32_t(__ffs(int(same))) - 1;
  std::uint32_t rank = 0;
  if (any && lane == first) rank = atomicAdd(&counts[cell], std::uint32_t(__popc(same)));
  rank = __shfl_sync(scan::all_lanes, rank, int(first)) + std::uint32_t(__popc(same & ((1u << lane) - 1)));
  if (any) coded[i] = {code, rank};
}

/// Puts each point's code and number into its place.
struct scatter_body {
  const coded_point* coded;
  const std::uint32_t* first;  ///< Of each cell.
  int shift;
  std::uint64_t* keys;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const coded_point its = coded[i];
    const std::uint32_t last = 1u << (3 * morton_grid::bits - shift), cell = its.code >> shift;
    keys[first[cell < last ? cell : last] + its.rank] = std::uint64_t(its.code) << 32 | std::uint32_t(i);
  }
};

}  // namespace detail

/// Points by cells of the curve. A block of the tree puts its own into the curve's order, so cells need not be fine.
struct counted_order {
  static constexpr bool counts = false;  ///< Invalid points were counted before.
  const std::uint64_t* keys;
  std::uint32_t count;

  /// The number of the point at position i, or none, for all threads of a block: a bitonic sort, nearly all of it
  /// within warps.
  template <unsigned Threads>
  __device__ std::uint32_t of_block(std::uint32_t i) const {
    __shared__ std::uint64_t all[Threads];
    const unsigned t = threadIdx.x;
    std::uint64_t mine = i < count ? keys[i] : ~std::uint64_t(0);
#pragma unroll
    for (unsigned size = 2; size <= Threads; size *= 2)
#pragma unroll
      for (unsigned step = size / 2; step > 0; step /= 2) {
        std::uint64_t other;
        if (step < 32) {
          other = __shfl_xor_sync(scan::all_lanes, mine, int(step));
        } else {
          __syncthreads();
          all[t] = mine;
          __syncthreads();
          other = all[t ^ step];
        }
        const bool lower = ((t & step) == 0) == ((t & size) == 0);
        if ((other < mine) == lower) mine = other;
      }
    return std::uint32_t(mine);
  }
};

/// Owns what counting takes, in memory that is kept.
class device_order {
 public:
  device_order(const device& on, std::pmr::memory_resource* memory)
      : on_(on), memory_(memory), grid_(1, on.id, memory) {}

  /// Enqueues it. Adds invalid points, which come last, to `dropped`.
  template <point_source S>
  auto build(const S& source, scan::drop_counts* dropped) {
    using sums = device_sums<std::enable_if_t<point_source<S>, std::uint32_t>>;
    const std::size_t n = source.size();
    const int bits = std::clamp(int(std::bit_width(n)) - points_of_cell, 12, 24), shift = 3 * morton_grid::bits - bits;
    const std::uint32_t cells = (1u << bits) + 1;
    grow(coded_, n), grow(keys_, n), grow(counts_, cells);
    on_.launch(detail::grid_kernel<S>, 1 + std::min(cells / 4096 + 1, 256u), detail::grid_threads, 0, source,
               grid_.data(), counts_.data(), cells);
    on_.launch(detail::count_kernel<S>, unsigned((n - 1) / detail::count_threads + 1), detail::count_threads, 0, source,
               grid_.data(), shift, counts_.data(), coded_.data(), dropped);
    add_up<sums>(cells);
    on_.for_each(n, detail::scatter_body{coded_.data(), counts_.data(), shift, keys_.data()});
    return counted_order{keys_.data(), std::uint32_t(n)};
  }

 private:
  static constexpr int points_of_cell = 3;  ///< The logarithm: how many there are on average, or half as many.

  template <class Sums>
  void add_up(std::uint32_t cells) {
    const device_guard guard(on_.id);
    std::size_t bytes = room_.size();
    if (cells > cells_) {
      Sums::exclusive(nullptr, bytes, counts_.data(), cells, on_.stream);
      grow(room_, bytes), cells_ = cells, bytes = room_.size();
    }
    Sums::exclusive(room_.data(), bytes, counts_.data(), cells, on_.stream);
  }
  template <class T>
  void grow(device_buffer<T>& buffer, std::size_t n) const {
    if (buffer.size() < n) buffer = device_buffer<T>(n, on_.id, memory_);
  }

  device on_;
  std::pmr::memory_resource* memory_;
  device_buffer<morton_grid> grid_;
  device_buffer<detail::coded_point> coded_;
  device_buffer<std::uint32_t> counts_;
  device_buffer<std::uint64_t> keys_;
  device_buffer<std::byte> room_;
  std::uint32_t cells_ = 0;
};

}  // namespace clearance::cloud_tree
