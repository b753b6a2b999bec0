// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What can be asked together: a question, clouds, a form and a backend. Everything follows from what they declare.

#include <clearance/backends/plain.hpp>
#include <clearance/concepts.hpp>
#include <clearance/frames/clouds.hpp>
#include <clearance/points/cropped.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/points/uncertain.hpp>

namespace clearance {

/// How a question is asked. `once` is also by a prepared query. Several devices and ranks are backends, not forms.
enum class form { once, enqueued, in_chunks, by_deadline };

/// Why a combination is refused. `sentence` is what the compiler prints: each is said here and nowhere else.
namespace refusals {

/// Nothing speaks against it.
struct none {
  static constexpr const char* sentence = nullptr;
  template <class...>
  static consteval bool explain() {
    return true;
  }
};

/// Declares a reason, which is a type.
#define CLEARANCE_REFUSAL(NAME, SENTENCE)                                           \
  struct NAME {                                                                     \
    static constexpr const char* sentence = SENTENCE;                               \
    template <class... Asked>                                                       \
    static consteval bool explain() {                                               \
      static_assert(sizeof...(Asked) == 0, SENTENCE); /* it is of what was asked */ \
      return false;                                                                 \
    }                                                                               \
  }

CLEARANCE_REFUSAL(not_images, "unseen is asked about depth_image and ray_image, or masked, cropped or uncertain ones");
CLEARANCE_REFUSAL(not_points, CLEARANCE_STANDS_FOR_MORE);
CLEARANCE_REFUSAL(device_memory,
                  "these points are in a device's memory, which a host cannot read: ask a device{} about them, or copy "
                  "them into a thrust::host_vector");
CLEARANCE_REFUSAL(host_decides,
                  "this question cannot be enqueued, because the host decides while it is answered: ask it, or prepare "
                  "a query and call that");
CLEARANCE_REFUSAL(not_placed, "configurations are placed, and asked about without poses, on a device{}, not by plain");
CLEARANCE_REFUSAL(placed_first,
                  "a question about many configurations is enqueued without poses, on a device{}: place(poses), then "
                  "enqueue(clouds)");
CLEARANCE_REFUSAL(not_many,
                  "joint vectors of a chain are for questions about many configurations: this one is asked about one, "
                  "by the poses of its parts");
CLEARANCE_REFUSAL(devices_have_no_stream,
                  "several devices have no one stream to enqueue in: their answer is waited for");
CLEARANCE_REFUSAL(ranks_have_no_stream, "ranks have no one stream to enqueue in: their answer is waited for");
CLEARANCE_REFUSAL(not_merged,
                  "this question cannot be asked about pieces of the clouds (several devices, chunks, ranks, a "
                  "deadline): its results cannot be merged. A question of your own needs: static void merge(result& "
                  "all, const result& other)");
CLEARANCE_REFUSAL(
    not_partial, "while points are unseen this question has no answer: it needs so_far(result&, std::uint64_t unseen)");
CLEARANCE_REFUSAL(several_by_deadline, "a deadline is for a host or a device, not for several");
CLEARANCE_REFUSAL(several_in_chunks, "a host or a device reads a cloud in chunks, no other backend");
CLEARANCE_REFUSAL(clouds_in_chunks,
                  "what is read in chunks is one cloud, chunked(source): ask about others by themselves, and merge");
CLEARANCE_REFUSAL(room_in_pieces,
                  "what pixels hide is asked about as a whole: not in chunks, by a deadline or on several devices");
#undef CLEARANCE_REFUSAL

}  // namespace refusals

namespace detail {

/// Does a source say what it hides? So do masked, cropped and uncertain images.
template <class S>
inline constexpr bool is_image = seeing_image<S>;
template <class S>
inline constexpr bool is_image<masked<S>> = is_image<S>;
template <class S>
inline constexpr bool is_image<cropped<S>> = is_image<S>;
template <class S, class N>
inline constexpr bool is_image<uncertain<S, N>> = is_image<S>;

/// Is `Test<S>` true for the sources of some clouds, each a type? `Of` variants: all kinds, or one at least.
enum class variants { all, any };
template <template <class> class Test, variants Of, class T>
struct holds;
template <template <class> class Test, variants Of, class T>
  requires(!point_source<T> && !point_container<T>)
struct holds<Test, Of, T> : holds<Test, Of, std::remove_cvref_t<decltype(*std::begin(std::declval<const T&>()))>> {};
template <template <class> class Test, variants Of, point_source S>
struct holds<Test, Of, S> : Test<S> {};
template <template <class> class Test, variants Of, point_container C>
struct holds<Test, Of, C> : Test<points_in<C>> {};
template <template <class> class Test, variants Of, point_source S>
struct holds<Test, Of, placed<S>> : Test<S> {};
template <template <class> class Test, variants Of, class... T>
struct holds<Test, Of, std::tuple<T...>> : std::bool_constant<(holds<Test, Of, T>::value && ...)> {};
template <template <class> class Test, variants Of, class... T>
struct holds<Test, Of, std::variant<T...>>
    : std::bool_constant<Of == variants::any ? (holds<Test, Of, T>::value || ...) : (holds<Test, Of, T>::value&&...)> {
};

template <class S>
struct of_image : std::bool_constant<is_image<S>> {};
template <class S>
struct of_points_alone : std::bool_constant<!capsule_source<S>> {};
template <class S>
struct of_points_or_balls : std::bool_constant<!capsule_source<S> || ball_source<S>> {};

template <class On>
inline constexpr bool is_several = requires { typename On::several; };
template <class On>
inline constexpr bool is_ranks = requires(const On on) { on.comm; };
/// A device that is not walked by `plain`.
template <class On>
inline constexpr bool is_one_device = requires { typename On::own_scan; } && !is_several<On> && !is_plain<On>;

}  // namespace detail

/// Why Q cannot be asked in this form, whatever the clouds: one of `refusals`.
template <class Q, form F, class On = host>
consteval auto refusal_of_form() {
  constexpr bool several = detail::is_several<On>;
  constexpr bool pieces = several || F == form::in_chunks || F == form::by_deadline;
  if constexpr (F == form::enqueued && detail::is_ranks<On>)
    return refusals::ranks_have_no_stream{};
  else if constexpr (F == form::enqueued && several)
    return refusals::devices_have_no_stream{};
  else if constexpr (F == form::enqueued && planning_question<Q> && !detail::is_one_device<On>)
    return refusals::not_placed{};
  else if constexpr (F == form::enqueued && !planning_question<Q> && !writing_question<Q>)
    return refusals::host_decides{};
  else if constexpr (F == form::by_deadline && several)
    return refusals::several_by_deadline{};
  else if constexpr (F == form::in_chunks && several)
    return refusals::several_in_chunks{};
  else if constexpr (F == form::by_deadline && !partial_question<Q>)
    return refusals::not_partial{};
  else if constexpr (pieces && !merging_question<Q> && !joining_question<Q>)
    return refusals::not_merged{};
  else
    return refusals::none{};
}

/// Why Q cannot be asked about these clouds in this form: one of `refusals`. `none` says that it compiles. Clouds whose
/// kind is known at run time are refused then, if a question about images gets others. Of `choosing` questions robots
/// are refused, too (any/query.hpp).
template <class Q, class Clouds, form F = form::once, class On = host>
consteval auto refusal_of() {
  using detail::variants, detail::holds;
  constexpr bool device = std::derived_from<On, host> && detail::some_on_device<Clouds>;
  constexpr bool slices =
      (detail::is_several<On> && !detail::is_ranks<On>) || F == form::in_chunks || F == form::by_deadline;
  if constexpr (device)
    return refusals::device_memory{};
  else if constexpr (lists<Q, of_images> && !holds<detail::of_image, variants::any, Clouds>::value)
    return refusals::not_images{};
  else if constexpr (lists<Q, of_points> && !holds<detail::of_points_alone, variants::all, Clouds>::value)
    return refusals::not_points{};
  else if constexpr (lists<Q, of_balls> && !holds<detail::of_points_or_balls, variants::all, Clouds>::value)
    return refusals::not_points{};
  else if constexpr (refusal_of_form<Q, F, On>().sentence != nullptr)
    return refusal_of_form<Q, F, On>();
  else if constexpr (F == form::in_chunks && !point_source<Clouds>)
    return refusals::clouds_in_chunks{};
  else if constexpr (slices && !holds<detail::of_points_or_balls, variants::all, Clouds>::value)
    return refusals::room_in_pieces{};
  else
    return refusals::none{};
}

/// The sentence that refuses it, or nullptr: it is asked.
template <class Q, class Clouds, form F = form::once, class On = host>
consteval const char* why_not() {
  return refusal_of<Q, Clouds, F, On>().sentence;
}

/// Can it be asked? The compiler prints the sentence if not.
template <class Q, class Clouds, form F = form::once, class On = host>
consteval bool explain_combination() {
  return decltype(refusal_of<Q, Clouds, F, On>())::template explain<Q, Clouds, On>();
}

}  // namespace clearance
