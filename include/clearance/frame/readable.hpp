// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds as a backend can read them. readable.cuh has a device's.

#include <clearance/backend/host.hpp>
#include <clearance/frame/mapped_clouds.hpp>

#include <algorithm>

namespace clearance::frames {

/// Takes every source as it is.
struct as_it_is {
  template <point_source S>
  const S& operator()(const S& source, std::uint32_t) const {
    return source;
  }
};

/// Copies of clouds that a backend cannot read where they are, with the clouds' numbers.
template <backend B>
using cloud_copies = std::vector<std::pair<std::uint32_t, typename B::template buffer<std::byte>>>;

/// The source itself if the backend can read its memory, else a source over a copy that `copies` keeps.
template <backend B>
struct readable_on {
  const B& on;
  cloud_copies<B>& copies;

  template <point_source S>
  S operator()(const S& source, std::uint32_t cloud) const {
    if constexpr (requires { source.at(source.bytes().data()); }) {
      if (source.size() != 0 && !on.reads(source.bytes().data())) {
        auto copy = std::find_if(copies.begin(), copies.end(), [cloud](const auto& c) { return c.first == cloud; });
        if (copy == copies.end()) copy = copies.insert(copy, {cloud, on.copy_in(source.bytes())});
        return source.at(copy->second.data());
      }
    }
    return source;
  }
};

/// The clouds of a question in every frame. This is for any backend but a device.
template <class On>
class readable_clouds {
 public:
  explicit readable_clouds(const On& on) : on_(on) {}

  /// The same clouds, in copies if `On` cannot read them where they are. Copies stay until the next call.
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

}  // namespace clearance::frames
