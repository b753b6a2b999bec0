// SPDX-License-Identifier: BSD-3-Clause
// The format's words up to a line end, then a message's bytes.
#include "fuzz/fuzz.hpp"

#include <clearance/io/compressed_depth.hpp>

#include <cmath>

namespace compressed_depth_target {

namespace {

using namespace clearance;

void read(std::string_view input) {
  const std::size_t end = std::min(input.find('\n'), input.size());
  const std::string_view format = input.substr(0, end), rest = input.substr(std::min(end + 1, input.size()));
  io::compressed_depth made;
  if (!fuzz::reads("m", [&] { made = io::read_compressed_depth(format, rest, "m", fuzz::limits); })) return;
  const std::size_t count = made.frame.width * made.frame.height;
  if (count == 0 || made.frame.pixels.size() != count) fuzz::finding("width times height is not the number of pixels");
  if (!made.metres.empty() && (made.metres.size() != count || made.short_by.size() != count))
    fuzz::finding("not as many depths as pixels");
  for (std::size_t i = 0; i < made.metres.size(); ++i)
    if (!(made.short_by[i] >= 0 && std::isfinite(made.short_by[i])) ||
        !(std::isnan(made.metres[i]) || (made.metres[i] > 0 && std::isfinite(made.metres[i]))))
      fuzz::finding("a depth that is none");
  if (made.frame.pixels != io::read_compressed_depth(format, rest, "m", fuzz::limits).frame.pixels)
    fuzz::finding("the same message twice, two images");
}

const fuzz::target compressed_depth("compressed_depth", read);

}  // namespace

}  // namespace compressed_depth_target
