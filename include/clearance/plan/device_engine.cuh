// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks about many configurations on a device, frame after frame. Their poses may stay there.

#include <clearance/backends/device.cuh>
#include <clearance/backends/one_call.cuh>
#include <clearance/backends/own_stream.cuh>
#include <clearance/backends/readback.cuh>
#include <clearance/cloud_tree/device_tree.cuh>
#include <clearance/frames/readable.cuh>
#include <clearance/plan/configurations.hpp>
#include <clearance/plan/engine.hpp>
#include <clearance/plan/frame_kernels.cuh>

#include <algorithm>
#include <bit>
#include <memory>
#include <ranges>
#include <utility>

namespace clearance::plan {

/// On a device: a tree over each cloud, and one block per configuration that searches it. It takes its memory from
/// `memory`, a resource that hands out device memory, if you give one. It allocates only for frames larger than any
/// before. Results stay valid until the next call.
template <class PartView, class Q>
class engine<device, PartView, Q> {
  using question_type = typename Q::searched;
  using result_type = typename question_type::result_type;
  using asked_type = asked_batch<PartView, question_type>;
  static constexpr bool by_margin = question_type::by_margin;

 public:
  /// Poses in pageable memory are copied before the first kernel starts.
  static constexpr bool waits = true;

  /// Throws std::invalid_argument if a tree is too deep for a thread's stack.
  engine(const device& on, const model_view<PartView>& model, std::pmr::memory_resource* memory = nullptr)
      : on_(on),
        resource_(memory),
        widened_(on, model, memory),
        model_(model),
        processors_(attribute(on, cudaDevAttrMultiProcessorCount)),
        shared_(attribute(on, cudaDevAttrMaxSharedMemoryPerMultiprocessor)),
        shared_of_block_(attribute(on, cudaDevAttrMaxSharedMemoryPerBlockOptin) - 1024),
        beside_(on),
        copies_(on, memory),
        memory_(on, memory),
        values_(on, memory),
        back_(on, memory) {
    check_stack<near_first>(model.depth, model.width);
    if (Q::each_part) asked_.robots = std::max(std::uint32_t(model.size()), 1u);
    asked_.part_count = std::uint32_t(model.size()) / asked_.robots;
    Q::results(result_) = std::remove_reference_t<decltype(Q::results(result_))>(back_.memory());
  }
  engine(const engine&) = delete;

  /// Keeps poses, also on the device, for later frames: a watched trajectory is copied once. Enqueued. Throws
  /// std::invalid_argument if the last configuration is not whole.
  void place(std::span<const Eigen::Isometry3d> poses) {
    const std::size_t configurations = count_configurations(model_.size(), poses.size());
    staged_.clear();
    for (const Eigen::Isometry3d& pose : poses) staged_.emplace_back(pose);
    place_by(configurations, [&](world_transform* there) { copy(there, staged_.data(), staged_.size()); });
  }
  /// Keeps the poses of joint vectors, one after another, which the device computes. Throws std::invalid_argument as
  /// joint_chain::count, and if the chain belongs to another robot. Not for a graph: it copies from host memory.
  void place(const joint_chain<device>& chain, std::span<const double> q) {
    const std::size_t configurations = chain.count(q);
    joints_.assign(q.begin(), q.end());
    values_.begin();
    double* const there = values_.template space<double>(q.size()).data();
    copy(there, joints_.data(), q.size());
    place(chain, there, configurations);
  }
  /// The same for joint vectors in device memory. A vector that is not finite or beyond its limits makes poses that are
  /// not rigid.
  void place(const joint_chain<device>& chain, const double* q, std::size_t configurations) {
    const auto view = checked_chain(chain, model_.size()).view();
    staged_.clear();
    place_by(configurations,
             [&](world_transform* there) { on_.for_each(configurations * view.parts, place_links{view, q, there}); });
  }

  /// Enqueues a frame about configurations that are placed first. Points in host memory are copied into buffers that it
  /// keeps.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    place(poses);
    begin_placed(clouds, q);
  }
  /// Enqueues a frame about joint vectors, whose poses the device computes.
  template <class Clouds>
  void begin_chain(const joint_chain<device>& chain, std::span<const double> joints, const Clouds& clouds, const Q& q) {
    place(chain, joints);
    begin_placed(clouds, q);
  }
  /// Enqueues a frame about the placed configurations. Throws std::logic_error if the last ones could not be placed.
  template <class Clouds>
  void begin_placed(const Clouds& clouds, const Q& q) {
    named([&] { enqueue_frame(clouds, q, copies_); });
  }

