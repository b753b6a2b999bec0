// SPDX-License-Identifier: BSD-3-Clause
// A file of fields of a robot, damaged where the input says. It is refused, or, if only cells differ, looked into
// safely.

#include "fuzz/fuzz.hpp"
#include "io/png_check.hpp"

#include <clearance/io/field_cache.hpp>
#include <clearance/usual_models.hpp>

namespace fields_target {

using namespace clearance;

namespace {

const sphere_model<>& robot() {
  static const sphere_model<> made = [] {
    const auto spheres = [](real x) { return std::vector<inner_sphere>{{{x, 0, 0}, 0.5f}, {{1, x, 0.1f}, 0.25f}}; };
    return with_fields(host{1}, make_model<sphere>(std::vector{spheres(0), spheres(0.3f)}), {20480}).model;
  }();
  return made;
}

/// Five bytes are one damage: its kind, where, and two numbers. The first byte says whether size and checksum then fit.
std::string damaged(std::string_view input) {
  std::string made = io::fields_bytes(robot());
  const auto number = [&](std::size_t at) { return std::size_t(std::uint8_t(input[at])); };
  for (std::size_t i = 1; i + 5 <= input.size(); i += 5) {
    const std::size_t kind = number(i) % 6;
    const std::size_t wide = number(i + 1) << 8 | number(i + 2), all = made.size();
    const std::size_t at = std::min(all, kind % 2 ? wide % 80 : wide);  // often in the first part's head
    if (kind < 2 && at < all) made[at] = input[i + 3];
    if (kind / 2 == 1) made.erase(at, number(i + 3) << (kind == 3 ? 0 : 8));
    if (kind / 2 == 2) made.insert(at, number(i + 3), input[i + 4]);
  }
  if (!input.empty() && input[0] % 4 != 0 && made.size() >= 28) {
    io::byte_writer size, sum;
    size.put(std::uint64_t(made.size()));
    made.replace(16, 8, size.bytes());
    sum.put(io::png_crc(std::string_view(made).substr(0, made.size() - 4)));
    made.replace(made.size() - 4, 4, sum.bytes());
  }
  return made;
}

void read(std::string_view input) {
  const std::string bytes = damaged(input);
  auto its = robot();
  if (!fuzz::reads("r.fields", [&] { its.set_fields(io::read_fields(bytes, "r.fields", std::span(robot().parts()))); }))
    return;
  if (io::fields_bytes(its) != bytes) fuzz::finding("written again, they are other fields");
  for (std::size_t k = 0; k < its.size(); ++k)
    for (const real x : {0.0f, 0.3f, -1e-30f, 2.0f, 11.0f, -300.0f, 3e38f, infinity, not_a_number})
      for (const real y : {0.0f, -0.7f, 9.0f, -3e38f}) static_cast<void>(its.view().fields[k]({x, y, -x}));
}

const fuzz::target fields("fields", read);

}  // namespace

}  // namespace fields_target
