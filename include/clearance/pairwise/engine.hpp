// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks questions about pairs of a point and a part on one backend, frame after frame.

#include <clearance/backends/kept_memory.hpp>
#include <clearance/backends/readback.hpp>
#include <clearance/frames/margins.hpp>
#include <clearance/frames/readable.hpp>
#include <clearance/pairwise/pairs_on.hpp>

namespace clearance::pairwise {

/// What a question is told before it is asked: the frame, and where memory comes from.
template <class On>
struct asked {
  static constexpr bool meets_points = pairs_on<On>::meets_points;

  const On& on;
  std::span<const part_facts> facts;
  const frames::frame_facts& frame;         ///< Of all clouds together.
  const std::vector<std::uint32_t>& first;  ///< The number of each cloud's first point among all clouds' points.
  std::size_t clouds, points;               ///< How many clouds there are, and points of all clouds.
  std::vector<real>& reaches;               ///< For the question's use: how near a point must be to each part.
  backends::kept_memory<On>& memory;
  backends::readback<On>& back;
  part_slops& slops;

  std::size_t parts() const { return facts.size(); }
  distance_certainty certain() const { return {frame.error, frame.slop, slops.of(facts)}; }

  /// Memory that the backend can write, for `n` values, until the next frame.
  template <class T>
  T* space(std::size_t n) const {
    return memory.template space<T>(n).data();
  }
  /// Copies for the backend, as a tuple of pointers; enqueued.
  template <class... Data>
  auto put(const Data&... data) const {
    return memory.put(data...);
  }
  /// Where `arriving` lists of a result take their memory.
  std::pmr::memory_resource* arrivals() const { return back.memory(); }
  /// Waits, and takes what the backend wrote, all at once: each of `reads` is a `read_array` or a `read_value`.
  template <class... Reads>
  void bring(const Reads&... reads) const {
    back(reads...);
  }
  /// Waits, and copies `n` values from memory that the backend writes.
  template <class T>
  std::vector<T> copy_out(const T* data, std::size_t n) const {
    std::vector<T> values;
    back(backends::read_array{values, data, n});
    return values;
  }
};

/// A question about pairs. `out` says where a backend writes, and has `point_counts* counts`.
///
/// Law: `space(asked)` is an `out` in memory of `asked`. `prepare(asked, out)`, or with the clouds, returns an
/// `answer`. `read(asked, out)` waits and makes the result of it.
template <class Q>
concept pair_question = question<Q> && requires(const Q q, const asked<host>& a, const typename Q::out& to) {
  { q.space(a) } -> std::same_as<typename Q::out>;
  { q.read(a, to) } -> std::same_as<typename Q::result>;
};

/// `pair_question<Q>` with reasons.
template <class Q>
consteval bool explain_pair_question() {
  using from = const asked<host>&;
  if constexpr (explain_question<Q>())
    return detail::pair_space::needs<requires(const Q q, from a) {
             { q.space(a) } -> std::same_as<typename Q::out>;
           }>() && detail::pair_read::needs<requires(const Q q, from a, const typename Q::out& to) {
             { q.read(a, to) } -> std::same_as<typename Q::result>;
           }>();
  else
    return false;
}

/// In place of a result that is not kept.
struct no_result {};

/// What a pass over all pairs of a frame needs. It is kept from frame to frame.
template <class On, class PartView>
class passes {
 public:
  template <class... Memory>
  passes(const On& on, const model_view<PartView>& model, Memory... from)
      : on(on),
        model(model),
        memory(on, from...),
        back(on, from...),
        readable(on, from...),
        pairs_{on, model, from...} {}

  On on;
  model_view<PartView> model;
  backends::kept_memory<On> memory;
  backends::readback<On> back;
  frames::readable_clouds<On> readable;

