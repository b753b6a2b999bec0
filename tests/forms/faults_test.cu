// SPDX-License-Identifier: BSD-3-Clause
// What fails on a device: memory ends at every allocation, the device's, pinned or the host's; what a user wrote
// throws; a kernel traps. The caller is told, nothing is lost, and the same object has the next answers, if there can
// be any.
// wraps: cudaMalloc cudaMallocFromPoolAsync cudaHostAlloc cudaFree cudaFreeAsync cudaFreeHost
#include "forms/faults.hpp"
#include "support/catch.hpp"
#include "support/chunked.hpp"
#include "support/counted_memory.cuh"
#include "support/frames_device.cuh"
#include "support/held_stream.cuh"

#include <clearance/device.cuh>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

namespace forms_device_faults_test {

namespace {

using testing::allocations;

/// The driver itself refused an allocation that had to fail.
std::atomic<bool> driver_refused = false;

/// What no device and no host has, to get the driver's own refusal.
constexpr std::size_t too_much = std::size_t(1) << 50;

/// `allocate(bytes)`, which fails as it does without memory where that has to end.
template <class Allocate>
cudaError_t allocate_or_fail(std::size_t bytes, const Allocate& allocate) {
  const bool fails = allocations.fails();
  const cudaError_t told = allocate(fails ? too_much : bytes);
  if (fails) driver_refused = true;
  if (told == cudaSuccess) ++allocations.living;
  return told;
}

}  // namespace

// The linker sends calls of the names above here.
extern "C" {
cudaError_t __real_cudaMalloc(void** p, std::size_t n);
cudaError_t __wrap_cudaMalloc(void** p, std::size_t n) {
  return allocate_or_fail(n, [=](std::size_t bytes) { return __real_cudaMalloc(p, bytes); });
}
cudaError_t __real_cudaMallocFromPoolAsync(void** p, std::size_t n, cudaMemPool_t pool, cudaStream_t s);
cudaError_t __wrap_cudaMallocFromPoolAsync(void** p, std::size_t n, cudaMemPool_t pool, cudaStream_t s) {
  return allocate_or_fail(n, [=](std::size_t bytes) { return __real_cudaMallocFromPoolAsync(p, bytes, pool, s); });
}
cudaError_t __real_cudaHostAlloc(void** p, std::size_t n, unsigned flags);
cudaError_t __wrap_cudaHostAlloc(void** p, std::size_t n, unsigned flags) {
  return allocate_or_fail(n, [=](std::size_t bytes) { return __real_cudaHostAlloc(p, bytes, flags); });
}
#define FREED(name, parameters, arguments)  \
  cudaError_t __real_##name parameters;     \
  cudaError_t __wrap_##name parameters {    \
    if (p != nullptr) --allocations.living; \
    return __real_##name arguments;         \
  }
FREED(cudaFree, (void* p), (p))
FREED(cudaFreeAsync, (void* p, cudaStream_t s), (p, s))
FREED(cudaFreeHost, (void* p), (p))
#undef FREED
}

using namespace testing;
using clearance::host, clearance::device, clearance::devices;

namespace {

/// A stream of the last device, which is not the current one if there are several.
struct its_stream {
  clearance::own_stream stream{[] {
    int count = 0;
    check(cudaGetDeviceCount(&count));
    return count - 1;
  }()};
  device on() const { return stream.on(); }
};

/// Is everything of the caller's as it was: the current device, the stream, and no error that a later call would be
/// blamed for?
bool left_alone(const device& gpu) {
  int current = -1;
  const bool no_error = cudaPeekAtLastError() == cudaSuccess, known = cudaGetDevice(&current) == cudaSuccess;
  cudaStreamCaptureStatus captured{};
  return no_error && known && current == 0 && cudaStreamIsCapturing(gpu.stream, &captured) == cudaSuccess &&
         captured == cudaStreamCaptureStatusNone && cudaStreamSynchronize(gpu.stream) == cudaSuccess;
}

/// Calls work and sees how a lack of memory is told: the driver's as a cuda_error, if there is memory for its sentence.
constexpr auto told_by_cuda = [](const end_of_memory& end, const auto& work) {
  driver_refused = false;
  try {
    work();
    return;
  } catch (const clearance::cuda_error& error) {
    if (error.code != cudaErrorMemoryAllocation) throw;
    if (!driver_refused) throw std::logic_error("what the host lacks is told as the device's");
  } catch (const std::bad_alloc&) {
    if (driver_refused && !end.for_good) throw std::logic_error("what the driver refused is told as the host's");
  }
  throw std::bad_alloc();
};

}  // namespace

