// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Boxes around neighbouring points of a cloud on a device, one block per piece.

#include <clearance/backend/device.cuh>
#include <clearance/scan/boxes.hpp>

namespace clearance::scan {

inline constexpr unsigned boxing_threads = 256;

template <class S>
__global__ void __launch_bounds__(boxing_threads) box_pieces(const __grid_constant__ S source, boxed_piece* pieces) {
  constexpr unsigned warps = boxing_threads / 32, words = sizeof(boxed_piece) / 4;
  static_assert(sizeof(boxed_piece) == 4 * words && std::is_trivially_copyable_v<boxed_piece>);
  const auto others = [](const boxed_piece& mine, unsigned step) {
    boxed_piece other;
    const auto* from = reinterpret_cast<const unsigned*>(&mine);
    auto* to = reinterpret_cast<unsigned*>(&other);
#pragma unroll
    for (unsigned w = 0; w < words; ++w) to[w] = __shfl_xor_sync(~0u, from[w], step);
    return other;
  };
  const std::size_t begin = blockIdx.x * piece_points, all = source.size(),
                    end = all - begin < piece_points ? all : begin + piece_points;
  boxed_piece mine;
  for (std::size_t i = begin + threadIdx.x; i < end; i += boxing_threads) mine.add(source, i);
  for (unsigned step = 16; step != 0; step /= 2) {
    const boxed_piece other = others(mine, step);
    mine.add(other);
  }
  __shared__ unsigned of_warp[warps][words];
  if (threadIdx.x % 32 == 0) memcpy(of_warp[threadIdx.x / 32], &mine, sizeof mine);
  __syncthreads();
  if (threadIdx.x != 0) return;
  for (unsigned w = 1; w < warps; ++w) {
    boxed_piece other;
    memcpy(&other, of_warp[w], sizeof other);
    mine.add(other);
  }
  pieces[blockIdx.x] = mine;
}

/// Enqueues it. Writes `pieces` on the device: one per `piece_points` of the source.
template <point_source S>
void enqueue_boxes(const device& on, const S& source, boxed_piece* pieces) {
  if (source.size() != 0)
    on.launch(box_pieces<S>, unsigned((source.size() + piece_points - 1) / piece_points), boxing_threads, 0, source,
              pieces);
}

}  // namespace clearance::scan