  /// Looks at a frame, and frees all rooms. Throws std::invalid_argument for poses that cannot be.
  template <class Clouds>
  asked<On> prepare(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds) {
    memory.begin();
    ahead_.facts_of(model.facts, poses, clouds);
    return last();
  }
  /// The frame that was looked at.
  asked<On> last() {
    return {.on = on,
            .facts = model.facts,
            .frame = ahead_.frame,
            .first = ahead_.first,
            .clouds = ahead_.clouds,
            .points = ahead_.points,
            .reaches = ahead_.reaches,
            .memory = memory,
            .back = back,
            .slops = slops_};
  }

  /// Enqueues a pass; clouds must be readable where it runs. `here(source, cloud)` is what is asked of a source.
  template <class Clouds, answer Answer, class Here = frames::as_it_is>
  void enqueue(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Answer& answer,
               point_counts* counts, const Here& here = {}) {
    pairs_.enqueue(poses, clouds, answer, counts, here);
  }

 private:
  typename pairs_on<On>::template kept<PartView> pairs_;
  frames::frame_ahead ahead_;
  part_slops slops_;
};

template <pair_question Q, class On, class PartView>
class engine {
 public:
  /// Whether there was enough room is known only when a frame is done.
  static constexpr bool waits = retrying::is_there<Q>();

  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from) : passes_(on, model, from...) {}

  /// Enqueues a frame. On a device it waits for nothing, and allocates only for more parts, clouds or options than ever
  /// before. A graph that captures this keeps the current poses and options.
  template <class Clouds>
  distance_certainty start(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q,
                           const typename Q::out& to) {
    const auto a = passes_.prepare(poses, clouds);
    pass(a, poses, clouds, q, to);
    return a.certain();
  }
  /// Enqueues a frame whose result `finish` returns; `q` must stay until then. A question that retries is asked here
  /// until there was enough room.
  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    const auto& readable = passes_.readable(clouds);
    if constexpr (waits) {
      static_assert(retrying::needs<requires(const asked<On>& a, const typename Q::out& to, typename Q::result& r,
                                             std::size_t n) {
        { q.space(a, n) } -> std::same_as<typename Q::out>;
        { q.more(a, to, r) } -> std::same_as<std::size_t>;
      }>());
      for (std::size_t least = 0;;) {
        const auto a = passes_.prepare(poses, clouds);
        to_ = q.space(a, least);
        pass(a, poses, readable, q, to_);
        least = q.more(a, to_, result_);
        if (least == 0) return;
      }
    } else {
      const auto a = passes_.prepare(poses, clouds);
      asked_ = &q;
      to_ = q.space(a);
      pass(a, poses, readable, q, to_);
    }
  }
  typename Q::result finish() {
    if constexpr (waits)
      return std::move(result_);
    else
      return read(*asked_, to_);
  }
  /// Waits for the last frame that was enqueued, and reads what it wrote.
  typename Q::result read(const Q& q, const typename Q::out& from) { return q.read(passes_.last(), from); }

  void forget() const {}  // it knows nothing of the last frame

 private:
  template <class Clouds>
  void pass(const asked<On>& a, std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q,
            const typename Q::out& to) {
    const auto answer = [&] {
      if constexpr (requires { q.prepare(a, to, clouds); })
        return q.prepare(a, to, clouds);
      else if constexpr (detail::pair_prepare::needs<requires { q.prepare(a, to); }>())
        return q.prepare(a, to);
    }();
    using answer_type = std::remove_const_t<decltype(answer)>;
    static_assert(explain_answer<answer_type>());
    passes_.enqueue(poses, clouds, answer, counts_of(to));
    if constexpr (concluding::is_there<Q>())
      if constexpr (concluding::needs<requires { q.conclude(a, answer, to); }>()) q.conclude(a, answer, to);
  }
  static point_counts* counts_of(const typename Q::out& to) {
    if constexpr (counting_question<Q>)
      return Q::counts_of(to);
    else if constexpr (counting::needs<requires { to.counts; }>())
      return to.counts;
  }

  passes<On, PartView> passes_;
  const Q* asked_ = nullptr;
  typename Q::out to_{};
  [[no_unique_address]] std::conditional_t<waits, typename Q::result, no_result> result_{};
};

}  // namespace clearance::pairwise
