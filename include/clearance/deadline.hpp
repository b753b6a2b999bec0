// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is known of a question when its time is over.

#include <clearance/query/pieces.hpp>
#include <clearance/query/query.hpp>

#include <bit>
#include <chrono>

namespace clearance {

/// The result about the points that there was time for. What it says is about all points: while some are unseen,
/// nothing is `free`. `result` says what is certain; `unseen` points were not looked at.
template <class Result>
struct so_far {
  Result result;
  std::uint64_t unseen = 0;
};

struct deadline_options {
  std::size_t piece = 0;  ///< Points between two looks at the clock; 0: a number that suits the backend.
};

namespace detail {

/// Says before each piece whether there is time for one as long as the last; before the first, whether there is any
/// time.
class stopwatch {
 public:
  /// Throws std::invalid_argument if the deadline is negative or NaN.
  explicit stopwatch(std::chrono::duration<double> deadline) : deadline_(deadline.count()) {
    if (!(deadline_ >= 0))
      throw std::invalid_argument("clearance: a deadline of " + std::to_string(deadline_) +
                                  " s; it must not be negative");
  }
  bool operator()() {
    const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(),
                 took = asked_ < 0 ? 0 : now - asked_;
    asked_ = now;
    return now + took < deadline_;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double deadline_, asked_ = -1;
};

/// The i-th piece to ask of n, a power of two: each is as far as possible from all before it.
inline std::size_t spread_piece(std::size_t i, std::size_t n) {
  std::size_t k = 0;
  for (std::size_t bit = 1; bit < n; bit *= 2) k = 2 * k + (i / bit & 1);
  return k;
}

/// Asks about pieces of the clouds, one after another, while `go_on()` says so.
template <class Q, class On, class PartView, class Poses, class Clouds, class GoOn>
so_far<typename Q::result> ask_pieces(query<Q, On, PartView>& ask, const Poses& poses, const Clouds& clouds,
                                      GoOn& go_on, const Q& q, const deadline_options& options) {
  detail::piece_numbers numbers;
  numbers.count(clouds);
  constexpr std::size_t usual = requires { typename On::own_scan; } ? 1 << 22 : 1 << 18;
  const std::size_t piece = options.piece != 0 ? options.piece : usual,
                    n = std::bit_ceil(std::size_t((numbers.total() + piece - 1) / piece));
  detail::joined_of<Q, PartView> all(q, ask.facts());
  std::uint64_t seen = 0;
  const auto ask_slices = [&](const detail::some_slices& slices) {  // of every cloud, so that errors are those of all
    if constexpr (bounded_engine<query<Q, On, PartView>>) ask.bound_by(all.reach());
    const auto place = numbers.place(clouds, slices);
    all.add(ask(poses, mapped_clouds(clouds, slices), q), place);
    for (const std::uint32_t count : place.count) seen += count;
  };
  try {
    std::size_t i = 0;
    for (; i < n && go_on(); ++i) {
      const std::size_t k = detail::spread_piece(i, n);
      ask_slices({k, k + 1, n});
    }
    if (i == 0) ask_slices({0, 0, n});  // at no points; what cannot be asked is refused all the same
  } catch (...) {
    ask.forget();  // also a bound that no frame has used
    throw;
  }
  ask.forget();
  so_far<typename Q::result> known{all.result(), numbers.total() - seen};
  Q::so_far(known.result, known.unseen);
  return known;
}

}  // namespace detail

/// As `ask_by`, as long as `go_on()` is true. It is asked before each piece: a clock of your own, or an order to stop.
/// `ask` is a prepared `query`; it forgets the last frame.
template <class Q, class On, class PartView, class Poses, class Clouds, class GoOn>
so_far<typename Q::result> ask_while(query<Q, On, PartView>& ask, const Poses& poses, const Clouds& clouds, GoOn go_on,
                                     const Q& q, const deadline_options& options = {}) {
  if constexpr (explain_given<Clouds>())
    if constexpr (explain_combination<Q, Clouds, form::by_deadline, On>())
      return detail::ask_pieces(ask, poses, clouds, go_on, q, options);
}

/// As the next function, with a prepared `query`, which saves preparation on a device.
template <class Q, class On, class PartView, class Poses, class Clouds>
so_far<typename Q::result> ask_by(query<Q, On, PartView>& ask, const Poses& poses, const Clouds& clouds,
                                  std::chrono::duration<double> deadline, const Q& q,
                                  const deadline_options& options = {}) {
  return ask_while(ask, poses, clouds, detail::stopwatch(deadline), q, options);
}

/// The answer, or what is known of it when `deadline` has passed since the call. Pieces are asked one after another,
/// spread over the clouds. If there is time for all, the result is that of `ask`, to the bit; if for none (0), nothing
/// is known. Throws std::invalid_argument as `ask`, and if the deadline is negative or NaN.
template <class On, class Robot, class Poses, class Clouds, class Q>
so_far<typename Q::result> ask_by(const On& on, const Robot& robot, const Poses& poses, const Clouds& clouds,
                                  std::chrono::duration<double> deadline, const Q& q,
                                  const deadline_options& options = {}) {
  static_assert(detail::explain_asked<On, Robot, Q>() && explain_given<Clouds>());
  const detail::stopwatch watch(deadline);
  return detail::one_call<On>::of(on, [&](auto... memory) {
    query prepared(on, robot, q, memory...);
    return ask_while(prepared, poses, clouds, watch, q, options);
  });
}

}  // namespace clearance
