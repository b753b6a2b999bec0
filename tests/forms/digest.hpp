// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// One number for all bits of all answers to a question, in every frame of forms.hpp.

#include "forms/forms.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
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
    std::snprintf(line, sizeof line, "%016llx %s\n", static_cast<unsigned long long>(its), name.c_str());
    text += line;
  }
  return text;
}

/// Those that the repository keeps: the bits that every compiler, processor and GPU must give.
inline digests kept_digests(const char* part) {
  std::ifstream file(std::string(CLEARANCE_TEST_ROOT "/tests/forms/digests-") + part + ".txt");
  digests all;
  for (std::string number, name; file >> number >> name;) all[name] = std::stoull(number, nullptr, 16);
  return all;
}

/// How often each way is asked: once, or as often as the environment says.
inline int digest_runs() {
  const char* const said = std::getenv("CLEARANCE_DIGEST_RUNS");
  return said == nullptr ? 1 : std::atoi(said);
}

}  // namespace testing
