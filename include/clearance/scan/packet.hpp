// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Neighbouring points that walk a tree together on the host. Loops over them become vector code.

#include <clearance/ground/vectors.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/visitor/nearest.hpp>

#include <algorithm>

namespace clearance::scan {

/// May something in a volume be within reach? Asks the volume's fastest test.
template <bounding_volume V>
CLEARANCE_HD bool may_reach(const V& v, vec3 q, real reach) {
  if constexpr (rootless_volume<V>)
    return bounding_volume_traits<V>::may_reach(v, q, reach);
  else
    return bounding_volume_traits<V>::lower_bound(v, q) <= reach;
}

/// Points, and how near something must be to each. NaN means no point.
template <std::size_t Lanes>
struct packet {
  alignas(64) real x[Lanes], y[Lanes], z[Lanes], within[Lanes];

  vec3 operator[](std::size_t j) const { return {x[j], y[j], z[j]}; }
  void put(std::size_t j, vec3 p, real reach) {
    x[j] = p.x;
    y[j] = p.y;
    z[j] = p.z;
    within[j] = reach;
  }

  /// Marks the lanes that something in a volume may be within reach of. Returns true if there are any.
  template <class V>
  bool mark(const V& volume, std::uint32_t (&near)[Lanes]) const {
    for (std::size_t j = 0; j < Lanes; ++j) near[j] = may_reach(volume, (*this)[j], within[j]);
    std::uint32_t any = 0;
    for (std::size_t j = 0; j < Lanes; ++j) any |= near[j];
    return any != 0;
  }
};

/// Where a tree has a primitive.
template <hierarchy H>
struct primitive_place {
  typename H::node_type leaf;
  std::uint32_t number;

  decltype(auto) in(const H& tree) const { return tree.primitive(leaf, number); }
};

/// Points in a part's frame, and each one's nearest primitive so far, as the visitor `nearest` keeps it.
template <hierarchy H, std::size_t Lanes>
struct walking_packet : packet<Lanes> {
  using packet<Lanes>::within;

  std::uint32_t best[Lanes];
  primitive_place<H> where[Lanes] = {};  ///< The place of `best`.

  walking_packet() { std::fill_n(best, Lanes, nearest::none); }

  /// Shows each lane what is within its reach. Children go in the order of lane `lead`. `pending` has
  /// `stack_need(tree)` entries.
  void walk(const H& tree, std::size_t lead, near_first::entry_of<H>* pending) {
    std::uint32_t count = 0;
    pending[count++] = {0, tree.root()};
    for (bool tested = false; count > 0;) {
      const auto node = pending[--count].node;
      if (!tested && !reaches(tree.volume(node))) continue;  // the reaches may have shrunk since
      tested = false;
      if (tree.is_leaf(node)) {
        offer(tree, node);
        continue;
      }
      const std::uint32_t base = count, size = tree.size(node);
      for (std::uint32_t k = 0; k < size; ++k) {
        const auto c = tree.child(node, k);
        const typename H::volume_type& volume = tree.volume(c);
        if (!reaches(volume)) continue;
        near_first::push<H>(pending, base, count,
                            {bounding_volume_traits<typename H::volume_type>::lower_bound(volume, (*this)[lead]), c});
      }
      tested = count > base;
    }
  }

 private:
  template <class V>
  bool reaches(const V& volume) const {
    std::uint32_t near[Lanes];
    return this->mark(volume, near);
  }
  void offer(const H& tree, typename H::node_type leaf) {
    std::uint32_t near[Lanes], list[Lanes], count = 0;
    this->mark(tree.volume(leaf), near);
    const auto gather = [&] {
      count = 0;
      for (std::size_t j = 0; j < Lanes; ++j) {
        list[count] = std::uint32_t(j);
        count += near[j];
      }
    };
    gather();

    const std::uint32_t size = tree.size(leaf);
    for (std::uint32_t k = 0; k < size; ++k) {
      const typename H::primitive_type& primitive = tree.primitive(leaf, k);
      const std::uint32_t id = tree.id(leaf, k);
      if constexpr (foreseen_primitive<typename H::primitive_type>) {
        with_vectors([&] {
          for (std::size_t j = 0; j < Lanes; ++j) near[j] = primitive.may_reach((*this)[j], within[j]);
        });
        gather();
      }

      for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t j = list[n];
        nearest so_far{within[j], best[j]};
        so_far.offer(id, primitive.distance((*this)[j]));
        if (so_far.best != best[j]) where[j] = {leaf, k};
        within[j] = so_far.within;
        best[j] = so_far.best;
      }
    }
  }
};

}  // namespace clearance::scan
