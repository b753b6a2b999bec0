// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree over a cloud on a device.

#include <clearance/backend/device.cuh>
#include <clearance/cloud_tree/counted_order.cuh>
#include <clearance/cloud_tree/pixel_order.hpp>
#include <clearance/cloud_tree/tree_view.hpp>

namespace clearance::cloud_tree {

namespace detail {

/// The arrays of a tree, to be written.
struct tree_room {
  numbered_point* points;
  ball* balls;
  std::uint32_t* least;
  extent* boxes;
  std::uint32_t* done;   ///< Blocks that made their tiles.
  real *radii, *widest;  ///< Only over balls.
};

inline constexpr std::uint32_t siblings = 8;  ///< So many lanes make one node, from one child each.

template <class T, class F>
__device__ T of_siblings(T mine, F f) {
#pragma unroll
  for (int step = siblings / 2; step > 0; step /= 2) mine = f(mine, __shfl_xor_sync(scan::all_lanes, mine, step));
  return mine;
}

/// Writes a node around what the sibling lanes have: one box each, which may be empty, and `reach(center)`, how far its
/// content goes. A node without content gets a ball that nothing is near. All lanes of a warp call it; it writes
/// nothing where `node` is none.
template <class Reach>
__device__ void put_node(const tree_room& to, std::uint32_t node, const extent& mine, std::uint32_t least,
                         Reach reach) {
  const auto low = [](real x) { return of_siblings(x, [](real a, real b) { return min(a, b); }); };
  const auto high = [](real x) { return of_siblings(x, [](real a, real b) { return max(a, b); }); };
  const extent box{{low(mine.lower.x), low(mine.lower.y), low(mine.lower.z)},
                   {high(mine.upper.x), high(mine.upper.y), high(mine.upper.z)}};
  const bool nothing = !(box.lower.x <= box.upper.x);
  const vec3 center = nothing ? vec3{0, 0, 0} : middle(box);
  const real radius = high(mine.lower.x <= mine.upper.x ? reach(center) : -infinity);
  least = of_siblings(least, [](std::uint32_t a, std::uint32_t b) { return a < b ? a : b; });
  if (threadIdx.x % siblings != 0 || node == none) return;
  to.boxes[node] = box, to.balls[node] = {center, nothing ? -infinity : min(radius, farthest(box, center))},
  to.least[node] = least;
}

/// Writes the greatest radius of what the sibling lanes have, as put_node.
__device__ inline void put_widest(const tree_room& to, std::uint32_t node, real mine) {
  const real most = of_siblings(mine, [](real a, real b) { return max(a, b); });
  if (threadIdx.x % siblings == 0 && node != none) to.widest[node] = most;
}

/// Writes a node above the tiles around its children. `child`: a node of the level below, or none. A whole warp calls
/// it.
template <class Tree>
__device__ void put_parent(const Tree& tree, std::uint32_t level, std::uint32_t child, const tree_room& to) {
  static_assert(Tree::fan == siblings);
  extent box;
  ball b{{0, 0, 0}, -infinity};
  std::uint32_t least = ~0u;
  if (child < tree.size(level - 1)) {
    const std::uint32_t at = tree.begin[level - 1] + child;
    box = to.boxes[at], b = to.balls[at], least = to.least[at];
  }
  const std::uint32_t number = child == none ? none : child / siblings,
                      node = number < tree.size(level) ? tree.begin[level] + number : none;
  if constexpr (Tree::of_balls)
    put_widest(to, node, child < tree.size(level - 1) ? to.widest[tree.begin[level - 1] + child] : 0);
  put_node(to, node, box, least,
           [&](vec3 center) { return (rough_length_up(b.center - center) + b.radius) * (1 + slack); });
}

/// Makes all levels from `level` on, by one block.
template <class Tree>
__device__ void put_top(const Tree& tree, std::uint32_t level, const tree_room& to) {
  for (; level < tree.levels; ++level, __syncthreads())
    for (std::uint32_t first = 0, size = tree.size(level - 1); first < size; first += blockDim.x)
      put_parent(tree, level, first + threadIdx.x, to);
}

inline constexpr std::uint32_t tile_threads =
    siblings * siblings * siblings;                 ///< Points per block, which makes the first three levels.
inline constexpr std::uint32_t most_below = 16384;  ///< One block makes all that is above so many nodes.

/// `order.of_block(i)` is the number of the point at position i, or none. The last block makes what is above a third
/// level of few nodes.
template <class Source, class Tree, class Order>
__global__ void __launch_bounds__(tile_threads)
    tile_kernel(const __grid_constant__ Source source, const __grid_constant__ Tree tree,
                const __grid_constant__ Order order, const tree_room to, scan::drop_counts* dropped) {
  static_assert(Tree::tile == siblings);
  const std::uint32_t t = threadIdx.x, i = blockIdx.x * tile_threads + t, tile = i / siblings;
  numbered_point p{{not_a_number, not_a_number, not_a_number}, ~0u};
  extent box;
  scan::drop_tally mine;
  const std::uint32_t number = order.template of_block<tile_threads>(i);
  [[maybe_unused]] real radius = 0;
  if (i < tree.count) {
    if (number != none) {
      const sample s = source[number];
      if (Order::counts ? mine.counts(s) : s.valid()) {
        p = {s.position, number}, box.add(s.position);
        if constexpr (Tree::of_balls) radius = source.around(number, s.position).radius;
      }
    }
    to.points[i] = p;
    if constexpr (Tree::of_balls) to.radii[i] = radius;
  }
  if constexpr (Order::counts) mine.add_to(*dropped);
  __syncwarp();
  if constexpr (Tree::of_balls) put_widest(to, tile < tree.size(0) ? tile : none, radius);
  put_node(to, tile < tree.size(0) ? tile : none, box, p.number,
           [&](vec3 center) { return rough_length_up(p.at - center); });
  for (std::uint32_t level = 1, children = tile_threads / siblings; level < 3 && level < tree.levels;
       ++level, children /= siblings) {
    __syncthreads();
    if (t < children || t < 32) put_parent(tree, level, t < children ? blockIdx.x * children + t : none, to);
  }
  if (tree.levels <= 3 || tree.size(2) > most_below) return;
  __shared__ bool last;
  __syncthreads();
  if (t == 0) last = scan::count_in(*to.done) == gridDim.x - 1;
  __syncthreads();
  if (!last) return;
  if (t == 0) *to.done = 0;
  put_top(tree, 3, to);
}

/// Makes one level.
template <class Tree>
__global__ void __launch_bounds__(256)
    node_kernel(const __grid_constant__ Tree tree, std::uint32_t level, const tree_room to) {
  put_parent(tree, level, blockIdx.x * 256 + threadIdx.x, to);
}
template <class Tree>
__global__ void __launch_bounds__(1024)
    top_kernel(const __grid_constant__ Tree tree, std::uint32_t level, const tree_room to) {
  put_top(tree, level, to);
}

}  // namespace detail

/// Owns a tree that is built anew for every frame, in memory that is kept. Invalid points stay among the others as NaN,
/// so the shape is known before they are read and nothing waits. Images become pyramids; other points go along a
/// Z-curve.
class device_tree {
 public:
  using view_type = tree_view<8, 8>;

