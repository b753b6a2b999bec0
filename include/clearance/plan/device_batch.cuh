// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A question about many configurations on a device, from their poses to their results. Each has a block that searches.

#include <clearance/backends/device.cuh>
#include <clearance/backends/own_stream.cuh>
#include <clearance/cloud_tree/device_tree.cuh>
#include <clearance/frames/bracket.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/minimum/plain_search.hpp>
#include <clearance/minimum/resolve.hpp>
#include <clearance/plan/batch_arguments.hpp>
#include <clearance/plan/batch_kernel.cuh>
#include <clearance/plan/field_kernel.cuh>
#include <clearance/robot/model.hpp>
#include <clearance/scan/threads.cuh>

#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

namespace clearance::plan {

/// So many lanes place a configuration. A few for each of several parts were slower than a warp.
CLEARANCE_HD constexpr std::uint32_t placing_lanes(std::uint32_t parts) { return parts == 1 ? 1 : 32; }

/// Does what a host does with poses before a search, and finds where each search begins. A warp per
/// configuration, or a lane if that has one part.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128)
    place_configurations(const __grid_constant__ batch_arguments<PartView, Question> a,
                         const __grid_constant__ Source source) {
  const std::uint32_t lanes = placing_lanes(a.part_count), c = (blockIdx.x * 128 + threadIdx.x) / lanes,
                      lane = threadIdx.x % lanes, first = threadIdx.x % 32 - lane;
  const unsigned team = (scan::all_lanes >> (32 - lanes)) << first;
  if (c >= a.configurations) return;
  if (c == 0 && lane == 0) a.left.used[0] = a.left.used[1] = 0;
  const PartView* const parts = a.its_parts(c);
  frames::placement* const places = a.its_places(c);
  bool rigid = true;
  for (std::uint32_t k = lane; k < a.part_count; k += lanes) {
    const std::size_t which = std::size_t(c) * a.part_count + k;
    world_transform pose = a.poses[which];
    if (!make_rigid(pose)) {
      rigid = false, pose = {};
      *static_cast<volatile std::uint32_t*>(a.lost) = 1;
    }
    places[k].world_from_part = pose;
  }
  rigid = __all_sync(team, rigid);
  __syncwarp(team);
  configuration_facts facts(a.world_from_cloud, {0, 0, 0}, a.off);
  if (lane == 0) {
    const auto pose = [places](std::uint32_t k) -> const world_transform& { return places[k].world_from_part; };
    facts.origin = frames::origin_near(frames::middle_of(a.world_from_cloud, pose, a.part_count));
  }
  facts.origin = scan::from_lane(facts.origin, int(first), team);
  for (std::uint32_t k = lane; k < a.part_count; k += lanes) {
    const frames::placement here =
        frames::place(parts[k].facts, places[k].world_from_part, a.world_from_cloud, facts.origin, a.off);
    places[k] = here;
    a.bounds[std::size_t(c) * a.part_count + k] = ball_bounds(parts[k].facts, here.part_from_cloud);
  }
  __syncwarp(team);
  for (std::uint32_t k = 0; k < a.part_count; ++k) facts.add(parts[k].facts, places[k].error);
  facts.rigid = rigid;
  if (a.now.cloud != 0 || a.foreseen) facts.error.widen(a.facts[c].error);  // a bracket covers all clouds
  if constexpr (Question::by_margin)
    for (std::uint32_t k = lane; k < a.part_count; k += lanes)
      a.near[std::size_t(c) * a.part_count + k] = a.question.near(k, parts[k].facts, facts.error);
  __syncwarp(team);
  if (lane != 0) return;
  if (a.now.cloud == 0) {
    a.all[c] = a.question.start(rigid);
    if (a.part_best != nullptr)
      for (std::uint32_t k = 0; k < a.part_count; ++k) a.minima_of(c).best[k] = no_key;
  }
  a.facts[c] = facts;
  if constexpr (!Question::by_margin) {
    if (a.now.cloud == 0) a.results[c] = {};
    cloud_tree::numbered_point seed{{0, 0, 0}, none};
    if (const last_place last = a.last[c]; last.cloud == a.now.cloud && last.point < source.size())
      if (const sample s = source[last.point]; s.valid()) seed = {s.position, last.point};
    a.seeds[c] = seed;
  }
}

/// Writes the witness of each configuration's minimum, if it is a point of this cloud; after the last cloud, the whole
/// result. One warp per configuration: each lane tests one part, and all lanes look for the primitive together.
template <class PartView, class Question, class Source>
__global__ void __launch_bounds__(128)
    finish_configurations(const __grid_constant__ batch_arguments<PartView, Question> a,
                          const __grid_constant__ Source source) {
  constexpr bool balls = ball_source<Source>;  // each lane walks for the ball, and all find the same
  using walk_type = std::conditional_t<balls, any_depth, walk_by_warp<typename PartView::hierarchy_type>>;
  using steps = warp_walk<typename PartView::hierarchy_type>;
  __shared__ typename steps::node_type pending[4][steps::most];
  const std::uint32_t c = (blockIdx.x * 128 + threadIdx.x) / 32, lane = threadIdx.x % 32;
  if (c >= a.configurations) return;
  const PartView* const parts = a.its_parts(c);
  const configuration_facts& facts = a.facts[c];
  const minimum::shared_bounds bounds{a.all + c, nullptr};
  min_distance_result mine;
  walk_type walk{};
  if constexpr (!balls) walk = {{pending[threadIdx.x / 32]}};
  const auto of_part = [&](std::uint32_t k) -> minimum::resolve_body<PartView, Source, walk_type> {
    return {parts + k,   a.its_places(c) + k, 1,      source, facts.origin, facts.world_from_cloud,
            a.now.first, a.now.cloud,         bounds, walk,   &mine,        nullptr};
  };
  for (std::uint32_t first = 0; first < a.part_count && __all_sync(scan::all_lanes, mine.part == none); first += 32) {
    unsigned those = __ballot_sync(scan::all_lanes, first + lane < a.part_count && of_part(first + lane).may_be_of(0));
    for (; those != 0 && __all_sync(scan::all_lanes, mine.part == none); those &= those - 1) {
      const std::uint32_t k = first + std::uint32_t(__ffs(int(those))) - 1;
      of_part(k)(1);
      if (mine.part != none) mine.part = k;
      if (mine.part != none && (!balls || lane == 0)) a.results[c] = mine;
    }
  }
  __syncwarp();
  if (!a.now.last || lane != 0) return;
  min_distance_result r = a.results[c];
  const of_parts its = a.minima_of(c);
  minimum::conclude_body<PartView>{parts,       a.part_count, a.dropped, {a.all + c, its.best, its.extra},
                                   facts.error, facts.slop,   a.seen,    &r}(0);
  frames::beyond(r, a.question.d_max, facts.slop, facts.error);
  if (!facts.rigid) r.state = state::possible, r.distance = not_a_number, r.lower = 0, r.upper = infinity;
  if (r.part != none) r.part += a.first_part(c);
  a.results[c] = r;
  a.last[c] = {r.cloud, r.point};
}

/// Writes the state of each configuration after the last cloud, for a question by margins.
template <class PartView, class Question>
__global__ void __launch_bounds__(128)
    tell_configurations(const __grid_constant__ batch_arguments<PartView, Question> a) {
  const std::uint32_t c = blockIdx.x * 128 + threadIdx.x;
  if (c >= a.configurations) return;
  point_counts counts;
  scan::count(counts, a.dropped->dropped, a.seen);
  a.results[c] = a.facts[c].rigid
                     ? Question::told(a.all[c], counts.valid, counts.dropped[int(drop_reason::too_close)] != 0)
                     : state::possible;
}

}  // namespace clearance::plan

