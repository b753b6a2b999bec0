// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Brings what a device wrote to the host. One kernel copies all of it into pinned memory, which the host watches: that
// takes a few microseconds, and each copy into pageable memory ten and more.

#include <clearance/backends/own_stream.cuh>
#include <clearance/backends/readback.hpp>

#include <atomic>

namespace clearance::backends {

/// Waits until the device has written `number` to a word of pinned memory. Throws cuda_error if the stream has failed.
inline void watch(const device& on, const volatile std::uint32_t& word, std::uint32_t number) {
  for (unsigned spins = 1; word != number; ++spins)
    if (spins % 4096 == 0 && cudaStreamQuery(on.stream) != cudaErrorNotReady && word != number) on.wait();
  std::atomic_thread_fence(std::memory_order_acquire);
}

/// What the kernel copies, and where it says that it has.
struct read_list {
  static constexpr std::uint32_t most = 8;

  struct piece {
    const std::byte* from;
    std::byte* to;
    std::size_t bytes;
    const unsigned long long* count;  ///< Unless it is null, only so many values are copied,
    std::size_t each;                 ///< of so many bytes.
  };

  piece pieces[most];
  std::uint32_t size;
  std::uint32_t number;
  std::uint32_t* done;  ///< Each block has a word, and writes `number` there.
};

template <class List>
__global__ void __launch_bounds__(256) readback_kernel(const __grid_constant__ List list) {
  start_early();
  const std::size_t first = blockIdx.x * std::size_t(blockDim.x) + threadIdx.x,
                    step = std::size_t(gridDim.x) * blockDim.x;
  for (std::uint32_t k = 0; k < list.size; ++k) {
    const auto& piece = list.pieces[k];
    std::size_t bytes = piece.bytes;
    if (piece.count != nullptr)
      if (const unsigned long long count = *piece.count; count < bytes / piece.each) bytes = count * piece.each;
    const bool wide = reinterpret_cast<std::uintptr_t>(piece.from) % sizeof(uint4) == 0;
    const std::size_t units = wide ? bytes / sizeof(uint4) : 0;
    for (std::size_t i = first; i < units; i += step)
      reinterpret_cast<uint4*>(piece.to)[i] = reinterpret_cast<const uint4*>(piece.from)[i];
    for (std::size_t i = units * sizeof(uint4) + first; i < bytes; i += step) piece.to[i] = piece.from[i];
  }
  __threadfence_system();
  __syncthreads();
  if (threadIdx.x == 0) static_cast<volatile std::uint32_t*>(list.done)[blockIdx.x] = list.number;
}

template <>
class readback<device> {
 public:
  explicit readback(const device& on, std::pmr::memory_resource* = nullptr) : on_(on) {}

  /// For `arriving` lists: the kernel writes into them, and nothing is copied again.
  static std::pmr::memory_resource* memory() { return kept_pinned(); }

  /// Waits for all that was enqueued, and takes every `read_array` and `read_value`. Throws cuda_error.
  template <class... Reads>
  void operator()(const Reads&... reads) {
    static_assert(2 * sizeof...(Reads) <= read_list::most);
    read_list list{};
    std::size_t bytes = most_blocks * sizeof(std::uint32_t);
    const std::size_t places[] = {add(list, bytes, reads)...};
    if (list.size != 0) copy(list, bytes);
    std::size_t k = 0, expected = expected_;
    ((expected = std::max(expected, take(places[k++], reads))), ...);
    expected_ = expected;
  }

 private:
  static constexpr unsigned most_blocks = 64;
  static constexpr std::size_t of_block = 32 << 10;    ///< Bytes that a block copies while there are few.
  static constexpr std::size_t most_bytes = 32 << 20;  ///< Longer arrays do not come through pinned memory.

  /// For how many values there will be room.
  template <class Read>
  std::size_t room_for(const Read& read) const {
    const std::size_t n = read.count == nullptr ? read.size : std::min(read.size, expected_);
    return n * sizeof(typename Read::value_type) <= most_bytes ? n : 0;
  }