  explicit device_tree(const device& on, std::pmr::memory_resource* memory = nullptr)
      : on_(on), memory_(memory), order_(on, memory), done_(1, on.id, memory) {
    const device_guard guard(on_.id);
    check_cuda(cudaMemsetAsync(done_.data(), 0, sizeof(std::uint32_t), on_.stream), "cudaMemsetAsync");
  }

  /// Enqueues it. Adds invalid points to `dropped`. The device must be able to read the source as it is.
  template <point_source S>
  void build(const S& source, scan::drop_counts* dropped) {
    static_assert(points_or_balls<S>());
    const std::size_t n = source.size();
    if constexpr (image_source<S>) {
      const pixel_order pixels(std::uint32_t(n), n == 0 ? 0 : source.columns());
      if (pixels.positions() != 0 &&
          pixels.positions() / 4 <= n)  // of few rows, most places would lie beyond the image
        return put_up(source, view_type(pixels.positions()), pixels, dropped);
    }
    const view_type shape(static_cast<std::uint32_t>(n));
    if (n == 0) return void(view_ = shape);
    put_up(source, shape, order_.build(source, dropped), dropped);
  }
  const view_type& view() const { return view_; }
  /// If it was built over such a source.
  template <point_source S>
  auto view_of() const {
    return view_over<S>(view_, radii_.data(), widest_.data());
  }

 private:
  /// Makes the tiles and nodes of a tree of that shape, over points in that order.
  template <class S, class Order>
  void put_up(const S& source, const view_type& shape, const Order& order, scan::drop_counts* dropped) {
    view_ = shape;
    grow(points_, view_.count), grow(balls_, view_.nodes()), grow(least_, view_.nodes()), grow(boxes_, view_.nodes());
    view_.points = points_.data(), view_.balls = balls_.data(), view_.boxes = boxes_.data(),
    view_.least = least_.data();
    if constexpr (ball_source<S>) grow(radii_, view_.count), grow(widest_, view_.nodes());
    const auto tree = view_of<S>();
    using tree_type = std::remove_const_t<decltype(tree)>;
    const detail::tree_room to{points_.data(), balls_.data(), least_.data(), boxes_.data(),
                               done_.data(),   radii_.data(), widest_.data()};
    const unsigned blocks = (tree.count - 1) / detail::tile_threads + 1;
    on_.launch(detail::tile_kernel<S, tree_type, Order>, blocks, detail::tile_threads, 0, source, tree, order, to,
               dropped);
    if (tree.levels <= 3 || tree.size(2) <= detail::most_below) return;
    std::uint32_t level = 3;
    for (; level < tree.levels && tree.size(level - 1) > detail::most_below; ++level)
      on_.launch(detail::node_kernel<tree_type>, (tree.size(level - 1) - 1) / 256 + 1, 256, 0, tree, level, to);
    if (level < tree.levels) on_.launch(detail::top_kernel<tree_type>, 1, 1024, 0, tree, level, to);
  }

  template <class T>
  void grow(device_buffer<T>& buffer, std::size_t n) const {
    if (buffer.size() < n) buffer = device_buffer<T>(n, on_.id, memory_);
  }

  device on_;
  std::pmr::memory_resource* memory_;
  view_type view_;
  device_order order_;
  device_buffer<std::uint32_t> done_, least_;
  device_buffer<numbered_point> points_;
  device_buffer<ball> balls_;
  device_buffer<real> radii_, widest_;  // of balls
  device_buffer<extent> boxes_;
};

}  // namespace clearance::cloud_tree
