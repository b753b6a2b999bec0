// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// On a host a thread walks once for points that lie together, from their middle: in vector code over eight nodes or
// primitives at once (tangent_packets.cuh has a warp for that). Few primitives are left, and then the vectors are of
// points.

#include <clearance/frames/frame.hpp>
#include <clearance/frames/root_test.hpp>
#include <clearance/ground/math.hpp>
#include <clearance/points/extremes.hpp>
#include <clearance/result.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/scan/packet.hpp>
#include <clearance/scan/seen_memory.hpp>
#include <clearance/scan/yardstick.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace clearance::scan {

/// Values whose words lie side by side, so that a loop over them becomes vector code on a host.
template <class T, std::size_t Lanes = 8>
struct side_by_side {
  static constexpr std::size_t words = sizeof(T) / sizeof(real);
  using one = std::array<real, words>;
  alignas(64) real word[words][Lanes];

  void put(std::size_t j, const T& value) {
    const one parts = std::bit_cast<one>(value);
    for (std::size_t w = 0; w < words; ++w) word[w][j] = parts[w];
  }
  T operator[](std::size_t j) const { return at(j, std::make_index_sequence<words>{}); }

 private:
  template <std::size_t... W>
  T at(std::size_t j, std::index_sequence<W...>) const {
    return std::bit_cast<T>(one{word[W][j]...});
  }
};

/// Values that are not made of words lie where they are, and are only pointed to.
template <class T, std::size_t Lanes>
  requires(!std::is_trivially_copyable_v<T> || sizeof(T) % sizeof(real) != 0)
struct side_by_side<T, Lanes> {
  const T* value_at[Lanes];

  void put(std::size_t j, const T& value) { value_at[j] = &value; }
  const T& operator[](std::size_t j) const { return *value_at[j]; }
};

// Points on a host that lie together. Loops over them become vector code.

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
    for (std::size_t j = count; j < most; ++j) {
      put(j, (*this)[0], -infinity);
      part[j] = primitive[j] = none;
    }
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
    part[j] = nearer ? k : part[j];
    primitive[j] = nearer ? id : primitive[j];
  }

  /// The box around them, without noise.
  surroundings surround() const {
    extent box;
    spread(x, box.lower.x, box.upper.x, most);
    spread(y, box.lower.y, box.upper.y, most);
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
    surroundings around{};
    around.middle = c;
    around.half = {half(box.lower.x, box.upper.x, c.x), half(box.lower.y, box.upper.y, c.y),
                   half(box.lower.z, box.upper.z, c.z)};
    around.radius = square_root(far[0]) * (1 + 4 * slack) + real(vanishing);
    return around;
  }

  /// Tests primitive `id` of part k exactly, block by block, where its tangent `bound` at the middle says that it may
  /// be as near as what is known. `inside`: a bit for each point that is in the part, and so has its answer.
  template <class P>
  void test(const surroundings& from, const tangent& bound, const rigid_transform& place, const P& which,
            std::uint32_t k, std::uint32_t id, std::uint64_t inside) {
    with_vectors([&] {
      const surroundings around = from;
      const tangent t = bound;
      const rigid_transform part_from_cloud = place;
      const P tested = which;
      const std::uint32_t part_number = k, primitive_id = id;
      neighbours& n = *this;

      for (std::size_t b = 0; b < n.count; b += block) {
        std::uint32_t any = 0;
        for (std::size_t j = b; j < b + block; ++j)
          any |= std::uint32_t(around.may_reach(t.distance, t.direction, n[j] - around.middle, n.within[j]));
        if (any == 0) continue;

        alignas(64) real distance[block];
        if constexpr (rootless_primitive<P>) {
          side_by_side<decltype(tested.before_root(n[0])), block> before;
          alignas(64) real square[block], root[block];
          for (std::size_t l = 0; l < block; ++l) {
            const auto half = tested.before_root(part_from_cloud(n[b + l]));
            before.put(l, half);
            square[l] = half.squared;
          }
          square_roots<block>(square, root);
          for (std::size_t l = 0; l < block; ++l) distance[l] = before[l].distance(root[l]);
        } else {
          for (std::size_t l = 0; l < block; ++l) distance[l] = tested.distance(part_from_cloud(n[b + l]));
        }

        for (std::size_t l = 0; inside != 0 && l < block; ++l)
          if ((inside >> (b + l) & 1) != 0) distance[l] = not_a_number;
        for (std::size_t l = 0; l < block; ++l) n.offer(b + l, distance[l], part_number, primitive_id);
      }
    });
  }
};

/// A walk through the trees of all parts. It keeps what was near to the last points, as a first bound for the next.
template <class PartView>
class group_walk {
 public:
  group_walk(const PartView* parts, std::span<const frames::placement> places)
      : parts_(parts), places_(places), seen_(places.size()) {}

