// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A tree over a cloud on a device.

#include <clearance/backend/device.cuh>
#include <clearance/cloud_tree/morton.hpp>
#include <clearance/cloud_tree/pixel_order.hpp>
#include <clearance/cloud_tree/tree_view.hpp>
#include <clearance/scan/drops.hpp>
#include <clearance/scan/threads.cuh>

namespace clearance::cloud_tree {

namespace detail {

inline constexpr std::uint32_t grid_threads = 3 * morton_grid::samples;

/// Makes the grid from a sample of the points, by one block. Each thread finds the rank of one point along one axis.
template <class Source>
__global__ void __launch_bounds__(grid_threads) grid_kernel(const __grid_constant__ Source source, morton_grid* grid) {
  __shared__ real along[3][morton_grid::samples];
  __shared__ vec3 ends[2];
  const std::uint32_t t = threadIdx.x % morton_grid::samples, axis = threadIdx.x / morton_grid::samples;
  const std::size_t size = source.size(), stride = size < morton_grid::samples ? 1 : size / morton_grid::samples;
  sample s{{not_a_number, not_a_number, not_a_number}, drop_reason::missing};
  if (t * stride < size) s = source[t * stride];
  const real mine = s.valid() ? (&s.position.x)[axis] : not_a_number;
  along[axis][t] = mine;
  const std::uint32_t count = std::uint32_t(__syncthreads_count(s.valid())) / 3;
  if (s.valid()) {
    std::uint32_t rank = 0;
    for (std::uint32_t j = 0; j < morton_grid::samples; ++j)
      rank += along[axis][j] < mine || (along[axis][j] == mine && j < t);
    if (rank == morton_grid::low_rank(count)) (&ends[0].x)[axis] = mine;
    if (rank == morton_grid::high_rank(count)) (&ends[1].x)[axis] = mine;
  }
  __syncthreads();
  if (threadIdx.x == 0) *grid = count == 0 ? morton_grid() : morton_grid(ends[0], ends[1]);
}

/// Finds where points are on the curve. Invalid points are counted and stay in the array.
template <point_source Source>
struct encode_body {
  Source source;
  const morton_grid* grid;
  std::uint32_t *codes, *numbers;
  scan::drop_counts* dropped;

  CLEARANCE_HD void operator()(indices range) const {
    scan::drop_tally mine;
    const morton_grid cells = *grid;
    for (std::size_t i = range.begin; i < range.end; i += range.step) {
      const sample s = source[i];
      codes[i] = mine.counts(s) ? cells(s.position) : ~0u;
      numbers[i] = std::uint32_t(i);
    }
    mine.add_to(*dropped);
  }
};

/// The arrays of a tree, to be written.
struct tree_room {
  numbered_point* points;
  ball* balls;
  std::uint32_t* least;
  extent* boxes;
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
  const std::uint32_t node = child == none ? none : child / siblings;
  put_node(to, node < tree.size(level) ? tree.begin[level] + node : none, box, least,
           [&](vec3 center) { return (rough_length_up(b.center - center) + b.radius) * (1 + slack); });
}

inline constexpr std::uint32_t tile_threads =
    siblings * siblings * siblings;  ///< Points per block, which makes the first three levels.

/// `number_of(i)` is the number of the point at position i, or none.
template <class Source, class Tree, class Order>
__global__ void __launch_bounds__(tile_threads)
    tile_kernel(const __grid_constant__ Source source, const __grid_constant__ Tree tree,
                const __grid_constant__ Order number_of, const tree_room to, scan::drop_counts* dropped) {
  static_assert(Tree::tile == siblings);
  const std::uint32_t t = threadIdx.x, i = blockIdx.x * tile_threads + t, tile = i / siblings;
  numbered_point p{{not_a_number, not_a_number, not_a_number}, ~0u};
  extent box;
  scan::drop_tally mine;
  if (i < tree.count) {
    if (const std::uint32_t number = number_of(i); number != none) {
      const sample s = source[number];
      if (Order::counts ? mine.counts(s) : s.valid()) p = {s.position, number}, box.add(s.position);
    }
    to.points[i] = p;
  }
  if constexpr (Order::counts) mine.add_to(*dropped);
  __syncwarp();
  put_node(to, tile < tree.size(0) ? tile : none, box, p.number,
           [&](vec3 center) { return rough_length_up(p.at - center); });
  for (std::uint32_t level = 1, children = tile_threads / siblings; level < 3 && level < tree.levels;
       ++level, children /= siblings) {
    __syncthreads();
    if (t < children || t < 32) put_parent(tree, level, t < children ? blockIdx.x * children + t : none, to);
  }
}

/// Makes one level.
template <class Tree>
__global__ void __launch_bounds__(256)
    node_kernel(const __grid_constant__ Tree tree, std::uint32_t level, const tree_room to) {
  put_parent(tree, level, blockIdx.x * 256 + threadIdx.x, to);
}
/// Makes all levels from `level` on, by one block.
template <class Tree>
__global__ void __launch_bounds__(1024)
    top_kernel(const __grid_constant__ Tree tree, std::uint32_t level, const tree_room to) {
  for (; level < tree.levels; ++level, __syncthreads())
    for (std::uint32_t first = 0, size = tree.size(level - 1); first < size; first += 1024)
      put_parent(tree, level, first + threadIdx.x, to);
}

/// The order of sorted points.
struct sorted_order {
  static constexpr bool counts = false;  ///< Invalid points were counted when points were encoded.
  const std::uint32_t* numbers;

