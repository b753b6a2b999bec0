// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The memory that the kernels of a prepared scan share, for any answer, and their launch.

#include <clearance/backends/device.cuh>
#include <clearance/concepts/block_tally.cuh>
#include <clearance/frames/clouds.hpp>
#include <clearance/result.hpp>
#include <clearance/robot/cells.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/scan/arguments.hpp>
#include <clearance/scan/block.cuh>
#include <clearance/scan/threads.cuh>

#include <algorithm>
#include <memory>

namespace clearance::scan {

/// Does what the host does with poses, for poses in memory that the device reads. One block; a thread has a part of
/// each group.
template <class PartView>
__global__ void __launch_bounds__(most_parts)
    place_kernel(const world_transform* world_from_part, const world_transform* world_from_cloud, const PartView* views,
                 std::uint32_t count, position_error off, placed_parts* groups) {
  __shared__ frames::frame_facts frame;
  const std::uint32_t t = threadIdx.x;
  const auto pose = [groups](std::uint32_t k) -> world_transform& {
    return groups[k / most_parts].world_from_part[k % most_parts];
  };

  bool rigid = true;
  for (std::uint32_t k = t; k < count; k += most_parts) {
    world_transform given = world_from_part[k];
    rigid = make_rigid(given) && rigid;
    pose(k) = given;
  }
  if (t == 0) {
    frame = {world_from_cloud == nullptr ? world_transform() : *world_from_cloud, {0, 0, 0}, off};
    rigid = make_rigid(frame.world_from_cloud) && rigid;
  }

  rigid = __syncthreads_and(rigid);
  if (t == 0 && rigid) frame.origin = frames::origin_near(frames::middle_of(frame.world_from_cloud, pose, count));
  __syncthreads();
  for (std::uint32_t k = t; k < count; k += most_parts)
    groups[k / most_parts].parts.part[t] =
        frame_part(frames::place(views[k].facts, pose(k), frame.world_from_cloud, frame.origin, off));
  __syncthreads();
  if (t == 0)
    for (std::uint32_t k = 0; k < count; ++k)
      frame.add(views[k].facts, groups[k / most_parts].parts.part[k % most_parts].error);
  __syncthreads();

  for (std::uint32_t first = 0, g = 0; first < count || g == 0; first += most_parts, ++g) {
    const std::uint32_t parts = lower_of(count - first, most_parts);
    if (t * cluster < parts) groups[g].parts.gather(t, parts);
    if (t == 0) {
      groups[g].frame = frame;
      groups[g].rigid = rigid;
    }
  }
}

/// Puts a part's cells beside it.
template <class PartView>
struct join_cells {
  const PartView* parts;
  const cells_view* cells;
  celled_view<PartView>* to;

  CLEARANCE_HD void operator()(std::size_t k) const { to[k] = {parts[k], cells[k]}; }
};

template <class PartView>
class launcher {
 public:
  /// Throws std::invalid_argument if a tree in arrays exceeds what `build` makes, or another one `most_width`.
  launcher(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory)
      : on_(on),
        parts_(std::uint32_t(model.size())),
        fields_(model.fields),
        processors_(ask(cudaDevAttrMultiProcessorCount)),
        most_shared_(ask(cudaDevAttrMaxSharedMemoryPerBlockOptin)),
        shared_of_processor_(ask(cudaDevAttrMaxSharedMemoryPerMultiprocessor)),
        state_(groups(), on.id, memory),
        views_(model.size(), on.id, memory),
        placed_(groups(), on.id, memory) {
    if (const std::uint64_t need = stack_need(model.depth, model.width);
        model.width > most_children || need > deepest_stack) {
      if constexpr (!node_of<typename PartView::hierarchy_type>::any_size)
        throw std::invalid_argument("clearance: a tree of depth " + std::to_string(model.depth) + " and width " +
                                    std::to_string(model.width) +
                                    ", which `build` would not make; a device takes it as an any_tree");
      if (model.width > most_width)
        throw std::invalid_argument("clearance: a node has " + std::to_string(model.width) +
                                    " children; a device takes " + std::to_string(most_width));
      overflow_room_ =
          std::uint32_t(std::max<std::uint64_t>(need, std::uint64_t(model.depth) * most_children + 2 * stack_capacity));
      overflow_ = device_buffer<std::byte>(
          std::size_t(processors_) * (warps + 1) * overflow_room_ * sizeof(pending<linked_node>), on.id, memory);
    }
    const device_guard guard(on.id);
    check_cuda(
        cudaMemcpyAsync(views_.data(), model.parts, model.size() * sizeof(PartView), cudaMemcpyDefault, on.stream),
        "cudaMemcpyAsync");
    if constexpr (cored_hierarchy<typename PartView::hierarchy_type>)
      if (model.cells != nullptr) {
        celled_ = device_buffer<celled_view<PartView>>(model.size(), on.id, memory);
        on.for_each(model.size(), join_cells<PartView>{views_.data(), model.cells, celled_.data()});
      }
    forget();
  }

