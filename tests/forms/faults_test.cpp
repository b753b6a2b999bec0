// SPDX-License-Identifier: BSD-3-Clause
// Memory ends at every allocation, and what a user wrote throws, in every question and form: the caller is told,
// nothing is lost, and the same object then answers with the bits of a fresh one.
#include "forms/faults.hpp"
#include "support/catch.hpp"
#include "support/tallied.hpp"

#include <clearance/questions/collect.hpp>

#include <atomic>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

namespace forms_faults_test {

using namespace testing;
using clearance::host;

namespace {

/// An answer of the user's that throws instead of taking its k-th pair.
struct throwing_answer {
  tallied all;
  std::atomic<long>* left;

  real reach(std::uint32_t part) const { return all.reach(part); }
  void take(const clearance::pair_distance& pair) const {
    if (left->fetch_sub(1) == 0) throw std::runtime_error("there is no place for a pair");
    all.take(pair);
  }
};

/// A camera of the user's that throws instead of giving its k-th point.
struct throwing_source {
  clearance::point_span points;
  std::atomic<long>* left;

  std::size_t size() const { return points.size(); }
  clearance::sample operator[](std::size_t i) const {
    if (left->fetch_sub(1) == 0) throw std::runtime_error("the camera is gone");
    return points[i];
  }
};

constexpr long never = std::numeric_limits<long>::max();

}  // namespace

TEST_CASE("Wherever memory ends, a question says so, loses nothing, and the same object has the next answers") {
  verdict v;
  const two_frames f;
  moving_frames in_two(2, 80);
  in_two.see(4200);
  const auto in_chunks = [](const moving_frames& at) {
    return clearance::chunked(clearance::point_span(at.points[0]), 4096);
  };
  const auto spheres = f.many.model();
  const auto meshes = closed_boxes(2);
  const auto end_memory = [&]<class Q>(const char* name, const Q& q, const auto& model) {
    using result = typename Q::result;
    const auto& poses = f.many.s.poses;
    const auto once = [&](int, const moving_frames& at) -> result { return ask(host{1}, model, poses, at.here(), q); };
    const result of_few = once(0, f.few), of_many = once(0, f.many);
    end_memory_of([] { return 0; }, once, of_few, of_many, f, v, name);
    for (const unsigned threads : {1u, 2u})
      end_memory_of([&] { return clearance::query(host{threads}, model, q); },
                    [&](auto& query, const moving_frames& at) -> result { return query(poses, at.here()); }, of_few,
                    of_many, f, v, std::string(name) + ", prepared, threads " + std::to_string(threads));
    if constexpr (forms_of<Q>::by_deadline)
      end_memory_of([&] { return clearance::query(host{1}, model, q); },
                    [&](auto& query, const moving_frames& at) -> result {
                      // Few are asked plainly: what the pieces have left would show.
                      if (&at == &f.few) return query(poses, at.here());
                      return ask_by(query, poses, at.here(), std::chrono::hours(1), q, {.piece = 500}).result;
                    },
                    of_few, of_many, f, v, std::string(name) + ", by a deadline");
    // Other questions in chunks are the same loop around their own search.
    if constexpr (std::is_same_v<Q, clearance::min_distance> || std::is_same_v<Q, clearance::zones>) {
      const auto of = [&](const moving_frames& at) -> result {
        return ask(host{1}, model, poses, clearance::point_span(at.points[0]), shifted(0, 0, 0), q);
      };
      const auto make = [&] {
        return std::tuple(clearance::chunked_query(host{1}, model, q), in_chunks(f.few), in_chunks(in_two));
      };
      const auto asked = [&](auto& object, const moving_frames& at) -> result {
        return &at == &f.few ? std::get<0>(object)(poses, std::get<1>(object))
                             : std::get<0>(object)(poses, std::get<2>(object));
      };
      end_memory_of(make, asked, of(f.few), of(in_two), f, v, std::string(name) + ", in chunks");
    }
  };
  for_each_question([&](const char* name, const auto& q) { end_memory(name, q, spheres); });
  for_each_question_of_meshes([&](const char* name, const auto& q) { end_memory(name, q, meshes); });
  end_memory("min_distance of meshes", clearance::min_distance{}, meshes);
}

TEST_CASE("What a source throws reaches the caller, and the same object has the next answers") {
  verdict v;
  const two_frames f;
  const auto& poses = f.many.s.poses;
  const auto ask_of = [&]<class Q>(const char* name, const Q& q, const auto& model) {
    using result = typename Q::result;
    std::atomic<long> left = never;
    const auto cloud = [&](const moving_frames& at) {
      return clearance::placed<throwing_source>{{clearance::point_span(at.points[0]), &left}, shifted(0, 0, 0)};
    };
    const result few = ask(host{1}, model, poses, cloud(f.few), q), many = ask(host{1}, model, poses, cloud(f.many), q);
    for (const unsigned threads : {1u, 2u}) {
      clearance::query prepared(host{threads}, model, q);
      for (const long k : {0, 1, 127, 128, 700, 1099}) {
        const std::string what =
            std::string(name) + ", threads " + std::to_string(threads) + ", point " + std::to_string(k);
        left = k;
        std::string told;
        try {
          prepared(poses, cloud(f.many));
        } catch (const std::runtime_error& error) {
          told = error.what();
        }
        v.require(told == "the camera is gone", what, ": told ", told);
        left = never;
        v.require(same_answer(result(prepared(poses, cloud(f.few))), few), what, ": another answer of few");
        v.require(same_answer(result(prepared(poses, cloud(f.many))), many), what, ": another answer");
      }
    }
  };
  const auto spheres = f.many.model();
  for_each_question([&](const char* name, const auto& q) { ask_of(name, q, spheres); });
  const auto meshes = closed_boxes(2);
  for_each_question_of_meshes([&](const char* name, const auto& q) { ask_of(name, q, meshes); });
}

TEST_CASE("What an answer, or an order to stop, throws reaches the caller, and the same object has the next answers") {
  const two_frames f;
  const auto& poses = f.many.s.poses;
  const auto cloud = f.many.here();
  const auto model = f.many.model();
  std::atomic<long> left = never;
  tally_of_pairs expected;
  using asked = clearance::collect<throwing_answer>;
  ask(host{1}, model, poses, cloud, asked{{{1, expected.words}, &left}});
  REQUIRE(expected.words[0] > 100);
  for (const unsigned threads : {1u, 2u}) {
    clearance::query prepared(host{threads}, model, asked{{{1, expected.words}, &left}});
    for (const long k : {0l, 1l, 99l, long(expected.words[0]) - 1}) {
      tally_of_pairs unfinished, found;
      left = k;
      CHECK_THROWS_WITH(prepared(poses, cloud, {{{1, unfinished.words}, &left}}), "there is no place for a pair");
      left = never;
      prepared(poses, cloud, {{{1, found.words}, &left}});
      CHECK(found == expected);
    }
  }
  const clearance::min_distance q;
  clearance::query prepared(host{}, model, q);
  const auto once = ask(host{}, model, poses, cloud, q);
  for (const int pieces : {0, 1, 3}) {
    int at = 0;
    const auto go_on = [&] { return at++ < pieces ? true : throw std::runtime_error("the operator pressed stop"); };
    CHECK_THROWS_WITH(ask_while(prepared, poses, cloud, go_on, q, {.piece = 300}), "the operator pressed stop");
    CHECK(same_answer(prepared(poses, cloud), once));
  }
}

}  // namespace forms_faults_test