  /// Waits for the frame that was begun. Throws std::invalid_argument if a pose is not rigid.
  typename Q::result& finish() {
    auto& results = Q::results(result_);
    point_counts points;
    if (asked_.configurations == 0) {
      results.clear();
    } else {
      counts found;
      back_(backends::read_array{results, asked_.results, asked_.configurations},
            backends::read_value<counts>{found, counts_});
      if (found.lost != 0)
        named([&] {
          throw std::invalid_argument(staged_.empty() ? "clearance: a joint vector is not finite or beyond its joint's "
                                                        "limits, or moves a part out of the world"
                                                      : "clearance: a pose is not rigid");
        });
      scan::count(points, found.dropped.dropped, asked_.seen);
    }
    Q::take_counts(result_, points, model_.size());
    return result_;
  }

  /// Enqueues a frame of the placed configurations, and returns device memory with one result per configuration, or
  /// per part of each, for the next work in its stream. Clouds must be readable there. A pose that is not rigid makes
  /// the state `possible` (and the distance NaN), because a device cannot throw. A graph that captures this keeps the
  /// current options, and is void after more configurations are placed, or a larger cloud is asked about.
  template <class Clouds>
  const result_type* start_placed(const Clouds& clouds, const Q& q) {
    enqueue_frame(clouds, q, frames::as_it_is{});
    return asked_.results;
  }

  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    if constexpr (!by_margin)
      if (asked_.configurations != 0) fill_bytes(asked_.last, 0xff, asked_.configurations);  // the number of no cloud
  }

 private:
  using tree_arguments =
      batch_arguments<PartView, question_type, node_pair<typename PartView::hierarchy_type::node_type>>;
  using field_arguments = batch_arguments<PartView, question_type, field_pair>;
  /// After so many rounds of 128 threads a block leaves its stack to others. Where points may be inside a solid, stacks
  /// are longer, and leaving earlier would make too many pieces. With fields a part alone leaves little.
  static constexpr unsigned first_rounds = scan::has_interior<PartView> ? 192 : 128, first_of_part = 16,
                            next_rounds = first_rounds > 128 ? 48 : 24;
  static constexpr std::size_t most_shared = 48 * 1024;  ///< Shared memory that every block may have.
  static constexpr unsigned resident_threads = 1024;     ///< Per processor, as the kernel's registers allow.
  static constexpr std::size_t most_pieces = 1 << 18;    ///< That blocks may leave, and a few more.

  struct counts {
    scan::drop_counts dropped;
    std::uint32_t lost = 0;
  };

  /// `fill(there)` enqueues the poses.
  template <class Fill>
  void place_by(std::size_t configurations, const Fill& fill) {
    const std::size_t count = configurations * asked_.robots, n = configurations * model_.size();
    const std::uint32_t before = std::exchange(asked_.configurations, 0);  // none, until these are placed
    placed_ = n == 0;
    if (placed_) return;
    memory_.begin();
    world_transform* const poses = room<world_transform>(n);
    counts_ = room<counts>(1);
    asked_ = asked_type{.part_count = asked_.part_count,
                        .robots = asked_.robots,
                        .poses = poses,
                        .places = room<frames::placement>(n),
                        .bounds = room<ball_bounds>(n),
                        .facts = room<configuration_facts>(count),
                        .all = room<typename question_type::memory_type>(count),
                        .near = room<margin_reach>(by_margin ? n : 0),
                        .part_best = room<distance_key>(by_margin || Q::each_part || model_.size() < 2 ? 0 : n),
                        .last = room<last_place>(by_margin ? 0 : count),
                        .seeds = room<cloud_tree::numbered_point>(by_margin ? 0 : count),
                        .results = room<result_type>(count),
                        .dropped = &counts_->dropped,
                        .lost = &counts_->lost,
                        .pieces = room<std::uint32_t>(2)};
    if constexpr (!by_margin) {
      make_room_to_leave(left_[0], 8 * configurations);
      make_room_to_leave(left_[1], 2 * configurations);
    }
    fill(poses);
    asked_.configurations = std::uint32_t(count);
    placed_ = true;
    if (count != before) forget();
  }
  /// Room for n values, or null for none. It is the same as for the last configurations if they were as many.
  template <class T>
  T* room(std::size_t n) {
    return n == 0 ? nullptr : memory_.template space<T>(n).data();
  }
  /// For the pieces that blocks leave. Where there is not enough, blocks go on by themselves.
  void make_room_to_leave(device_buffer<std::byte>& left, std::size_t pieces) const {
    const std::size_t bytes = (std::min(pieces, most_pieces) + 1024) *
                              (model_.fields != nullptr ? sizeof(typename field_arguments::pieces_type::piece)
                                                        : sizeof(typename tree_arguments::pieces_type::piece));
    if (left.size() < bytes) left = device_buffer<std::byte>(bytes, on_.id, resource_);
  }

  /// Enqueues all kernels of a frame. `here(source, cloud)` is a source that the device can read.
  template <class Clouds, class Here>
  void enqueue_frame(const Clouds& clouds, const Q& q, Here&& here) {
    static_assert(explain_clouds<Clouds>());
    if (!placed_) throw std::logic_error("clearance: the last configurations could not be placed");
    asked_.question = q.checked(model_.size());
    model_ = widened_(q.radii);
    asked_.parts = model_.parts;
    asked_.fields = model_.fields;
    put_values(clouds);
    if (asked_.configurations == 0) return;
    fill_bytes(counts_, 0, 1);
    asked_.foreseen = false;
    const bool foresee = by_margin && count_clouds(clouds) > 1;  // margins need the errors of all clouds
    if (foresee) for_each_turn(clouds, [&](const auto& given, const frames::turn&) { place_in(on_, given); });
    asked_.foreseen = foresee;
    for_each_turn(clouds, [&](const auto& given, const frames::turn& now) {
      const auto source = here(given, now.cloud);
      while (trees_.size() <= now.cloud) trees_.push_back(std::make_unique<cloud_tree::device_tree>(on_, resource_));
      beside_.fork();
      trees_[now.cloud]->build(source, &counts_->dropped);
      beside_.join([&](const device& beside) { place_in(beside, source); });  // the tree does not need it
      const auto tree = trees_[now.cloud]->template view_of<std::remove_const_t<decltype(source)>>();
      if (model_.fields != nullptr)
        search_by_fields(tree);
      else
        search_by_trees(tree);
      write_results(source);
    });
  }
  /// Enqueues copies of the margins, or of how much farther each part is looked for.
  template <class Clouds>
  void put_values(const Clouds& clouds) {
    values_.begin();
    if constexpr (by_margin) {
      question_type& question = asked_.question;
      question.vague = any_vague(clouds);
      question.margins = std::get<0>(values_.put(std::span(question.margins, question.count)));
    } else {
      if (!Q::each_part) frames::extra_reaches(model_.facts, extra_);
      asked_.extra = extra_.empty() ? nullptr : std::get<0>(values_.put(extra_));
    }
  }
  /// Calls `f(source, turn)` for each cloud, with what kernels are asked. The device places the parts.
  template <class Clouds, class F>
  void for_each_turn(const Clouds& clouds, const F& f) {
    frames::cloud_frame frame;
    frames::for_each_turn(frame, {}, {}, clouds, [&](const auto& source, const frames::turn& now) {
      asked_.now = now;
      asked_.world_from_cloud = frame.world_from_cloud;
      asked_.off = rounding_of(source);
      asked_.seen = now.first + source.size();
      f(source, now);
    });
  }

  template <point_source S>
  void place_in(const device& on, const S& source) const {
    if constexpr (by_margin && !std::is_same_v<S, point_span>) {
      place_in(on, point_span{});  // it reads no points
    } else {
      const unsigned blocks = (asked_.configurations - 1) / (128 / placing_lanes(asked_.part_count)) + 1;
      on.launch(place_configurations<PartView, question_type, S>, blocks, 128, 0, asked_, source);
    }
  }

  template <class Tree>
  void search_by_trees(const Tree& tree) {
    using room = batch_room<typename tree_arguments::pair_type, pair_order<PartView>>;
    // As many threads as there is room for: more for each of few configurations, and where most end at once or a look
    // takes long. Stacks are as deep as the remaining room: a round that may take fewer pairs needs more rounds.
    const bool limited = asked_.question.limited();
    unsigned threads = limited || scan::has_interior<PartView>
                           ? 256
                           : std::clamp(std::bit_floor(2048 * processors_ / asked_.configurations), 128u, 256u);
    if (asked_.robots > 1) threads = limited ? 128 : 64;
    static_assert(room::bytes(32, room::least_depth(32)) <= most_shared, "a handle of a node must be smaller");
    while (room::bytes(threads, room::least_depth(threads)) > most_shared) threads /= 2;
    tree_arguments a{asked_};
    a.depth = room::depth(threads, std::min(shared_of_block_, shared_ / (resident_threads / threads) - 2048));
    search(batch_kernel<tree_arguments, Tree>, tree, a, threads, room::bytes(threads, a.depth), first_rounds);
  }
  template <class Tree>
  void search_by_fields(const Tree& tree) {
    using room = field_room<PartView>;
    unsigned threads = asked_.robots > 1 || (scan::has_interior<PartView> && !asked_.question.limited()) ? 128 : 256;
    while (room::bytes(threads) > shared_of_block_) threads /= 2;
    search(field_kernel<field_arguments, Tree>, tree, field_arguments{asked_}, threads, room::bytes(threads),
           asked_.robots > 1 ? first_of_part : first_rounds);
  }
  /// One block per configuration; the slowest leave their rest to other blocks.
  template <class Kernel, class Tree, class Arguments>
  void search(Kernel* kernel, const Tree& tree, Arguments a, unsigned threads, std::size_t bytes, unsigned first) {
    {
      const device_guard guard(on_.id);
      limits_.raise(reinterpret_cast<const void*>(kernel), shared_of_block_);
    }
    const unsigned at_once = processors_ * (resident_threads / threads);
    const auto launch = [&](unsigned blocks, unsigned rounds) {
      a.rounds = rounds == none ? none : rounds * 128 / threads;
      on_.launch(kernel, blocks, threads, bytes, a, tree);
    };
    if (a.question.limited() || a.configurations <= at_once) return launch(a.configurations, none);
    // The slowest of many configurations takes twenty times as long as most, and most of that may come from one pair.
    // So the rest is dealt out twice.
    using pieces_type = typename Arguments::pieces_type;
    const auto left = [&](int k) -> pieces_type {
      using piece = typename pieces_type::piece;
      return {reinterpret_cast<piece*>(left_[k].data()), a.pieces + k, std::uint32_t(left_[k].size() / sizeof(piece))};
    };
    a.left = left(0);
    launch(a.configurations, first);
    a.given = std::exchange(a.left, left(1));
    launch(at_once, next_rounds);
    a.given = std::exchange(a.left, {});
    launch(at_once, none);
  }

  template <point_source S>
  void write_results(const S& source) const {
    const std::uint32_t count = asked_.configurations;
    if constexpr (!by_margin)
      on_.launch(finish_configurations<PartView, question_type, S>, (count + 3) / 4, 128, 0, asked_, source);
    else if (asked_.now.last)
      on_.launch(tell_configurations<PartView, question_type>, (count + 127) / 128, 128, 0, asked_);
  }

  template <class T>
  void copy(T* to, const T* from, std::size_t n) const {
    if (n == 0) return;
    const device_guard guard(on_.id);
    check_cuda(cudaMemcpyAsync(to, from, n * sizeof(T), cudaMemcpyHostToDevice, on_.stream), "cudaMemcpyAsync");
  }
  template <class T>
  void fill_bytes(T* what, int byte, std::size_t n) const {
    const device_guard guard(on_.id);
    check_cuda(cudaMemsetAsync(what, byte, n * sizeof(T), on_.stream), "cudaMemsetAsync");
  }

  /// Calls `f`. If it throws because a pose is not rigid, the message names the configuration.
  template <class F>
  void named(const F& f) const {
    plan::named(model_.size(), std::views::transform(staged_, to_isometry), f);
  }
  static unsigned attribute(const device& on, cudaDeviceAttr what) {
    int value = 0;
    check_cuda(cudaDeviceGetAttribute(&value, what, on.id), "cudaDeviceGetAttribute");
    return unsigned(value);
  }

  device on_;
  std::pmr::memory_resource* resource_;
  widened_model<device, PartView> widened_;
  model_view<PartView> model_;  ///< With the radii of the last call.
  unsigned processors_;
  std::size_t shared_;           ///< Bytes of shared memory: of a processor,
  std::size_t shared_of_block_;  ///< and the most of a block, less what a kernel takes itself.
  side_stream beside_;
  raised_limits limits_;
  frames::kept_copies copies_;
  std::vector<std::unique_ptr<cloud_tree::device_tree>> trees_;
  asked_type asked_;    ///< What kernels are asked: where configurations lie, and the last frame.
  bool placed_ = true;  ///< Could the last configurations be placed?
  counts* counts_ = nullptr;
  backends::kept_memory<device> memory_;  ///< Of placed configurations,
  backends::kept_memory<device> values_;  ///< and of a frame.
  backends::readback<device> back_;
  device_buffer<std::byte> left_[2];     ///< Pieces that blocks leave, and leave again.
  std::vector<world_transform> staged_;  ///< Poses on their way,
  std::vector<double> joints_;           ///< and joint vectors.
  std::vector<real> extra_;              ///< See extra_reaches.
  typename Q::result result_;
};

}  // namespace clearance::plan