  /// Adds a read to the list: its count, then its values. Returns where in pinned memory they begin.
  template <class Read>
  std::size_t add(read_list& list, std::size_t& bytes, const Read& read) const {
    using value = typename Read::value_type;
    static_assert(std::is_trivially_copyable_v<value> && alignof(value) <= alignof(memory_unit));
    const std::size_t begin = bytes;
    const auto put = [&](const void* from, std::size_t its_bytes, const unsigned long long* count, std::size_t each,
                         void* to = nullptr) {
      list.pieces[list.size++] = {.from = static_cast<const std::byte*>(from),
                                  .to = static_cast<std::byte*>(to),
                                  .bytes = its_bytes,
                                  .count = count,
                                  .each = each};
      if (to == nullptr) bytes += (its_bytes + sizeof(memory_unit) - 1) / sizeof(memory_unit) * sizeof(memory_unit);
    };
    if (read.count != nullptr) put(read.count, sizeof *read.count, nullptr, 1);
    if (const std::size_t n = room_for(read); n != 0) {
      void* to = nullptr;
      if constexpr (arrives<Read>)
        if (read.to.get_allocator().resource() == kept_pinned()) {
          read.to.resize(n);
          to = read.to.data();
        }
      put(read.from, n * sizeof(value), read.count, sizeof(value), to);
    }
    return begin;
  }

  /// Copies the list into pinned memory, and waits for it.
  void copy(read_list& list, std::size_t bytes) {
    if (box_.size() * sizeof(memory_unit) < bytes) {
      box_ = pinned_buffer<memory_unit>((bytes + sizeof(memory_unit) - 1) / sizeof(memory_unit), on_.id, kept_pinned());
      std::fill_n(words(), most_blocks, 0u);
      number_ = 0;
    }
    std::byte* to = bytes_of_box() + most_blocks * sizeof(std::uint32_t);
    std::size_t all = 0;
    for (std::uint32_t k = 0; k < list.size; ++k) {
      all += list.pieces[k].bytes;
      if (list.pieces[k].to != nullptr) continue;  // it goes where it stays
      list.pieces[k].to = to;
      to += (list.pieces[k].bytes + sizeof(memory_unit) - 1) / sizeof(memory_unit) * sizeof(memory_unit);
    }
    list.number = ++number_;
    list.done = words();
    const auto blocks = unsigned(std::clamp<std::size_t>(all / of_block, 1, most_blocks));
    on_.launch_early(readback_kernel<read_list>, blocks, 256, 0, list);
    for (unsigned b = 0; b < blocks; ++b) watch(on_, words()[b], number_);
  }

  /// Returns how many values to expect of an array with a count of which more have been written than came.
  template <class Read>
  std::size_t take(std::size_t place, const Read& read) {
    using value = typename Read::value_type;
    const std::size_t room = room_for(read);
    std::size_t n = read.size;
    if (read.count != nullptr) {
      n = std::size_t(
          std::min<unsigned long long>(n, *reinterpret_cast<const unsigned long long*>(bytes_of_box() + place)));
      place += sizeof(memory_unit);
    }
    if constexpr (arrives<Read>)
      if (n <= room && read.to.get_allocator().resource() == kept_pinned()) {
        read.to.resize(n);
        return 0;
      }
    if (n == 0) {
      read.take(nullptr, 0);
    } else if (n <= room) {
      read.take(reinterpret_cast<const value*>(bytes_of_box() + place), n);
    } else {
      const std::vector<value> values = on_.copy_out(read.from, n);
      read.take(values.data(), n);
      if (read.count != nullptr) return 2 * n;
    }
    return 0;
  }

  std::byte* bytes_of_box() const { return reinterpret_cast<std::byte*>(box_.data()); }
  std::uint32_t* words() const { return reinterpret_cast<std::uint32_t*>(box_.data()); }

  device on_;
  pinned_buffer<memory_unit> box_;  ///< The blocks' words, then what they copy.
  std::uint32_t number_ = 0;
  std::size_t expected_ = 4096;  ///< So many values of an array with a count come without being asked for again.
};

}  // namespace clearance::backends
