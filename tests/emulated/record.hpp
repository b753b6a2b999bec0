// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a program answers, so that it can be compared with what another answers to the same questions. Each file of
// questions is compiled twice: as the host's (namespace clearance), and with kernels (clearance_on_device).

#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace emulated {

struct answer {
  std::string to, bytes;
};

/// Answers, in the order of the questions. Each value is written by its bytes, so no type may have padding.
class record {
 public:
  template <class... T>
  void put(const std::string& to, const T&... values) {
    answers_.push_back({to, {}});
    (add(values), ...);
  }
  const std::vector<answer>& answers() const { return answers_; }

 private:
  template <class T>
  void add(const T& value) {
    if constexpr (requires { value.begin(); }) {
      add(value.size());
      for (const auto& each : value) add(each);
    } else {
      static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
      const std::size_t at = answers_.back().bytes.size();
      answers_.back().bytes.resize(at + sizeof value);
      std::memcpy(answers_.back().bytes.data() + at, &value, sizeof value);
    }
  }

  std::vector<answer> answers_;
};

/// Asks, on the host or with kernels.
struct asker {
  void (*on_host)(record&) = nullptr;
  void (*by_kernels)(record&) = nullptr;
};
/// By the questions' name. A file of questions puts its own here.
inline std::map<std::string, asker>& askers() {
  static std::map<std::string, asker> all;
  return all;
}

}  // namespace emulated