namespace clearance {

/// What a device has for the blocks of a kernel.
struct processors_of {
  unsigned count = 0;
  std::size_t shared = 0, of_block = 0;  ///< Bytes of shared memory: of a processor, and the most of a block.

  explicit processors_of(const device& on)
      : count(ask(on, cudaDevAttrMultiProcessorCount)),
        shared(ask(on, cudaDevAttrMaxSharedMemoryPerMultiprocessor)),
        of_block(ask(on, cudaDevAttrMaxSharedMemoryPerBlockOptin)) {}

 private:
  static unsigned ask(const device& on, cudaDeviceAttr what) {
    int value = 0;
    check_cuda(cudaDeviceGetAttribute(&value, what, on.id), "cudaDeviceGetAttribute");
    return unsigned(value);
  }
};

}  // namespace clearance

namespace clearance::plan {

/// A question about many configurations on a device, frame after frame: a tree over each cloud, and one block per
/// configuration that searches it. It never waits. It allocates only for frames larger than any before.
template <class PartView, class Question>
class device_batch {
 public:
  using result_type = typename Question::result_type;

  /// With `each_part` each part is a robot of its own. Throws std::invalid_argument if a tree is too deep.
  device_batch(const device& on, const model_view<PartView>& model, bool each_part, std::pmr::memory_resource* memory)
      : on_(on),
        robots_(each_part ? std::max(std::uint32_t(model.size()), 1u) : 1),
        model_(model),
        facts_(model.facts.begin(), model.facts.end()),
        memory_(memory),
        processors_(on),
        beside_(on),
        extras_(Question::by_margin ? 0 : facts_.size(), on.id, memory),
        counts_(1, on.id, memory),
        left_used_(2, on.id, memory) {
    check_stack<near_first>(model.depth, model.width);
    model_.facts = facts_;
    anywhere_.assign(facts_.size(), Eigen::Isometry3d::Identity());
    processors_.of_block -= 1024;  // less the kernel's static memory
  }
  device_batch(const device_batch&) = delete;

