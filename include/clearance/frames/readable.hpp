// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds as a backend can read them. readable.cuh has a device's.

#include <clearance/backends/host.hpp>
#include <clearance/backends/plain.hpp>
#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/points/sharded.hpp>

#include <map>

namespace clearance::frames {

/// Takes every source as it is.
struct as_it_is {
  template <point_source S>
  const S& operator()(const S& source, std::uint32_t) const {
    return source;
  }
};

/// A source over other memory: `copy(bytes, n)` says where the n-th piece of its memory is to be read. Most sources
/// have one piece, and pieces without points none.
template <point_source S, class Copy>
S over_copies(const S& source, const Copy& copy) {
  std::uint32_t n = 0;
  const auto one = [&](const auto& piece, const auto& again) {
    if constexpr (copied_memory<std::remove_cvref_t<decltype(piece)>>) {
      const std::span<const std::byte> bytes = piece.bytes();
      const std::byte* const readable = piece.size() == 0 || bytes.empty() ? bytes.data() : copy(bytes, n++);
      return readable == bytes.data() ? piece : piece.at(readable);
    } else if constexpr (source_in_pieces<std::remove_cvref_t<decltype(piece)>>) {
      return piece.with_pieces([&](const auto& part) { return again(part, again); });
    } else {
      return piece;
    }
  };
  return one(source, one);
}

/// Copies of what a backend cannot read where it is, with the cloud's number and that of its piece.
template <backend B>
using cloud_copies = std::map<std::pair<std::uint32_t, std::uint32_t>, typename B::template buffer<std::byte>>;

/// The source itself if the backend can read its memory, else a source over a copy that `copies` keeps.
template <backend B>
struct readable_on {
  const B& on;
  cloud_copies<B>& copies;

  template <point_source S>
  S operator()(const S& source, std::uint32_t cloud) const {
    return over_copies(source, [&](std::span<const std::byte> bytes, std::uint32_t piece) -> const std::byte* {
      if (on.reads(bytes.data())) return bytes.data();
      const std::pair number{cloud, piece};
      auto copy = copies.find(number);
      if (copy == copies.end()) copy = copies.emplace(number, on.copy_in(bytes)).first;
      return copy->second.data();
    });
  }
};

/// The clouds of a question in every frame. This is for any backend but a device.
template <class On>
class readable_clouds {
 public:
  explicit readable_clouds(const On& on) : on_(on) {}

  /// The clouds themselves, or copies if `On` cannot read them where they are. Copies stay until the next call.
  template <class Clouds>
  decltype(auto) operator()(const Clouds& clouds) {
    if constexpr (std::is_same_v<On, host>) {
      return (clouds);
    } else {
      copies_.clear();
      return mapped_clouds(clouds, to_readable{&on_, &copies_});
    }
  }

 private:
  struct to_readable {
    const On* on;
    cloud_copies<On>* copies;
    std::uint32_t cloud = 0;

    template <point_source S>
    S operator()(const S& source) {
      return readable_on<On>{*on, *copies}(source, cloud++);
    }
  };

  On on_;
  cloud_copies<On> copies_;
};

template <class B, class Traversal>
class readable_clouds<plain<B, Traversal>> : public readable_clouds<B> {
 public:
  using readable_clouds<B>::readable_clouds;
};

}  // namespace clearance::frames