  /// Parts come in groups of 128, with one kernel per group.
  std::uint32_t groups() const { return parts_ == 0 ? 1 : (parts_ + most_parts - 1) / most_parts; }
  /// One for each part of a group, or null.
  const field_view* fields(std::uint32_t group) const {
    return fields_ == nullptr ? nullptr : fields_ + group * most_parts;
  }
  /// Have parts cells? Then a kernel's `part_type` may be a celled_view.
  bool has_cells() const { return celled_.size() != 0; }
  /// The most blocks of a kernel.
  unsigned most_blocks() const { return 2 * processors_; }

  /// Forgets the scan before. It takes no memory, because none may be left.
  void forget() {
    const scan_state fresh;
    for (std::uint32_t group = 0; group < groups(); ++group) on_.stage(std::span(&fresh, 1), state_.data() + group);
  }

  /// The arguments for one cloud and one group of parts.
  template <class Tally>
  scan_arguments<Tally> begin(std::uint32_t group, const frames::turn& now,
                              const typename Tally::arguments& answer) const {
    scan_arguments<Tally> a{};
    const std::uint32_t before = group * most_parts;
    if constexpr (clearance::has_cells<typename Tally::part_type>)
      a.views = celled_.data() + before;
    else
      a.views = views_.data() + before;
    a.parts = std::min(parts_ - before, most_parts);
    a.state = state_.data() + group;
    a.rest = placed_.data() + group;
    a.overflow = overflow_.data();
    a.overflow_room = overflow_room_;
    a.cloud = now.cloud;
    a.first = now.first;
    a.last = now.last;
    a.answer = answer;
    return a;
  }

  /// Poses that the host has prepared. Few travel with the launch; many are copied before it.
  template <class Tally>
  void put(const frames::cloud_frame& frame, std::uint32_t group, scan_arguments<Tally>& a) {
    const auto places = std::span(frame.places).subspan(group * most_parts, a.parts);
    const auto fill = [&](auto& parts, world_transform* world) {
      for (std::uint32_t k = 0; k < a.parts; ++k) {
        parts.part[k] = frame_part(places[k]);
        world[k] = places[k].world_from_part;
      }
      for (std::uint32_t c = 0; c * cluster < a.parts; ++c) parts.gather(c, a.parts);
    };
    a.frame = frame;
    a.far = a.parts > inline_parts;
    if (!a.far) return fill(a.near, a.world_from_part);
    if (!staged_) staged_ = std::make_unique<placed_parts>();
    fill(staged_->parts, staged_->world_from_part);
    const auto bytes = [](auto* from) { return reinterpret_cast<std::byte*>(from); };
    const std::span<const std::byte> parts(bytes(&staged_->parts), bytes(staged_->parts.part + a.parts));
    placed_parts* const placed = placed_.data() + group;
    on_.stage(parts, bytes(&placed->parts));
    on_.stage(std::span<const world_transform>(staged_->world_from_part, a.parts), placed->world_from_part);
  }