  std::size_t parts() const { return facts_.size(); }
  /// How many configurations were placed, and how many results each has.
  std::uint32_t placed() const { return configurations_ / robots_; }
  std::uint32_t robots() const { return robots_; }
  const result_type* results() const { return results_.data(); }
  /// The same robot, whose parts may be elsewhere.
  void set_robot(const model_view<PartView>& robot) {
    model_.parts = robot.parts;
    std::ranges::copy(robot.facts, facts_.begin());
    if constexpr (!Question::by_margin) look_farther();
  }

  /// Copies results and point counts, and returns whether all poses were rigid. Waits. Without results it returns true.
  bool copy_out(std::span<result_type> to, point_counts* points = nullptr) const {
    if (to.empty()) return true;
    const device_guard guard(on_.id);
    counts found;
    const auto copy = [&](void* there, const void* from, std::size_t bytes) {
      check_cuda(cudaMemcpyAsync(there, from, bytes, cudaMemcpyDeviceToHost, on_.stream), "cudaMemcpyAsync");
    };
    copy(to.data(), results_.data(), to.size_bytes());
    copy(&found, counts_.data(), sizeof found);
    on_.wait();
    if (points != nullptr) scan::count(*points, found.dropped.dropped, seen_);
    return found.lost == 0;
  }

  /// Enqueues a copy of the poses, one configuration after another, for all frames to come.
  void place(std::span<const Eigen::Isometry3d> poses) {
    staged_.clear();
    for (const Eigen::Isometry3d& pose : poses) staged_.emplace_back(pose);
    place(std::uint32_t(poses.empty() ? 0 : poses.size() / facts_.size()), [&](world_transform* there) {
      const device_guard guard(on_.id);
      check_cuda(cudaMemcpyAsync(there, staged_.data(), staged_.size() * sizeof staged_[0], cudaMemcpyHostToDevice,
                                 on_.stream),
                 "cudaMemcpyAsync");
    });
  }
  /// The same for poses that `fill(there)` enqueues.
  template <class Fill>
  void place(std::uint32_t configurations, const Fill& fill) {
    const std::size_t count = configurations * robots_, n = configurations * facts_.size();
    const std::uint32_t before =
        std::exchange(configurations_, 0);  // so that poses that were not placed are never asked about
    grow(poses_, n), grow(places_, n), grow(bounds_, n);
    grow(of_all_, count), grow(all_, count), grow(results_, count);
    if constexpr (!Question::by_margin) {
      if (model_.fields != nullptr)
        grow(pieces_, pieces_of(configurations, 8)), grow(pieces_again_, pieces_of(configurations, 2));
      else
        grow(left_, pieces_of(configurations, 8)), grow(left_again_, pieces_of(configurations, 2));
    }
    if constexpr (Question::by_margin)
      grow(near_, n);
    else
      grow(seeds_, count), grow(last_, count), grow(part_best_, robots_ > 1 || facts_.size() < 2 ? 0 : n);
    if (n == 0) return;
    fill(poses_.data());
    configurations_ = std::uint32_t(count);
    if (count != before) forget();
  }

  /// Enqueues a frame. `here(source, cloud)` returns a source that the device can read.
  template <class Clouds, class Here>
  void enqueue(const Clouds& clouds, const Question& question, const Here& here) {
    if (configurations_ == 0) return;
    clear(counts_.data(), 0, 1);
    const bool foreseen = Question::by_margin && count_clouds(clouds) > 1;  // margins need the errors of all clouds
    if (foreseen)
      frames::for_each_turn(frame_, facts_, anywhere_, clouds, [&](const auto& given, const frames::turn& now) {
        place_in(on_, point_span{}, told(given, now, question, false));
      });
    seen_ = frames::for_each_turn(frame_, facts_, anywhere_, clouds, [&](const auto& given, const frames::turn& now) {
      const auto source = here(given, now.cloud);
      while (trees_.size() <= now.cloud) trees_.push_back(std::make_unique<cloud_tree::device_tree>(on_, memory_));
      beside_.fork();
      trees_[now.cloud]->build(source, &counts_.data()->dropped);
      const arguments a = told(source, now, question, foreseen);
      ask(source, trees_[now.cloud]->template view_of<std::remove_const_t<decltype(source)>>(), a);
      finish(source, a);
    });
  }

