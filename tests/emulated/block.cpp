// SPDX-License-Identifier: BSD-3-Clause
// ucontext makes a fiber; setjmp and longjmp switch, as in QEMU's coroutines, because swapcontext calls the kernel.
#undef _FORTIFY_SOURCE  // its longjmp refuses another stack
#include "emulated/block.hpp"

#include "emulated/shared_memory.hpp"

#include <cuda_runtime.h>

#include <setjmp.h>
#include <sys/mman.h>
#include <ucontext.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <thread>
#include <tuple>
#include <vector>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace emulated {

namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr std::size_t stack_bytes = 512 << 10;
#else
constexpr std::size_t stack_bytes = 128 << 10;
#endif
constexpr unsigned resident = 4;             ///< Blocks at a time.
constexpr std::uint64_t patience = 1 << 16;  ///< So often all threads may wait in vain.

const char* name_of(call what) {
  constexpr const char* names[] = {"__syncthreads",    "__syncthreads_and", "__syncthreads_or",  "__syncthreads_count",
                                   "__syncwarp",       "__ballot_sync",     "__any_sync",        "__all_sync",
                                   "__match_any_sync", "__shfl_sync",       "__shfl_xor_sync",   "__shfl_up_sync",
                                   "__shfl_down_sync", "__reduce_add_sync", "__reduce_min_sync", "__reduce_max_sync"};
  return names[int(what)];
}

/// One kernel at a time, and of its blocks one thread at a time: the one that holds the turn.
struct machine {
  std::mutex kernels, turns;
  std::condition_variable changed;
  unsigned seed = 0;
  std::minstd_rand random;
  std::vector<unsigned> waiting;  ///< Workers that want the turn.
  unsigned turn = 0;              ///< Worker that has it; 0: none.
  std::uint64_t in_vain = 0;
  unsigned turns_last = 1;  ///< So many switches, on average.
  std::string failed;
};
machine& all() {
  static machine one;
  return one;
}

struct copy {
  void* to;
  const void* from;
  std::size_t bytes;
};

struct fiber {
  char* stack = nullptr;
  jmp_buf at;
  bool done = true;
  std::uint64_t answer = 0;
  const char* waits = nullptr;
  std::uint32_t rank = 0;
  unsigned places = 0;                   ///< How often it has asked who is at its place.
  std::deque<std::vector<copy>> copies;  ///< The last ones are not committed yet.
#if defined(__SANITIZE_ADDRESS__)
  void* fake_stack = nullptr;
#endif
};

/// Lanes of a warp that wait for one another.
struct meeting {
  unsigned mask, here = 0;
  call what;
  std::array<std::uint64_t, 32> values{};
  std::array<int, 32> lanes{};
};

struct stopped {};  ///< Thrown on a worker's own stack.

/// A worker's block.
class block {
 public:
  explicit block(unsigned worker) : worker_(worker) {}
  ~block() {
    for (fiber& f : fibers_) munmap(f.stack, stack_bytes);
  }