  /// Looks at points from their middle. Returns true if they lie together: much closer to one another than to the
  /// parts, or within a few centimetres; and if rounding is finer than that.
  bool look_around(neighbours& near, const std::vector<std::uint32_t>& parts) {
    near.fill();
    real gap = infinity;
    with_vectors([&] {
      around_ = near.surround();
      for (const std::uint32_t k : parts) {
        const vec3 q = places_[k].part_from_cloud(around_.middle);
        const seen_part seen(around_, places_[k].around, q);
        seen_[k] = {q, unit_way(around_.middle - places_[k].around.center).direction, seen.distance};
        gap = min(gap, seen.distance);
        around_.noise = max(around_.noise, seen.noise);
      }
    });
    const real wide = 0.02f + 0.1f * max(gap, 0);
    return around_.radius <= wide && around_.noise <= wide && gap < 1e15f;
  }

  /// Searches `parts` for what is nearest to points that lie together.
  void search(neighbours& near, const std::vector<std::uint32_t>& parts) {
    around_.best = {};
    around_.within = infinity;
    around_.set_limit(near.reach());
    inner_.clear();
    if (std::ranges::find(parts, hint_.part) != parts.end()) {
      add(hint_);
      examine(false, near);
    }
    begin(near, parts);
    while (!nodes_.empty() || batch_.count > 0) {
      if (nodes_.empty()) {
        examine(true, near);
        continue;
      }
      const pending e = nodes_.back();
      nodes_.pop_back();
      if (around_.keeps(e.distance, e.direction)) open(e, near);
    }
    measure(near);
  }

 private:
  using hierarchy = typename PartView::hierarchy_type;
  using volume_type = typename hierarchy::volume_type;
  using primitive_type = typename hierarchy::primitive_type;
  using traits = bounding_volume_traits<volume_type>;

  struct pending {
    real distance;
    vec3 direction;
    std::uint32_t part;
    bvh_node node;
  };
  struct seen_middle {
    vec3 q;    ///< In the part's frame.
    vec3 way;  ///< From the part's ball.
    real distance;
  };
  struct tangents {
    alignas(32) real distance[8], x[8], y[8], z[8];
    std::uint32_t keeps;  ///< One bit each.
  };
  static std::uint32_t together(const std::uint32_t (&bits)[8]) {
    std::uint32_t joined = 0;
    for (const std::uint32_t b : bits) joined |= b;
    return joined;
  }
  struct candidate {
    real distance;
    vec3 direction;
    primitive_of_part which;
  };

  /// Parts, the nearest on top. Points inside of them have their answers.
  void begin(neighbours& near, const std::vector<std::uint32_t>& parts) {
    for (const std::uint32_t k : parts) {
      const real d = seen_[k].distance;
      if constexpr (has_interior<PartView>)
        if (d <= around_.radius + around_.noise) find_inside(near, k);
      if (d <= around_.limit) nodes_.push_back({d, seen_[k].way, k, parts_[k].tree.nodes[0]});
    }
    std::sort(nodes_.begin(), nodes_.end(), [](const pending& a, const pending& b) { return a.distance > b.distance; });
  }
  void find_inside(neighbours& near, std::uint32_t k) {
    std::uint64_t inside = 0;
    with_vectors([&] {
      for (std::size_t j = 0; j < near.count; ++j)
        if (frames::may_reach(places_[k].around, 0, near[j]) &&
            parts_[k].interior.inside(places_[k].part_from_cloud(near[j]))) {
          inside |= std::uint64_t(1) << j;
          if (near.within[j] >= 0) near.offer(j, 0, k, none);
        }
    });
    if (inside != 0) inner_.emplace_back(k, inside);
  }

  /// Looks at a node's children.
  void open(const pending& e, neighbours& near) {
    const hierarchy& tree = parts_[e.part].tree;
    const std::size_t base = nodes_.size();
    if (e.node.is_leaf()) return take_all(e, near);
    for (std::uint32_t first = 0; first < e.node.count(); first += 8) {
      const std::uint32_t at = e.node.first + first, count = std::min(8u, e.node.count() - first);
      tangents seen;
      see(tree.volumes + at, count, e.part, seen);
      for (std::uint32_t left = seen.keeps; left != 0; left &= left - 1) {
        const auto j = std::uint32_t(std::countr_zero(left));
        const pending child{seen.distance[j], {seen.x[j], seen.y[j], seen.z[j]}, e.part, tree.nodes[at + j]};
        if (child.node.is_leaf()) {
          take_all(child, near);
          continue;
        }
        std::size_t to = nodes_.size();
        nodes_.push_back(child);
        for (; to > base && nodes_[to - 1].distance < child.distance; --to) nodes_[to] = nodes_[to - 1];
        nodes_[to] = child;
      }
    }
  }
  void see(const volume_type* volumes, std::uint32_t count, std::uint32_t k, tangents& seen) const {
    with_vectors([&] {
      side_by_side<volume_type> tested;
      for (std::uint32_t j = 0; j < 8; ++j) tested.put(j, volumes[std::min(j, count - 1)]);
      const surroundings points = around_;
      const rigid_transform part_from_cloud = places_[k].part_from_cloud;
      const vec3 q = seen_[k].q;
      tangents found;
      alignas(32) std::uint32_t keeps[8];
      for (std::size_t j = 0; j < 8; ++j) {
        const tangent t = traits::tangent_at(tested[j], q);
        const vec3 u = to_cloud(part_from_cloud, t.direction);
        found.distance[j] = t.distance;
        found.x[j] = u.x;
        found.y[j] = u.y;
        found.z[j] = u.z;
        keeps[j] = std::uint32_t(points.keeps(t.distance, u)) << j;
      }
      found.keeps = together(keeps) & ((2u << (count - 1)) - 1);
      seen = found;
    });
  }