  void forget() {
    if constexpr (!Question::by_margin)
      if (configurations_ != 0) clear(last_.data(), 0xff, configurations_);  // the number of no cloud
  }

 private:
  using arguments = batch_arguments<PartView, Question>;
  using room = batch_room<typename arguments::pair_type, pair_order<PartView>>;
  template <class Pair>
  using pieces = device_buffer<typename batch_pieces<Pair>::piece>;
  /// After so many rounds of 128 threads a block leaves its stack to others. Where points may be inside a solid, stacks
  /// are longer, and leaving earlier would make too many pieces. With fields a part alone leaves little.
  static constexpr unsigned first_rounds = scan::has_interior<PartView> ? 192 : 128, first_of_part = 16,
                            next_rounds = first_rounds > 128 ? 48 : 24;
  static constexpr std::size_t most_shared = 48 * 1024;  ///< Shared memory that every block may have.
  static constexpr unsigned resident_threads = 1024;     ///< Per processor, as the kernel's registers allow.
  struct counts {
    scan::drop_counts dropped;
    std::uint32_t lost = 0;
  };

  /// Room for the pieces that blocks leave. Where it is not enough, blocks go on by themselves.
  static std::size_t pieces_of(std::size_t configurations, std::size_t each) {
    return std::min(each * configurations, std::size_t(1) << 18) + 1024;
  }

  /// Has on the device how much farther each part is looked for.
  void look_farther() {
    if (robots_ == 1) frames::extra_reaches(facts_, extra_);
    if (!extra_.empty()) on_.stage(std::span<const real>(extra_), extras_.data());
  }