  void run(unsigned number, unsigned threads, std::size_t shared, const std::function<void()>& body) {
    body_ = &body;
    live_ = threads;
    number_ = number;
    failure_.clear();
    while (fibers_.size() < threads) {
      fibers_.emplace_back();
      void* const memory =
          mmap(nullptr, stack_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
      mprotect(memory, 4096, PROT_NONE);
      fibers_.back().stack = static_cast<char*>(memory);
    }
    count_ = threads;
    ready_.clear();
    spinning_.clear();
    meetings_.assign((threads + 31) / 32, {});
    places_.assign((threads + 31) / 32, {});
    arrived_ = said_ = 0;
    barrier_.clear();
    empty_shared_memory(shared);
    for (unsigned t = 0; t < threads; ++t) {
      begin(t);
      ready_.push_back(t);
    }
    blockIdx = {number, 0, 0};
    go_on();
    open_shared_memory();
    if (!failure_.empty()) throw stopped{};
  }

  fiber& me() { return fibers_[now_]; }
  const std::string& failure() const { return failure_; }
  bool running() const { return running_; }

  unsigned meet_block(call what, bool mine) {
    if (arrived_ != 0 && kind_ != what)
      fail(std::string("threads of a block meet in ") + name_of(kind_) + " and " + name_of(what));
    kind_ = what;
    ++arrived_;
    said_ += mine;
    if (arrived_ == live_)
      open_barrier();
    else {
      barrier_.push_back(now_);
      sleep(name_of(what));
    }
    if (all().seed != 0 && chance() % 4 == 0) between();
    return unsigned(me().answer);
  }

  std::uint64_t meet_warp(call what, unsigned mask, std::uint64_t mine, int lane) {
    const unsigned warp = now_ / 32, bit = 1u << now_ % 32;
    if ((mask & bit) == 0) fail(std::string(name_of(what)) + " by a lane that is not in its mask");
    auto& its = meetings_[warp];
    auto m = std::find_if(its.begin(), its.end(), [mask](const meeting& k) { return k.mask == mask; });
    if (m == its.end()) m = its.insert(its.end(), {.mask = mask, .what = what});
    if (m->what != what) fail(std::string("lanes of a warp meet in ") + name_of(m->what) + " and " + name_of(what));
    m->here |= bit;
    m->values[now_ % 32] = mine;
    m->lanes[now_ % 32] = lane;
    if (m->here == (mask & alive(warp)))
      conclude(warp, m - its.begin());
    else
      sleep(name_of(what));
    return me().answer;
  }

  /// Waits until no lane of the warp can run that is not at such a place. Then those of one place go on.
  unsigned lanes_here(const void* place) {
    const unsigned warp = now_ / 32;
    places_[warp].push_back({now_, place, me().places++});
    sleep("__activemask");
    return unsigned(me().answer);
  }

  void between() {
    ready_.push_back(now_);
    leave();
  }
  void wait_for_others() {
    spinning_.push_back(now_);
    leave();
  }

  [[noreturn]] void fail(const std::string& why) {
    failure_ = "block " + std::to_string(number_) + ", thread " + std::to_string(now_) + ": " + why;
    to_worker();
    __builtin_unreachable();
  }

 private:
  struct at_place {
    unsigned thread;
    const void* place;
    unsigned count;  ///< Lanes in different rounds of a loop do not meet, as far as a GPU unrolls it or joins them.
    bool meets(const at_place& other) const { return place == other.place && count == other.count; }
  };

  unsigned alive(unsigned warp) const {
    unsigned lanes = 0;
    for (unsigned l = 0; l < 32 && warp * 32 + l < count_; ++l) lanes |= unsigned(!fibers_[warp * 32 + l].done) << l;
    return lanes;
  }

  void open_barrier() {
    const unsigned said = said_, live = live_;
    const unsigned answer = kind_ == call::sync_and ? said == live : kind_ == call::sync_or ? said != 0 : said;
    for (const unsigned t : barrier_) {
      fibers_[t].answer = answer;
      ready_.push_back(t);
    }
    if (!fibers_[now_].done) fibers_[now_].answer = answer;
    barrier_.clear();
    arrived_ = said_ = 0;
    all().in_vain = 0;
  }

  void conclude(unsigned warp, std::ptrdiff_t at) {
    const meeting m = meetings_[warp][std::size_t(at)];
    meetings_[warp].erase(meetings_[warp].begin() + at);
    std::uint64_t together = 0;
    unsigned those = 0, first = 1;
    const auto each = [&](auto f) {
      for (unsigned left = m.here; left != 0; left &= left - 1) f(unsigned(__builtin_ctz(left)));
    };
    each([&](unsigned l) {
      those |= unsigned(m.values[l] != 0) << l;
      const auto v = std::uint32_t(m.values[l]);
      if (m.what == call::sum) together = std::uint32_t(together + v);
      if (m.what == call::least) together = first ? v : std::min(std::uint32_t(together), v);
      if (m.what == call::most) together = first ? v : std::max(std::uint32_t(together), v);
      first = 0;
    });
    each([&](unsigned l) {
      const auto from = [&](int lane, bool own) {
        if (own) return m.values[l];
        if ((m.here >> lane & 1) == 0) fail(std::string(name_of(m.what)) + " reads a lane that is not there");
        return m.values[std::size_t(lane)];
      };
      std::uint64_t answer = together;
      const int lane = int(l), by = m.lanes[l];
      switch (m.what) {
        case call::ballot:
          answer = those;
          break;
        case call::any:
          answer = those != 0;
          break;
        case call::all:
          answer = those == m.here;
          break;
        case call::shuffle:
          answer = from(by & 31, false);
          break;
        case call::xored:
          answer = from((lane ^ by) & 31, (lane ^ by) > 31);
          break;
        case call::up:
          answer = from(lane - by, lane < by);
          break;
        case call::down:
          answer = from(lane + by, lane + by > 31);
          break;
        case call::match:
          answer = 0;
          each([&](unsigned k) { answer |= std::uint64_t(m.values[k] == m.values[l]) << k; });
          break;
        default:
          break;
      }
      const unsigned t = warp * 32 + l;
      fibers_[t].answer = answer;
      if (t != now_) ready_.push_back(t);
    });
    all().in_vain = 0;
  }

  // Who runs.

  void begin(unsigned t) {
    fiber& f = fibers_[t];
    f.done = false;
    f.waits = nullptr;
    f.places = 0;
    f.rank = chance();
    f.copies.assign(1, {});
    starting_ = t;
    ucontext_t made;
    getcontext(&made);
    made.uc_stack.ss_sp = f.stack + 4096;
    made.uc_stack.ss_size = stack_bytes - 4096;
    made.uc_link = nullptr;
    makecontext(&made, &block::enter, 0);
    one = this;
    if (_setjmp(worker_at_) == 0) {
      from_worker_to(f);
      setcontext(&made);
    }
    at_worker();
  }
  static void enter() {
    block& b = *one;
    const unsigned mine = b.starting_;
    b.at_first();
    if (_setjmp(b.fibers_[mine].at) == 0) {
      b.from_to_worker(b.fibers_[mine]);
      _longjmp(b.worker_at_, 1);
    }
    b.at_fiber(b.fibers_[mine]);
    (*b.body_)();
    b.finish();
  }

  void finish() {
    fiber& f = me();
    for (auto& batch : f.copies)
      for (const copy& c : batch) std::memcpy(c.to, c.from, c.bytes);
    f.copies.clear();
    f.done = true;
    --live_;
    all().in_vain = 0;
    // Those that wait for this thread now wait for one less.
    if (live_ != 0 && arrived_ == live_) open_barrier();
    const unsigned warp = now_ / 32, those = alive(warp);
    for (std::size_t k = 0; k < meetings_[warp].size();)
      if (const meeting& m = meetings_[warp][k]; m.here == (m.mask & those)) {
        conclude(warp, std::ptrdiff_t(k));
        k = 0;
      } else {
        ++k;
      }
    leave();
  }

  void sleep(const char* at) {
    me().waits = at;
    leave();
    me().waits = nullptr;
  }

  /// Runs another thread, or this one again.
  void leave() {
    const unsigned old = now_;
    if (!choose()) return to_worker();
    if (now_ == old) return;
    switch_to(fibers_[old], fibers_[now_]);
  }
  void switch_to(fiber& from, fiber& to) {
    threadIdx = {now_, 0, 0};
    if (_setjmp(from.at) == 0) {
      from_to(from, to);
      _longjmp(to.at, 1);
    }
    at_fiber(from);
  }
  /// Sets `now_` to a thread that can run. Returns false if the block has ended, or hangs.
  bool choose() {
    machine& m = all();
    if (live_ == 0) return false;
    for (;;) {
      if (m.seed != 0 && chance() % m.turns_last == 0) pass_turn();
      if (!m.failed.empty()) {
        failure_ = m.failed;
        return false;
      }
      if (ready_.empty()) meet_at_places();
      if (!ready_.empty()) break;
      if (spinning_.empty() || ++m.in_vain > patience) {
        failure_ = hangs();
        return false;
      }
      ready_.swap(spinning_);
      pass_turn();
    }
    std::size_t next = 0;
    if (m.seed != 0) switch (m.seed % 5) {
        case 1:  // any
          next = chance() % ready_.size();
          break;
        case 2:  // who came last
          next = ready_.size() - 1;
          break;
        case 3:  // a warp goes on as far as it can
          for (next = 0; next + 1 < ready_.size() && ready_[next] / 32 != now_ / 32;) ++next;
          if (ready_[next] / 32 != now_ / 32) next = chance() % ready_.size();
          break;
        case 4:  // by rank: some threads wait as long as others can run, until their ranks change
          for (std::size_t k = 1; k < ready_.size(); ++k)
            if (fibers_[ready_[k]].rank > fibers_[ready_[next]].rank) next = k;
          if (chance() % 512 == 0) fibers_[ready_[next]].rank = chance();
          break;
        default:  // who came first, mostly
          next = chance() % 8 == 0 ? chance() % ready_.size() : 0;
      }
    now_ = ready_[next];
    ready_.erase(ready_.begin() + std::ptrdiff_t(next));
    return true;
  }
  /// Lanes at one place have met if nobody else of the warp can come.
  void meet_at_places() {
    for (auto& its : places_) {
      if (its.empty()) continue;
      const at_place one = its[chance() % its.size()];
      unsigned those = 0;
      for (const at_place& p : its)
        if (p.meets(one) && (those == 0 || chance() % 8 != 1)) those |= 1u << p.thread % 32;
      std::erase_if(its, [&](const at_place& p) {
        if ((those >> p.thread % 32 & 1) == 0) return false;
        fibers_[p.thread].answer = those;
        ready_.push_back(p.thread);
        return true;
      });
      all().in_vain = 0;
    }
  }
  std::string hangs() const {
    std::map<std::string, unsigned> where;
    for (unsigned t = 0; t < count_; ++t)
      if (!fibers_[t].done) ++where[fibers_[t].waits != nullptr ? fibers_[t].waits : "a loop"];
    std::string said = "block " + std::to_string(number_) + " hangs:";
    for (const auto& [at, n] : where) said += " " + std::to_string(n) + " in " + at + ",";
    return said + " " + std::to_string(count_ - live_) + " of " + std::to_string(count_) + " ended";
  }

  /// Lets another block run, if one wants to.
  void pass_turn() {
    machine& m = all();
    std::unique_lock lock(m.turns);
    if (m.waiting.empty()) return;
    const std::size_t k = chance() % m.waiting.size();
    m.turn = m.waiting[k];
    m.waiting.erase(m.waiting.begin() + std::ptrdiff_t(k));
    m.waiting.push_back(worker_);
    m.changed.notify_all();
    m.changed.wait(lock, [&] { return m.turn == worker_; });
  }

  // The worker's own stack, from which fibers are begun and where a block ends.

  void go_on() {
    running_ = true;
    now_ = 0;
    if (choose()) {
      if (_setjmp(worker_at_) == 0) {
        threadIdx = {now_, 0, 0};
        from_worker_to(me());
        _longjmp(me().at, 1);
      }
      at_worker();
    }
    running_ = false;
  }
  void to_worker() {
    from_to_worker(me());
    _longjmp(worker_at_, 1);
  }

  // What the AddressSanitizer must know of a switch.
#if defined(__SANITIZE_ADDRESS__)
  void from_worker_to(fiber& to) { leave_stack(&fake_stack_, to.stack + 4096, stack_bytes - 4096); }
  void from_to(fiber& from, fiber& to) { leave_stack(kept(from), to.stack + 4096, stack_bytes - 4096); }
  void from_to_worker(fiber& from) { leave_stack(kept(from), worker_stack_, worker_size_); }
  void at_first() { __sanitizer_finish_switch_fiber(nullptr, &worker_stack_, &worker_size_); }
  void at_fiber(fiber& me) { __sanitizer_finish_switch_fiber(me.fake_stack, nullptr, nullptr); }
  void at_worker() { __sanitizer_finish_switch_fiber(fake_stack_, nullptr, nullptr); }
  static void** kept(fiber& f) { return f.done ? nullptr : &f.fake_stack; }
  static void leave_stack(void** fake, const void* to, std::size_t size) {
    __sanitizer_start_switch_fiber(fake, to, size);
  }
  void* fake_stack_ = nullptr;
  const void* worker_stack_ = nullptr;
  std::size_t worker_size_ = 0;
#else
  void from_worker_to(fiber&) {}
  void from_to(fiber&, fiber&) {}
  void from_to_worker(fiber&) {}
  void at_first() {}
  void at_fiber(fiber&) {}
  void at_worker() {}
#endif

  static thread_local block* one;

  unsigned worker_, number_ = 0, count_ = 0, live_ = 0, now_ = 0, starting_ = 0;
  bool running_ = false;
  std::deque<fiber> fibers_;
  std::vector<unsigned> ready_, spinning_, barrier_;
  unsigned arrived_ = 0, said_ = 0;
  call kind_ = call::sync;
  std::vector<std::vector<meeting>> meetings_;  ///< Of each warp.
  std::vector<std::vector<at_place>> places_;
  const std::function<void()>* body_ = nullptr;
  jmp_buf worker_at_;
  std::string failure_;
};
thread_local block* block::one = nullptr;
thread_local block* here = nullptr;

/// A worker's, whose stacks are kept for other kernels.
block& block_of(unsigned worker) {
  static std::map<unsigned, block> blocks;
  return blocks.try_emplace(worker, worker).first->second;
}

}  // namespace