TEST_CASE("Wherever memory ends for a device, nothing is lost", "[slow]") {
  const its_stream stream;
  const device gpu = stream.on();
  const devices two(std::vector<device>{gpu, gpu});
  const two_frames f;
  moving_frames in_two(2, 80);
  in_two.see(4200);
  const auto spheres = f.many.model();
  const auto meshes = closed_boxes(2);
  const auto end_memory = [&]<class Q>(const char* name, const Q& q, const auto& model) {
    using result = typename Q::result;
    const auto& poses = f.many.s.poses;
    DYNAMIC_SECTION(name) {
      verdict v;
      std::size_t places = 0;
      const auto once_on_host = [&](const moving_frames& at) -> result {
        return ask(host{1}, model, poses, at.here(), q);
      };
      const result of_few = once_on_host(f.few), of_many = once_on_host(f.many);
      const auto there = model.on(gpu);
      const auto on_both = model.on(two);
      const auto end_it = [&](const char* how, const auto& make, const auto& asked, const result& few,
                              const result& many) {
        const std::string what = std::string(name) + ", " + how;
        places += end_memory_of(make, asked, few, many, f, v, what, told_by_cuda);
        v.require(left_alone(gpu), what, ": something of the caller's is not as it was");
      };
      const auto nothing = [] { return 0; };
      end_it(
          "once", nothing, [&](int, const moving_frames& at) -> result { return ask(gpu, there, poses, at.here(), q); },
          of_few, of_many);
      end_it(
          "from the robot on", nothing,
          [&](int, const moving_frames& at) -> result {
            const auto again = model.on(gpu);
            clearance::query query(gpu, again, q);
            return query(poses, at.here());
          },
          of_few, of_many);
      const auto asked = [&](auto& query, const moving_frames& at) -> result { return query(poses, at.here()); };
      end_it("prepared", [&] { return clearance::query(gpu, there, q); }, asked, of_few, of_many);
      if constexpr (forms_of<Q>::in_pieces)
        end_it("on two", [&] { return clearance::query(two, on_both, q); }, asked, of_few, of_many);
      if constexpr (forms_of<Q>::by_deadline)
        end_it(
            "by a deadline", [&] { return clearance::query(gpu, there, q); },
            [&](auto& query, const moving_frames& at) -> result {
              if (&at == &f.few) return query(poses, at.here());
              return ask_by(query, poses, at.here(), std::chrono::hours(1), q, {.piece = 500}).result;
            },
            of_few, of_many);
      // Other questions in chunks are one loop around their own search.
      if constexpr (std::is_same_v<Q, clearance::min_distance> || std::is_same_v<Q, clearance::min_distance_per_part> ||
                    std::is_same_v<Q, clearance::zones>) {
        const auto in_chunks = [](const moving_frames& at) {
          return clearance::chunked(clearance::point_span(at.points[0]), 4096);
        };
        const auto of = [&](const moving_frames& at) -> result {
          return ask(host{1}, model, poses, clearance::point_span(at.points[0]), shifted(0, 0, 0), q);
        };
        struct object {
          decltype(clearance::chunked_query(gpu, there, q)) query;
          decltype(in_chunks(f.few)) few, many;
        };
        end_it(
            "in chunks",
            [&] { return object{clearance::chunked_query(gpu, there, q), in_chunks(f.few), in_chunks(in_two)}; },
            [&](object& its, const moving_frames& at) -> result {
              return its.query(poses, &at == &f.few ? its.few : its.many);
            },
            of(f.few), of(in_two));
      }
      std::printf("%s: memory has ended at %zu places\n", name, places);
    }
  };
  for_each_question([&](const char* name, const auto& q) { end_memory(name, q, spheres); });
  for_each_question_of_meshes([&](const char* name, const auto& q) { end_memory(name, q, meshes); });
  end_memory("min_distance of meshes", clearance::min_distance{}, meshes);
}

