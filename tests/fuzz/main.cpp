// SPDX-License-Identifier: BSD-3-Clause
// What libFuzzer calls.

#include "fuzz/fuzz.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace fuzz {

struct known {
  reader read;
  damager damage;
};

static std::map<std::string, known>& targets() {
  static std::map<std::string, known> all;
  return all;
}
static known chosen{};

target::target(const char* name, reader read, damager damage) { targets()[name] = {read, damage}; }

void finding(const std::string& why) {
  std::fprintf(stderr, "FINDING: %s\n", why.c_str());
  std::abort();
}

bytes any_damage(const bytes& input) {
  bytes made = input;
  made.resize(input.size() + 64);
  made.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(made.data()), input.size(), made.size()));
  return made;
}

}  // namespace fuzz

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  const std::string_view sign = "--target=";
  char** const end = *arguments + *count;
  char** const at =
      std::find_if(*arguments, end, [&](const char* each) { return std::string_view(each).starts_with(sign); });
  const auto found = at == end ? fuzz::targets().end() : fuzz::targets().find(*at + sign.size());
  if (found == fuzz::targets().end()) {
    std::fputs("--target=NAME must be one of", stderr);
    for (const auto& each : fuzz::targets()) std::fprintf(stderr, " %s", each.first.c_str());
    std::fputs("\n", stderr);
    std::exit(2);
  }
  fuzz::chosen = found->second;
  std::rotate(at, at + 1, end);
  --*count;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::chosen.read({reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::mt19937 random(seed);
  if (!fuzz::chosen.damage || random() % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  const fuzz::bytes made = fuzz::chosen.damage({reinterpret_cast<const char*>(data), size}, random);
  if (made.empty() || made.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(made.begin(), made.end(), data);
  return made.size();
}
