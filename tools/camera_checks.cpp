// SPDX-License-Identifier: BSD-3-Clause
#include "camera_checks.hpp"

#include "command_line.hpp"
#include "report_text.hpp"

#include <fstream>
#include <string_view>

namespace {

struct image_size {
  std::uint32_t width, height;
  bool operator==(const image_size&) const = default;
};

/// The size of an image as the header of a PNG says; none if there is no such header, which whoever reads the file
/// says.
std::optional<image_size> size_of(const std::string& file) {
  unsigned char head[24] = {};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(head), sizeof head)) return std::nullopt;
  if (std::string_view(reinterpret_cast<const char*>(head), 8) != "\x89PNG\r\n\x1a\n") return std::nullopt;
  const auto big = [&](int at) {
    return std::uint32_t(head[at]) << 24 | std::uint32_t(head[at + 1]) << 16 | std::uint32_t(head[at + 2]) << 8 |
           std::uint32_t(head[at + 3]);
  };
  return image_size{big(16), big(20)};
}

std::string words(const std::string& file, image_size of) {
  return file + " has " + std::to_string(of.width) + " x " + std::to_string(of.height) + " pixels";
}

}  // namespace

void check_image_sizes(std::span<const cloud_options> clouds) {
  const cloud_options* first = nullptr;
  image_size expected{};
  for (const cloud_options& cloud : clouds) {
    if (!cloud.is_image() || !cloud.shares_camera) continue;
    const auto size = size_of(cloud.file);
    if (!size) continue;
    if (first && *size != expected)
      throw usage_error("--intrinsics", "are of one size of images, and " + words(first->file, expected) + ", but " +
                                            words(cloud.file, *size));
    if (!first) {
      first = &cloud;
      expected = *size;
    }
  }
}

void note_camera(const observation& image, std::vector<std::string>& notes) {
  const auto* frame = image.image();
  if (!frame) return;
  const double width = double(frame->width), height = double(frame->height), x = image.from.camera->cx,
               y = image.from.camera->cy;
  const auto outside = [](double at, double size) { return !(at >= -0.5 && at <= size - 0.5); };
  const auto aside = [](double at, double size) { return size >= 64 && !(at >= 0.3 * size && at <= 0.7 * size); };
  const bool out = outside(x, width) || outside(y, height);
  if (!out && !aside(x, width) && !aside(y, height)) return;
  notes.push_back(image.from.file + text(": the principal point %g, %g of --intrinsics is %s its %g x %g pixels: is it "
                                         "of images of this size?",
                                         x, y, out ? "outside" : "far from the middle of", width, height));
}
