// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points on a host that lie together. Loops over them become vector code.

#include <clearance/points/extremes.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/packet.hpp>
#include <clearance/scan/side_by_side.hpp>
#include <clearance/scan/yardstick.hpp>

namespace clearance::scan {

/// Up to 64 points in the cloud's frame, with what is nearest to each: `within` metres. Lanes without a point have a
/// reach of minus infinity.
struct neighbours : packet<64> {
  static constexpr std::size_t most = 64, block = 32;  ///< A block's points are tested together.
  std::uint32_t count = 0;
  std::uint32_t part[most], primitive[most];

  void add(vec3 p, real reach) {
    part[count] = primitive[count] = none;
    put(count++, p, reach);
  }
  /// After the last point.
  void fill() {
    for (std::size_t j = count; j < most; ++j) put(j, (*this)[0], -infinity), part[j] = primitive[j] = none;
  }
  real reach() const {
    real largest = -infinity;
    for (std::size_t j = 0; j < count; ++j) largest = max(largest, within[j]);
    return largest;
  }

  /// Keeps the nearer one; of equally near ones the lowest part, and of that the lowest primitive. Without branches.
  void offer(std::size_t j, real distance, std::uint32_t k, std::uint32_t id) {
    const auto first = int(k < part[j]) | (int(k == part[j]) & int(id < primitive[j]));
    const bool nearer = bool(int(distance < within[j]) | (int(distance == within[j]) & first));
    within[j] = choice(nearer, distance, within[j]);
    part[j] = nearer ? k : part[j], primitive[j] = nearer ? id : primitive[j];
  }

  /// The box around them, without noise.
  surroundings surround() const {
    extent box;
    spread(x, box.lower.x, box.upper.x, most), spread(y, box.lower.y, box.upper.y, most);
    spread(z, box.lower.z, box.upper.z, most);
    const vec3 c = fma(0.5f, box.lower + box.upper, vec3{0, 0, 0});
    alignas(64) real far[block] = {};
    for (std::size_t b = 0; b < most; b += block)
      for (std::size_t l = 0; l < block; ++l) {
        const vec3 e = (*this)[b + l] - c;
        far[l] = max(far[l], e.x * e.x + e.y * e.y + e.z * e.z);
      }
    for (const real f : far) far[0] = max(far[0], f);
    const auto half = [](real low, real high, real middle) { return max(high - middle, middle - low) * (1 + slack); };
    surroundings all{};
    all.middle = c;
    all.half = {half(box.lower.x, box.upper.x, c.x), half(box.lower.y, box.upper.y, c.y),
                half(box.lower.z, box.upper.z, c.z)};
    all.radius = square_root(far[0]) * (1 + 4 * slack) + real(vanishing);
    return all;
  }

  /// Tests primitive `id` of part k exactly, block by block, where its tangent `bound` at the middle says that it may
  /// be as near as what is known. `inside`: a bit for each point that is in the part, and so has its answer.
  template <class P>
  void test(const surroundings& from, const tangent& bound, const rigid_transform& place, const P& which,
            std::uint32_t k, std::uint32_t id, std::uint64_t inside) {
    with_vectors([&] {
      const surroundings all = from;
      const tangent t = bound;
      const rigid_transform part_from_cloud = place;
      const P its = which;
      const std::uint32_t its_part = k, its_id = id;
      neighbours& n = *this;
      for (std::size_t b = 0; b < n.count; b += block) {
        std::uint32_t any = 0;
        for (std::size_t j = b; j < b + block; ++j)
          any |= std::uint32_t(all.may_reach(t.distance, t.direction, n[j] - all.middle, n.within[j]));
        if (any == 0) continue;
        alignas(64) real distance[block];
        if constexpr (rootless_primitive<P>) {
          side_by_side<decltype(its.before_root(n[0])), block> before;
          alignas(64) real square[block], root[block];
          for (std::size_t l = 0; l < block; ++l) {
            const auto half = its.before_root(part_from_cloud(n[b + l]));
            before.put(l, half), square[l] = half.squared;
          }
          square_roots<block>(square, root);
          for (std::size_t l = 0; l < block; ++l) distance[l] = before[l].distance(root[l]);
        } else {
          for (std::size_t l = 0; l < block; ++l) distance[l] = its.distance(part_from_cloud(n[b + l]));
        }
        for (std::size_t l = 0; inside != 0 && l < block; ++l)
          if ((inside >> (b + l) & 1) != 0) distance[l] = not_a_number;
        for (std::size_t l = 0; l < block; ++l) n.offer(b + l, distance[l], its_part, its_id);
      }
    });
  }
};

}  // namespace clearance::scan
