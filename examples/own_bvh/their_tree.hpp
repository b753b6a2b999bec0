// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Stands for somebody else's library: a binary tree of linked nodes that has never heard of clearance. Its builder puts
// the nodes into memory that the caller gives it.

#include <algorithm>
#include <cstddef>
#include <span>

namespace theirs {

struct ball {
  float x, y, z, r;
  int number;
};

struct node {
  float low[3], high[3];
  const node* left;  // null in a leaf
  const node* right;
  ball content;  // of a leaf
};

/// Takes nodes from the front of `memory` (two a ball are enough) and returns the root.
inline const node* grow(std::span<ball> balls, std::span<node>& memory) {
  node& n = memory.front();
  memory = memory.subspan(1);
  n = {{1e9f, 1e9f, 1e9f}, {-1e9f, -1e9f, -1e9f}, nullptr, nullptr, balls[0]};
  for (const ball& b : balls) {
    const float c[3] = {b.x, b.y, b.z};
    for (int k = 0; k < 3; ++k) n.low[k] = std::min(n.low[k], c[k] - b.r), n.high[k] = std::max(n.high[k], c[k] + b.r);
  }
  if (balls.size() == 1) return &n;
  const std::size_t half = balls.size() / 2;
  std::ranges::nth_element(balls, balls.begin() + half, {}, &ball::x);
  n.left = grow(balls.first(half), memory);
  n.right = grow(balls.subspan(half), memory);
  return &n;
}

}  // namespace theirs