  __device__ std::uint32_t operator()(std::uint32_t i) const { return numbers[i]; }
};

}  // namespace detail

/// Sorts pairs of words: device_sort.cuh, which the questions about plans include.
template <class Key>
struct device_sort;

/// Owns a tree that is built anew for every frame, in memory that is kept. Invalid points stay among the others as NaN,
/// so the shape is known before they are read and nothing waits. Images become pyramids; other points are sorted.
class device_tree {
 public:
  using view_type = tree_view<8, 8>;

  explicit device_tree(const device& on, std::pmr::memory_resource* memory = nullptr)
      : on_(on), memory_(memory), grid_(1, on.id, memory) {}

  /// Enqueues it. Adds invalid points to `dropped`. The device must be able to read the source as it is.
  template <point_source S>
  void build(const S& source, scan::drop_counts* dropped) {
    static_assert(points_alone<S>());
    const std::size_t n = source.size();
    if constexpr (image_source<S>) {
      const pixel_order pixels(std::uint32_t(n), n == 0 ? 0 : source.columns());
      if (pixels.positions() != 0 &&
          pixels.positions() / 4 <= n)  // of few rows, most places would lie beyond the image
        return put_up(source, view_type(pixels.positions()), pixels, dropped);
    }
    const view_type shape(static_cast<std::uint32_t>(n));
    if (n == 0) return void(view_ = shape);
    grow(codes_, n), grow(sorted_codes_, n), grow(numbers_, n), grow(sorted_, n);
    on_.launch(detail::grid_kernel<S>, 1, detail::grid_threads, 0, source, grid_.data());
    on_.for_ranges(n, detail::encode_body<S>{source, grid_.data(), codes_.data(), numbers_.data(), dropped});
    sort<S>(n);
    put_up(source, shape, detail::sorted_order{sorted_.data()}, dropped);
  }
  const view_type& view() const { return view_; }

 private:
  /// A pass of the sort takes eight bits. Three passes make cells as fine as tiles.
  static constexpr int first_bit = 3 * morton_grid::bits - 24, last_bit = 3 * morton_grid::bits;

  /// Makes the tiles and nodes of a tree of that shape, over points in that order.
  template <class S, class Order>
  void put_up(const S& source, const view_type& shape, const Order& order, scan::drop_counts* dropped) {
    view_ = shape;
    grow(points_, view_.count), grow(balls_, view_.nodes()), grow(least_, view_.nodes()), grow(boxes_, view_.nodes());
    view_.points = points_.data(), view_.balls = balls_.data(), view_.boxes = boxes_.data(),
    view_.least = least_.data();
    const detail::tree_room to{points_.data(), balls_.data(), least_.data(), boxes_.data()};
    const unsigned blocks = (view_.count - 1) / detail::tile_threads + 1;
    on_.launch(detail::tile_kernel<S, view_type, Order>, blocks, detail::tile_threads, 0, source, view_, order, to,
               dropped);
    std::uint32_t level = 3;
    for (; level < view_.levels && view_.size(level - 1) > 16384; ++level)
      on_.launch(detail::node_kernel<view_type>, (view_.size(level - 1) - 1) / 256 + 1, 256, 0, view_, level, to);
    if (level < view_.levels) on_.launch(detail::top_kernel<view_type>, 1, 1024, 0, view_, level, to);
  }

  template <class S>
  void sort(std::size_t n) {
    using sorts = device_sort<std::enable_if_t<point_source<S>, std::uint32_t>>;
    const device_guard guard(on_.id);
    const auto call = [&](void* room, std::size_t& bytes) {
      sorts::pairs(room, bytes, codes_.data(), sorted_codes_.data(), numbers_.data(), sorted_.data(), n, first_bit,
                   last_bit, on_.stream);
    };
    if (n > sort_size_) {
      std::size_t bytes = 0;
      call(nullptr, bytes);
      grow(sort_room_, bytes), sort_size_ = n;
    }
    std::size_t bytes = sort_room_.size();
    call(sort_room_.data(), bytes);
  }

  template <class T>
  void grow(device_buffer<T>& buffer, std::size_t n) const {
    if (buffer.size() < n) buffer = device_buffer<T>(n, on_.id, memory_);
  }

  device on_;
  std::pmr::memory_resource* memory_;
  view_type view_;
  device_buffer<morton_grid> grid_;
  device_buffer<std::uint32_t> codes_, sorted_codes_, numbers_, sorted_, least_;
  device_buffer<numbered_point> points_;
  device_buffer<ball> balls_;
  device_buffer<extent> boxes_;
  device_buffer<std::byte> sort_room_;
  std::size_t sort_size_ = 0;
};

}  // namespace clearance::cloud_tree