void schedule(unsigned seed) {
  machine& m = all();
  const std::lock_guard lock(m.kernels);
  m.seed = seed;
  m.random.seed(seed + 1);
}
std::uint32_t chance() { return all().seed == 0 || here == nullptr ? 0 : std::uint32_t(all().random() >> 5); }

bool in_kernel() { return here != nullptr && here->running(); }

std::string run(unsigned blocks, unsigned threads, std::size_t shared, const std::function<void()>& body) {
  machine& m = all();
  const std::lock_guard one_kernel(m.kernels);
  m.turns_last = 8u << 3 * (m.seed == 0 ? 0 : m.random() / 64 % 4);
  m.failed.clear();
  m.in_vain = 0;
  m.turn = 0;
  m.waiting.clear();
  std::vector<unsigned> order(blocks);
  for (unsigned b = 0; b < blocks; ++b) order[b] = b;
  if (m.seed != 0)
    for (unsigned b = blocks; b > 1; --b) std::swap(order[b - 1], order[chance() % b]);
  std::size_t next = 0;
  const std::tuple dims(gridDim, blockDim);
  const unsigned workers = std::min(blocks, m.seed == 0 ? 1u : resident);
  for (unsigned w = 1; w <= workers; ++w) block_of(w);
  const auto work = [&](unsigned worker) {
    here = &block_of(worker);
    gridDim = {blocks, 1, 1};
    blockDim = {threads, 1, 1};
    try {
      while (next < order.size() && m.failed.empty()) here->run(order[next++], threads, shared, body);
    } catch (const stopped&) {
      if (m.failed.empty()) m.failed = here->failure();
    }
    here = nullptr;
  };
  if (workers == 1) {
    work(1);
  } else {
    std::vector<std::thread> pool;
    for (unsigned w = 2; w <= workers; ++w) m.waiting.push_back(w);
    m.turn = 1;
    for (unsigned w = 1; w <= workers; ++w)
      pool.emplace_back([&, w] {
        {
          std::unique_lock lock(m.turns);
          m.changed.wait(lock, [&] { return m.turn == w; });
        }
        work(w);
        const std::lock_guard lock(m.turns);
        m.turn = 0;
        if (!m.waiting.empty()) {
          m.turn = m.waiting.front();
          m.waiting.erase(m.waiting.begin());
        }
        m.changed.notify_all();
      });
    for (std::thread& t : pool) t.join();
  }
  std::tie(gridDim, blockDim) = dims;
  return m.failed;
}