TEST_CASE("Wherever memory ends while a frame is enqueued or captured, nothing is lost", "[slow]") {
  using clearance::min_distance_per_part, clearance::part_minimum;
  const its_stream stream;
  const device gpu = stream.on();
  const two_frames f;
  const auto model = f.many.model();
  const auto& poses = f.many.s.poses;
  const auto there = model.on(gpu);
  const frame_there few(gpu, f.few), many(gpu, f.many);
  clearance::pinned_buffer<clearance::min_distance_result> all{1, 0};
  clearance::pinned_buffer<part_minimum> minima{there.size(), 0};
  const auto expected = [&](const moving_frames& at) {
    return ask(host{1}, model, poses, at.here(), min_distance_per_part{});
  };
  const auto make = [&] { return clearance::query(gpu, there, min_distance_per_part{}); };
  const auto enqueue = [&](auto& query, const moving_frames& at) {
    query.enqueue(poses, (&at == &f.few ? few : many).all, {all.data(), minima.data()});
  };
  const auto answer = [&]() -> min_distance_per_part::result {
    gpu.wait();
    return {std::exchange(*all.data(), {}), std::vector<part_minimum>(minima.data(), minima.data() + there.size())};
  };
  const auto enqueued = [&](auto& query, const moving_frames& at) { return enqueue(query, at), answer(); };
  const auto captured = [&](auto& query, const moving_frames& at) {
    enqueue(query, at);  // once before: a graph cannot allocate
    answer();
    const captured_graph graph(gpu.stream, [&] { enqueue(query, at); });
    graph.launch();
    return answer();
  };
  verdict v;
  const auto end_it = [&](const char* how, const auto& asked) {
    const auto places = end_memory_of(make, asked, expected(f.few), expected(f.many), f, v, how, told_by_cuda);
    v.require(left_alone(gpu), how, ": something of the caller's is not as it was");
    std::printf("%s: memory has ended at %zu places\n", how, places);
  };
  end_it("enqueued", enqueued);
  end_it("captured", captured);
}