  /// Primitives wait until there are eight of one part.
  void take_all(const pending& leaf, neighbours& near) {
    for (std::uint32_t j = 0; j < leaf.node.count(); ++j) {
      if (batch_.count > 0 && batch_.part != leaf.part) examine(true, near);
      add({leaf.part, leaf.node.first + j});
      if (batch_.count == 8) examine(true, near);
    }
  }
  void add(primitive_of_part p) {
    batch_.part = p.part;
    batch_.place[batch_.count] = p.place;
    batch_.primitives.put(batch_.count++, parts_[p.part].tree.primitives[p.place]);
  }
  /// Looks at the primitives that wait. `finds`: what may be nearest to a point becomes a candidate.
  void examine(bool finds, neighbours& near) {
    const std::uint32_t k = batch_.part, count = batch_.count;
    for (std::uint32_t j = count; j < 8; ++j) batch_.primitives.put(j, parts_[k].tree.primitives[batch_.place[0]]);
    tangents seen;
    std::uint32_t nearest = none;
    with_vectors([&] {
      surroundings points = around_;
      const rigid_transform part_from_cloud = places_[k].part_from_cloud;
      const vec3 q = seen_[k].q;
      tangents found;
      alignas(32) real most[8], bound[8], radius[8];
      const auto& waiting = batch_.primitives;

      for (std::size_t j = 0; j < 8; ++j) {
        const primitive_tangent t = waiting[j].tangent_at(q);
        const vec3 u = to_cloud(part_from_cloud, t.direction);
        found.distance[j] = t.distance;
        found.x[j] = u.x;
        found.y[j] = u.y;
        found.z[j] = u.z;
        most[j] = t.most;
        radius[j] = t.radius;
        bound[j] = yardstick(t, u, points.radius).most;
      }

      for (std::uint32_t j = 0; j < count; ++j)
        if (bound[j] < points.best.most) {
          const vec3 u{found.x[j], found.y[j], found.z[j]};
          points.best = yardstick({{found.distance[j], u}, most[j], radius[j]}, u, points.radius);
          points.within = most[j] + points.radius;
          nearest = j;
          if constexpr (has_interior<PartView>) {
            points.best.raise_to_zero(points.half);
            points.within = max(points.within, 0);
          }
        }
      if (nearest != none) {
        points.limit = min(points.limit, points.within + points.radius + points.noise);
        around_ = points;
      }

      alignas(32) std::uint32_t keeps[8];
      for (std::size_t j = 0; j < 8; ++j)
        keeps[j] = std::uint32_t(points.keeps(found.distance[j], {found.x[j], found.y[j], found.z[j]})) << j;
      found.keeps = together(keeps) & ((2u << (count - 1)) - 1);
      seen = found;
    });

    if (nearest != none) hint_ = {k, batch_.place[nearest]};
    batch_.count = 0;
    if (!finds) return;
    for (std::uint32_t left = seen.keeps; left != 0; left &= left - 1) {
      const auto j = std::uint32_t(std::countr_zero(left));
      candidates_.push_back({seen.distance[j], {seen.x[j], seen.y[j], seen.z[j]}, {k, batch_.place[j]}});
    }
    if (candidates_.size() >= most_candidates) {
      measure(near);
      around_.set_limit(near.reach());
    }
  }

  /// Each point tests the candidates that it may be nearest to, first the nearest to the middle.
  void measure(neighbours& near) {
    std::erase_if(candidates_, [&](const candidate& c) { return !around_.keeps(c.distance, c.direction); });
    std::sort(candidates_.begin(), candidates_.end(),
              [](const candidate& a, const candidate& b) { return a.distance < b.distance; });
    for (const candidate& c : candidates_) {
      const auto& [k, place] = c.which;
      std::uint64_t inside = 0;
      for (const auto& [part, bits] : inner_)
        if (part == k) inside = bits;
      const hierarchy& tree = parts_[k].tree;
      near.test(around_, {c.distance, c.direction}, places_[k].part_from_cloud, tree.primitives[place], k,
                tree.ids[place], inside);
    }
    candidates_.clear();
  }
  static constexpr std::size_t most_candidates = 256;

  const PartView* parts_;
  std::span<const frames::placement> places_;
  surroundings around_;
  std::vector<seen_middle> seen_;  ///< By part.
  std::vector<pending> nodes_;
  std::vector<candidate> candidates_;
  std::vector<std::pair<std::uint32_t, std::uint64_t>> inner_;  ///< Parts with points inside, and which.
  primitive_of_part hint_{none, 0};                             ///< What was near to the last points.
  struct {
    std::uint32_t part = none, count = 0, place[8];
    side_by_side<primitive_type> primitives;
  } batch_;
};

}  // namespace clearance::scan
