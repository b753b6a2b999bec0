// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Do intrinsics and images belong together?

#include "observations.hpp"

#include <span>

/// Throws usage_error if images of several sizes share one --intrinsics. Only the files' headers are read.
void check_image_sizes(std::span<const cloud_options> clouds);

/// Adds a note if the principal point of an image is not in it, or far from its middle.
void note_camera(const observation& image, std::vector<std::string>& notes);