namespace {

/// A user's memory that throws instead of giving its k-th piece.
struct throwing_memory : std::pmr::memory_resource {
  counted_memory own;
  long left;
  explicit throwing_memory(long k) : left(k) {}

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (left-- == 0) throw std::runtime_error("the pool is closed");
    return own.allocate(bytes, alignment);
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t alignment) override {
    own.deallocate(p, bytes, alignment);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
};

template <class F>
std::string told_of(const F& f) {
  try {
    f();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

constexpr long never = std::numeric_limits<long>::max();

}  // namespace

TEST_CASE("What a user's code throws reaches a device's caller", "[slow]") {
  verdict v;
  const its_stream stream;
  const device gpu = stream.on();
  const two_frames f;
  moving_frames far(2, 81);
  far.see(20000);
  const auto& points = far.points[0];
  const auto& poses = f.many.s.poses;
  const auto ask_of = [&]<class Q>(const char* name, const Q& q, const auto& model) {
    using result = typename Q::result;
    const auto once = [&](const moving_frames& at) -> result { return ask(host{1}, model, poses, at.here(), q); };
    const result few = once(f.few), many = once(f.many);
    const auto there = model.on(gpu);
    const auto same = [&](auto& prepared, const std::string& what) {
      v.require(same_answer(result(prepared(poses, f.few.here())), few), what, ": another answer of few");
      v.require(same_answer(result(prepared(poses, f.many.here())), many), what, ": another answer");
      v.require(left_alone(gpu), what, ": something of the caller's is not as it was");
    };
    for (long k = 0;; ++k) {  // the user's own memory
      const std::string what = std::string(name) + ", piece " + std::to_string(k);
      throwing_memory memory(k);
      std::pmr::memory_resource* const from = &memory;
      std::string told = "none";
      {
        using asker = decltype(clearance::query(gpu, there, q, from));
        std::optional<asker> prepared;
        told = told_of([&] { prepared.emplace(gpu, there, q, from); });
        if (told.empty()) {
          told = told_of([&] { (*prepared)(poses, f.many.here()); });
          memory.left = never;
          same(*prepared, what);
        }
      }
      v.require(told.empty() || told == "the pool is closed", what, ": told ", told);
      v.require(memory.own.held == 0, what, ": memory is lost");
      if (told.empty()) break;
    }
    if constexpr (forms_of<Q>::by_deadline) {
      clearance::query prepared(gpu, there, q);
      for (const int pieces : {0, 1, 3}) {
        int at = 0;
        const auto go_on = [&] { return at++ < pieces ? true : throw std::runtime_error("the operator pressed stop"); };
        const std::string told = told_of([&] { ask_while(prepared, poses, f.many.here(), go_on, q, {.piece = 300}); });
        v.require(told == "the operator pressed stop", name, ": told ", told);
        same(prepared, std::string(name) + ", stopped");
      }
    }
    if constexpr (forms_of<Q>::in_pieces) {
      long left = never;
      const auto read = [&](std::size_t offset, std::span<std::byte> to) {
        if (left-- == 0) throw std::runtime_error("the disk is gone");
        std::memcpy(to.data(), reinterpret_cast<const std::byte*>(points.data()) + offset, to.size());
      };
      clearance::chunked cloud(clearance::read_records(points.size(), sizeof(vec3), read, points_at), 4096);
      clearance::chunked_query by_chunks(gpu, there, q);
      const result whole = ask(host{1}, model, poses, clearance::point_span(points), shifted(0, 0, 0), q);
      for (const long k : {0, 1, 4, 2}) {
        left = k;
        const std::string told = told_of([&] { by_chunks(poses, cloud); });
        v.require(told == "the disk is gone", name, ", chunk ", k, ": told ", told);
        left = never;
        v.require(same_answer(result(by_chunks(poses, cloud)), whole), name, ": another answer after chunk ", k);
        v.require(left_alone(gpu), name, ": something of the caller's is not as it was after chunk ", k);
        cloud.forget();
      }
    }
  };
  const auto spheres = f.many.model();
  for_each_question([&](const char* name, const auto& q) { ask_of(name, q, spheres); });
  const auto meshes = closed_boxes(2);
  for_each_question_of_meshes([&](const char* name, const auto& q) { ask_of(name, q, meshes); });
}

namespace {

__global__ void trap() { __trap(); }
__global__ void take_time() {
  const long long start = clock64();
  while (clock64() - start < 40'000'000) {
  }
}

}  // namespace

TEST_CASE("A question that waits for long leaves no error to the caller's next call") {
  const its_stream stream;
  const device gpu = stream.on();
  const two_frames f;
  const auto model = f.many.model();
  const auto there = model.on(gpu);
  clearance::query prepared(gpu, there, clearance::min_distance{});
  const auto expected = ask(host{1}, model, f.many.s.poses, f.many.here(), clearance::min_distance{});
  for (int time = 0; time < 3; ++time) {
    gpu.launch(take_time, 1, 1, 0);
    CHECK(same_answer(prepared(f.many.s.poses, f.many.here()), expected));
    CHECK(cudaPeekAtLastError() == cudaSuccess);
  }
}

TEST_CASE("Every question of a process, before and after a kernel traps", "[.after_a_trap][slow]") {
  const two_frames f;
  const auto& poses = f.many.s.poses;
  verdict v;
  std::size_t threw = 0;
  const auto spheres = f.many.model();
  const auto meshes = closed_boxes(2);
  {
    const clearance::own_stream stream(0);
    const device gpu = stream.on();
    const devices two(std::vector<device>{gpu, gpu});
    struct question {
      std::string name;
      std::function<void()> ask;
    };
    std::vector<question> all;
    const auto prepare = [&]<class Q>(const char* name, const Q& q, const auto& model) {
      const auto add = [&](const char* how, std::function<void()> ask) {
        all.push_back({std::string(name) + ", " + how, std::move(ask)});
      };
      const auto there = std::make_shared<decltype(model.on(gpu))>(model.on(gpu));
      add("once", [&, there, q] { ask(gpu, *there, poses, f.many.here(), q); });
      add("the robot", [&] { model.on(gpu); });
      const auto prepared = std::make_shared<decltype(clearance::query(gpu, *there, q))>(gpu, *there, q);
      add("prepared", [&, there, prepared] { (*prepared)(poses, f.many.here()); });
      add("prepared anew", [&, there, q] { clearance::query(gpu, *there, q); });
      if constexpr (forms_of<Q>::in_pieces) {
        const auto on_both = std::make_shared<decltype(model.on(two))>(model.on(two));
        const auto together = std::make_shared<decltype(clearance::query(two, *on_both, q))>(two, *on_both, q);
        add("on two", [&, on_both, together] { (*together)(poses, f.many.here()); });
        const auto by_chunks = std::make_shared<decltype(clearance::chunked_query(gpu, *there, q))>(gpu, *there, q);
        const auto cloud = std::make_shared<clearance::chunked<clearance::in_memory<clearance::point_span>>>(
            clearance::point_span(f.many.points[0]), 4096);
        add("in chunks", [&, there, by_chunks, cloud] { (*by_chunks)(poses, *cloud); });
      }
      if constexpr (forms_of<Q>::by_deadline)
        add("by a deadline", [&, there, prepared, q] {
          ask_by(*prepared, poses, f.many.here(), std::chrono::hours(1), q, {.piece = 500});
        });
    };
    for_each_question([&](const char* name, const auto& q) { prepare(name, q, spheres); });
    for_each_question_of_meshes([&](const char* name, const auto& q) { prepare(name, q, meshes); });
    for (const question& its : all) its.ask();  // all is well
    trap<<<1, 1, 0, gpu.stream>>>();
    for (int time = 0; time < 2; ++time)
      for (const question& its : all) {
        bool by_cuda = false;
        const std::string told = told_of([&] {
          try {
            its.ask();
          } catch (const clearance::cuda_error& error) {
            by_cuda = error.code != cudaSuccess && error.code != cudaErrorMemoryAllocation &&
                      std::string(error.what()).find(cudaGetErrorString(error.code)) != std::string::npos;
            throw;
          }
        });
        v.require(by_cuda, its.name, ": told ", told);
        threw += by_cuda;
      }
    REQUIRE(threw >= 2 * 15 * 4);
  }  // destructors say nothing
  const auto on_host = ask(host{1}, spheres, poses, f.many.here(), clearance::min_distance{});
  CHECK(on_host.point != clearance::none);
  std::printf("%zu questions have thrown CUDA's sentence\n", threw);
}

TEST_CASE("After a trap every question throws, and the process ends", "[slow]") {
  std::string first = "faults", its = "[after_a_trap]";
  char* const arguments[] = {first.data(), its.data(), nullptr};
  pid_t child = 0;
  REQUIRE(posix_spawn(&child, "/proc/self/exe", nullptr, nullptr, arguments, environ) == 0);
  int status = 0;
  pid_t ended = 0;
  for (int tenth = 0; tenth < 600 && ended == 0; ++tenth) {
    ended = waitpid(child, &status, WNOHANG);
    if (ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  if (ended == 0) kill(child, SIGKILL), waitpid(child, &status, 0);
  INFO("it has ended: " << ended << ", status " << status);
  CHECK(ended == child);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}

}  // namespace forms_device_faults_test