unsigned meet_block(call what, bool mine) { return in_kernel() ? here->meet_block(what, mine) : mine; }
std::uint64_t meet_warp(call what, unsigned mask, std::uint64_t mine, int lane) {
  if (in_kernel()) return here->meet_warp(what, mask, mine, lane);
  switch (what) {
    case call::ballot:
    case call::any:
    case call::all:
      return mine != 0;
    case call::match:
      return 1;
    default:
      return mine;
  }
}
unsigned lanes_here(const void* place) { return in_kernel() ? here->lanes_here(place) : 1; }
void between() {
  if (in_kernel() && all().seed != 0 && chance() % 4 == 0) here->between();
}
void wait_for_others() {
  if (in_kernel()) here->wait_for_others();
}
void fail(const std::string& why) {
  if (!in_kernel()) std::abort();
  here->fail(why);
}

void copy_later(void* to, const void* from, std::size_t bytes) {
  here->me().copies.back().push_back({to, from, bytes});
}
void end_of_copies() { here->me().copies.emplace_back(); }
void wait_for_copies(unsigned but_last) {
  auto& copies = here->me().copies;
  for (; copies.size() > but_last + 1; copies.pop_front())
    for (const copy& c : copies.front()) std::memcpy(c.to, c.from, c.bytes);
}

}  // namespace emulated