  /// Prepares poses from device or pinned memory on the device, for all groups. `off`: `rounding_of` the source.
  void place(const world_transform* poses, const world_transform* cloud, const position_error& off) {
    on_.launch(place_kernel<PartView>, 1, most_parts, 0, poses, cloud, views_.data(), parts_, off, placed_.data());
  }

  /// All clouds of a frame against all groups. `arguments(source, group, turn)` are a kernel's, as `begin` makes them,
  /// `here(source, cloud)` is a source that the device can read. Returns the facts of all clouds together.
  template <class Clouds, class Arguments, class Here>
  const frames::frame_facts& pass(std::span<const part_facts> facts, std::span<const Eigen::Isometry3d> poses,
                                  const Clouds& clouds, const Arguments& arguments, const Here& here) {
    try {
      frames::for_each_turn(frame_, facts, poses, clouds, [&](const auto& anywhere, const frames::turn& now) {
        const auto source = here(anywhere, now.cloud);
        for (std::uint32_t group = 0; group < groups(); ++group) {
          auto a = arguments(source, group, now);
          put(frame_, group, a);
          (*this)(source, a);
        }
      });
    } catch (...) {
      forget();  // the clouds before this one have left their counts
      throw;
    }
    return frame_;
  }

  /// Enqueues the kernel. Throws std::invalid_argument for too many points: it numbers more than there are.
  template <class Tally, point_source Source>
  void operator()(const Source& source, scan_arguments<Tally>& a) {
    if constexpr (std::is_same_v<typename Tally::element, vec3>) static_assert(points_alone<Source>());
    const std::uint64_t end = std::uint64_t(a.first) + source.size();
    if (const std::uint32_t most = none - block_threads * 8 * processors_; end >= most)
      throw std::invalid_argument("clearance: " + std::to_string(end) +
                                  " points are too many for one call; this device takes " + std::to_string(most - 1));
    a.points = std::uint32_t(source.size());
    const device_guard guard(on_.id);
    start(source, a);
  }

 private:
  unsigned ask(cudaDeviceAttr what) const {
    int value = 0;
    check_cuda(cudaDeviceGetAttribute(&value, what, on_.id), "cudaDeviceGetAttribute");
    return unsigned(value);
  }

  template <class Tally, class Source>
  void start(const Source& source, scan_arguments<Tally>& a) {
    static_assert(explain_block_tally<Tally>());
    const std::size_t shared = memory_bytes<Tally>(a.parts);
    a.top_stride = a.parts == 0 ? 0 : std::min(decltype(block_memory<Tally>::tops)::capacity / a.parts, 128u);
    using how = typename Tally::scan_type;
    const auto kernel = how::template kernel<Tally, Source>();
    limits_.raise(reinterpret_cast<const void*>(kernel), most_shared_);
    const unsigned resident =
        2 * (shared + 1024) <= shared_of_processor_ && a.overflow == nullptr ? processors_ * 2 : processors_;
    const unsigned blocks = std::max(1u, std::min(resident, (a.points + how::in_block - 1) / how::in_block));
    how::plan(source, a, blocks);
    on_.launch_early(kernel, blocks, block_threads, shared, source, a);
  }

  device on_;
  frames::cloud_frame frame_;  ///< For `pass`.
  std::uint32_t parts_;
  const field_view* fields_;
  unsigned processors_, most_shared_, shared_of_processor_;
  device_buffer<scan_state> state_;
  device_buffer<PartView> views_;
  device_buffer<celled_view<PartView>> celled_;  ///< The same with their cells, or nothing.
  device_buffer<placed_parts> placed_;
  device_buffer<std::byte> overflow_;  ///< Stacks of trees that shared memory is too small for.
  std::uint32_t overflow_room_ = 0;
  raised_limits limits_;
  std::unique_ptr<placed_parts> staged_;  ///< Many parts on their way to `placed_`.
};

}  // namespace clearance::scan
