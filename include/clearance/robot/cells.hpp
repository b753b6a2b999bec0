// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which primitives of a part can be nearest to a position: one look into an octree whose leaves list them.

#include <clearance/ground/read_only.hpp>
#include <clearance/robot/part.hpp>

namespace clearance {

/// A tree that cells can stand for: one in arrays, of primitives that tell their cores.
template <class H>
concept cored_hierarchy = array_hierarchy<H> && cored_primitive<typename H::primitive_type>;

/// A primitive that can be nearest to some position of a leaf: its place in the tree's array, and its tangent at the
/// leaf's middle.
struct alignas(16) cell_entry {
  std::uint32_t place;
  real distance;
  std::uint16_t way[3];  ///< From -32767 to 32767, plus 32768.
  std::uint16_t unused;

  CLEARANCE_HD real lower_bound(vec3 from_middle) const {
    return fma(1.0f / 32767, dot({along(way[0]), along(way[1]), along(way[2])}, from_middle), distance);
  }

 private:
  /// As the last digits of a float, because a device converts integers slowly.
  static CLEARANCE_HD real along(std::uint16_t w) {
#if defined(__CUDA_ARCH__)
    return __uint_as_float(0x4b000000u | w) - 8421376.0f;
#else
    return real(int(w) - 32768);
#endif
  }
};

enum class cell_kind : std::uint8_t {
  unlisted,  ///< Too many primitives can be nearest. Walk the tree.
  list,      ///< `count` entries from `first` on, the nearest to the leaf's middle first.
  inside,    ///< All positions are inside the part's solid.
  inner,     ///< Eight children from `first` on; child 1 is towards x, 2 towards y, 4 towards z.
};

struct alignas(8) cell_node {
  std::uint32_t first = 0;
  std::uint16_t count = 0;
  cell_kind kind = cell_kind::unlisted;
  bool outside = false;  ///< All positions of a leaf are outside the part's solid.
};

/// A leaf, as a position in it sees it.
struct cell_leaf {
  cell_node node;
  vec3 from_middle;
  real away = 0;  ///< At least as long as `from_middle`, and as its product with a tangent's direction.
};

/// A primitive of a leaf's list. Law: its computed distance from the leaf's position is at least `low`, and that of all
/// that follow it at least `rest`.
struct cell_candidate {
  std::uint32_t place;  ///< In the tree's array of primitives.
  real low, rest;
};

/// An octree over a cube around a part; or nothing, and no cell is listed.
///
/// Law: of a position in a leaf that is listed, the list contains every primitive whose computed distance is the least.
/// Law: where a side is known, the solid's `inside(q)` says the same.
struct cells_view {
  /// The first nodes are a table of all cells of this level.
  static constexpr std::uint32_t top = 5, deepest = 10;
  static constexpr std::uint32_t in_table = 1u << 3 * top;

  const cell_node* nodes = nullptr;
  const cell_entry* entries = nullptr;
  vec3 low = {};     ///< The cube's lowest corner,
  real step = 0;     ///< the side of a cell of the deepest level,
  real inverse = 0;  ///< and one over it.

  /// The middle of the cell at x, y, z of the cells 2^up times as wide as the deepest ones.
  CLEARANCE_HD vec3 middle(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t up) const {
    const real half = real(1u << up) / 2;
    return {fma(step, real(x << up) + half, low.x), fma(step, real(y << up) + half, low.y),
            fma(step, real(z << up) + half, low.z)};
  }
  static CLEARANCE_HD std::uint32_t in_table_at(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (z << top | y) << top | x;
  }

  CLEARANCE_HD cell_leaf operator()(vec3 q) const {
    const vec3 at{(q.x - low.x) * inverse, (q.y - low.y) * inverse, (q.z - low.z) * inverse};
    constexpr real all = 1u << deepest;
    if (nodes == nullptr || !(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < all && at.y < all && at.z < all)) return {};
    const auto x = std::uint32_t(at.x), y = std::uint32_t(at.y), z = std::uint32_t(at.z);
    std::uint32_t up = deepest - top;
    cell_node n = read_only(nodes + in_table_at(x >> up, y >> up, z >> up));
    while (n.kind == cell_kind::inner) {
      --up;
      n = read_only(nodes + n.first + ((x >> up & 1) | (y >> up & 1) << 1 | (z >> up & 1) << 2));
    }
    const vec3 from_middle = q - middle(x >> up, y >> up, z >> up, up);
    return {n, from_middle, rough_length(from_middle) * 1.001f};
  }
  /// Number j of those that the leaf lists.
  CLEARANCE_HD cell_candidate candidate(const cell_leaf& leaf, std::uint32_t j) const {
    const cell_entry e = read_only(entries + leaf.node.first + j);
    return {e.place, e.lower_bound(leaf.from_middle), e.distance - leaf.away};
  }
};

struct cell_options {
  std::size_t bytes = std::size_t(64) << 20;  ///< Memory for each part, at most; up to 16 GiB.
  double reach = 4;                           ///< Metres around a part's ball that its cells cover.
};

/// Owns what a cells_view reads, in the memory of one backend.
template <class B = host>
struct cells {
  static_assert(backend<B>);

  typename B::template buffer<cell_node> nodes;
  typename B::template buffer<cell_entry> entries;
  cells_view shape;  ///< Its pointers are set by `view()`.
  ball around = {};  ///< The part's.

  bool empty() const { return nodes.size() == 0; }
  std::size_t bytes() const { return nodes.size() * sizeof(cell_node) + entries.size() * sizeof(cell_entry); }
  cells_view view() const {
    cells_view v = shape;
    v.nodes = nodes.data();
    v.entries = entries.data();
    return v;
  }
  template <backend Other>
  cells<Other> on(const Other& other) const {
    return {other.copy_in(std::span<const cell_node>(nodes)), other.copy_in(std::span<const cell_entry>(entries)),
            shape, around};
  }
};

/// A part and its cells as a device's kernel sees them that looks into cells. Others see the part alone.
template <class PartView>
struct celled_view : PartView {
  cells_view cells;
};

/// Does a kernel that sees such parts look into cells?
template <class PartView>
inline constexpr bool has_cells = false;
template <class PartView>
inline constexpr bool has_cells<celled_view<PartView>> = true;

}  // namespace clearance
