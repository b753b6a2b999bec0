// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree over a cloud on a device.

#include <clearance/backends/device.cuh>
#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/threads.cuh>

#include <algorithm>
#include <bit>

namespace clearance::cloud_tree {

// The order of points along a Z-curve, by one counting pass.

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
    grow(coded_, n);
    grow(keys_, n);
    grow(counts_, cells);
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
      grow(room_, bytes);
      cells_ = cells;
      bytes = room_.size();
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
  to.boxes[node] = box;
  to.balls[node] = {center, nothing ? -infinity : min(radius, farthest(box, center))};
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
    box = to.boxes[at];
    b = to.balls[at];
    least = to.least[at];
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
        p = {s.position, number};
        box.add(s.position);
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
    grow(points_, view_.count);
    grow(balls_, view_.nodes());
    grow(least_, view_.nodes());
    grow(boxes_, view_.nodes());
    view_.points = points_.data();
    view_.balls = balls_.data();
    view_.boxes = boxes_.data();
    view_.least = least_.data();
    if constexpr (ball_source<S>) {
      grow(radii_, view_.count);
      grow(widest_, view_.nodes());
    }
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