  template <point_source S>
  arguments told(const S& source, const frames::turn& now, const Question& question, bool foreseen) const {
    return {{model_.parts,
             model_.fields,
             std::uint32_t(facts_.size()) / robots_,
             configurations_,
             robots_,
             poses_.data(),
             now,
             frame_.world_from_cloud,
             rounding_of(source),
             question,
             foreseen,
             now.first + source.size(),
             places_.data(),
             bounds_.data(),
             of_all_.data(),
             all_.data(),
             near_.data(),
             extra_.empty() ? nullptr : part_best_.data(),
             extra_.empty() ? nullptr : extras_.data(),
             last_.data(),
             seeds_.data(),
             results_.data(),
             &counts_.data()->dropped,
             &counts_.data()->lost},
            {left_.data(), left_used_.data(), std::uint32_t(left_.size())}};
  }
  template <point_source S>
  void place_in(const device& on, const S& source, const arguments& a) const {
    const unsigned blocks = (configurations_ - 1) / (128 / placing_lanes(a.part_count)) + 1;
    on.launch(place_configurations<PartView, Question, S>, blocks, 128, 0, a, source);
  }
  template <point_source S, class Tree>
  void ask(const S& source, const Tree& tree, const arguments& a) {
    beside_.join([&](const device& beside) {  // the tree does not need it
      if constexpr (Question::by_margin)
        place_in(beside, point_span{}, a);
      else
        place_in(beside, source, a);
    });
    if (model_.fields != nullptr)
      search_by_field(tree, a);
    else
      search_trees(tree, a);
  }
  template <class Tree>
  void search_trees(const Tree& tree, const arguments& a) {
    // As many threads as there is room for: more for each of few configurations, and where most end at once or a look
    // takes long. Stacks are as deep as the remaining room: a round that may take fewer pairs needs more rounds.
    unsigned threads = robots_ > 1                                            ? 64
                       : a.question.limited() || scan::has_interior<PartView> ? 256
                                                                              : threads_for_all();
    if (robots_ > 1 && a.question.limited()) threads = 128;
    static_assert(room::bytes(32, room::least_depth(32)) <= most_shared, "a handle of a node must be smaller");
    while (room::bytes(threads, room::least_depth(threads)) > most_shared) threads /= 2;
    arguments with_stack = a;
    with_stack.depth =
        room::depth(threads, std::min(processors_.of_block, processors_.shared / (resident_threads / threads) - 2048));
    search(batch_kernel<arguments, Tree>, tree, with_stack, threads, room::bytes(threads, with_stack.depth), left_,
           left_again_, first_rounds);
  }
  template <class Tree>
  void search_by_field(const Tree& tree, const arguments& a) {
    using by_field = batch_arguments<PartView, Question, field_pair>;
    using shared = field_room<PartView>;
    unsigned threads = robots_ > 1 || (scan::has_interior<PartView> && !a.question.limited()) ? 128 : 256;
    while (shared::bytes(threads) > processors_.of_block) threads /= 2;
    const by_field fields{a, {pieces_.data(), left_used_.data(), std::uint32_t(pieces_.size())}};
    search(field_kernel<by_field, Tree>, tree, fields, threads, shared::bytes(threads), pieces_, pieces_again_,
           robots_ > 1 ? first_of_part : first_rounds);
  }
  unsigned threads_for_all() const {
    return std::clamp(std::bit_floor(2048 * processors_.count / configurations_), 128u, 256u);
  }
  /// One block per configuration; the slowest leave their rest to other blocks.
  template <class Kernel, class Tree, class Arguments, class Pieces>
  void search(Kernel* kernel, const Tree& tree, Arguments a, unsigned threads, std::size_t bytes, const Pieces& left,
              const Pieces& left_again, unsigned first) {
    {
      const device_guard guard(on_.id);
      limits_.raise(reinterpret_cast<const void*>(kernel), processors_.of_block);
    }
    const unsigned at_once = processors_.count * (resident_threads / threads);
    const auto search = [&](unsigned blocks, unsigned rounds) {
      a.rounds = rounds == none ? none : rounds * 128 / threads;
      on_.launch(kernel, blocks, threads, bytes, a, tree);
    };
    if (a.question.limited() || configurations_ <= at_once) return search(configurations_, none);
    // The slowest of many configurations takes twenty times as long as most, and most of that may come from one pair.
    // So the rest is dealt out twice.
    a.left = {left.data(), left_used_.data(), std::uint32_t(left.size())};
    search(configurations_, first);
    a.given = a.left;
    a.left = {left_again.data(), left_used_.data() + 1, std::uint32_t(left_again.size())};
    search(at_once, next_rounds);
    a.given = a.left, a.left.capacity = 0;
    search(at_once, none);
  }
  template <point_source S>
  void finish(const S& source, const arguments& a) const {
    if constexpr (!Question::by_margin)
      on_.launch(finish_configurations<PartView, Question, S>, (configurations_ + 3) / 4, 128, 0, a, source);
    else if (a.now.last)
      on_.launch(tell_configurations<PartView, Question>, (configurations_ + 127) / 128, 128, 0, a);
  }

  template <class T>
  void grow(device_buffer<T>& buffer, std::size_t n) const {
    if (buffer.size() < n) buffer = device_buffer<T>(n, on_.id, memory_);
  }
  template <class T>
  void clear(T* what, int byte, std::size_t n) const {
    const device_guard guard(on_.id);
    check_cuda(cudaMemsetAsync(what, byte, n * sizeof(T), on_.stream), "cudaMemsetAsync");
  }

  device on_;
  std::uint32_t robots_;  ///< Of a configuration.
  model_view<PartView> model_;
  std::vector<part_facts> facts_;
  std::pmr::memory_resource* memory_;
  processors_of processors_;
  side_stream beside_;
  raised_limits limits_;
  std::uint32_t configurations_ = 0;  ///< Of all robots.
  std::uint64_t seen_ = 0;
  std::vector<world_transform> staged_;
  std::vector<Eigen::Isometry3d> anywhere_;  ///< Poses to place clouds on the host. The part places are not used.
  frames::cloud_frame frame_;
  std::vector<std::unique_ptr<cloud_tree::device_tree>> trees_;
  device_buffer<world_transform> poses_;
  device_buffer<frames::placement> places_;
  device_buffer<ball_bounds> bounds_;
  device_buffer<configuration_facts> of_all_;
  device_buffer<typename Question::memory_type> all_;
  device_buffer<margin_reach> near_;
  device_buffer<distance_key> part_best_;
  device_buffer<real> extras_;
  std::vector<real> extra_;  ///< See extra_reaches.
  device_buffer<last_place> last_;
  device_buffer<cloud_tree::numbered_point> seeds_;
  device_buffer<result_type> results_;
  device_buffer<counts> counts_;
  pieces<typename arguments::pair_type> left_, left_again_;
  pieces<field_pair> pieces_, pieces_again_;
  device_buffer<std::uint32_t> left_used_;
};

}  // namespace clearance::plan
