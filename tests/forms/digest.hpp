// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One number for all bits of all answers to a question, in every frame of forms.hpp.

#include "forms/forms.hpp"

#include <cstdio>
#include <cstdlib>
#include <map>

namespace testing {

/// FNV-1a, 64 bits.
inline std::uint64_t digest(const std::vector<std::byte>& bits, std::uint64_t h = 0xcbf29ce484222325) {
  for (const std::byte b : bits) h = (h ^ std::uint64_t(b)) * 0x100000001b3;
  return h;
}

using digests = std::map<std::string, std::uint64_t>;

/// `answer(question, model, frames)` is asked everything; what it does not answer returns nothing.
template <class Answer>
digests digests_of(const Answer& answer) {
  digests all;
  ask_everything([&](const char* name, const auto& q, const auto& model, const moving_frames& f) {
    if constexpr (!std::is_void_v<decltype(answer(q, model, f))>) {
      const auto [its, first] = all.try_emplace(name, digest({}));
      its->second = digest(bits_of(answer(q, model, f)), its->second);
    }
  });
  return all;
}

inline std::string text_of(const digests& all) {
  std::string text;
  for (const auto& [name, its] : all) {
    char line[200];
    std::snprintf(line, sizeof line, "{\"%s\", 0x%016llx},\n", name.c_str(), static_cast<unsigned long long>(its));
    text += line;
  }
  return text;
}

/// Those that the repository keeps: the bits that every compiler, processor and GPU must give.
inline const digests kept_digests = {
#include "forms/digests_frames.inc"
};
/// Of the first cloud alone, in chunks of any size.
inline const digests kept_digests_of_chunks = {
#include "forms/digests_chunks.inc"
};

/// How often each way is asked: once, or as often as the environment says.
inline int digest_runs() {
  const char* const said = std::getenv("CLEARANCE_DIGEST_RUNS");
  return said == nullptr ? 1 : std::atoi(said);
}

}  // namespace testing
