// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points, balls, rigid transforms, and arithmetic that gives the same bits under every compiler.
//
// Rule of the whole library: where a product feeds a sum, it is written `fma`; a product never meets an operator + or -
// that a compiler could contract. So host and device, with and without -mfma, agree bit for bit.

#include <clearance/ground/config.hpp>
#include <clearance/ground/ptx.hpp>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace clearance {

using real = float;

/// Constants, because device code may not call the functions of numeric_limits.
inline constexpr real infinity = std::numeric_limits<real>::infinity();
inline constexpr real not_a_number = std::numeric_limits<real>::quiet_NaN();
inline constexpr real least_normal = std::numeric_limits<real>::min(), largest_real = std::numeric_limits<real>::max();

/// Relative slack by which every lower bound is lowered and every fit inflated: 32 units of rounding (2^-24), more than
/// all errors of a bound and of a leaf formula together.
inline constexpr real slack = 0x1p-19f;
/// Metres by which every fit is also inflated: squares of less than 1e-19 vanish, which no relative slack covers.
inline constexpr double vanishing = 0x1p-60;

struct vec3 {
  real x, y, z;

  friend constexpr bool operator==(const vec3&, const vec3&) = default;
};

/// Rounded once, never contracted with what follows.
CLEARANCE_HD inline real fma(real a, real b, real c) {
#if defined(__CUDA_ARCH__)
  return __fmaf_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

CLEARANCE_HD inline double fma(double a, double b, double c) {
#if defined(__CUDA_ARCH__)
  return __fma_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

/// a * b, for products that a sum elsewhere may meet: rounded, and never contracted with it. On x86-64 the compiler
/// does not see what it is: a function may be compiled for a processor that fuses though no macro says so
/// (`with_vectors`), and clang makes a product of fma(a, b, -0).
CLEARANCE_HD inline real product(real a, real b) {
#if defined(__CUDA_ARCH__)
  return __fmul_rn(a, b);
#elif defined(__x86_64__) && defined(__GNUC__)
  real rounded = a * b;
  asm("" : "+x"(rounded));
  return rounded;
#elif defined(__FMA__) || defined(__FP_FAST_FMAF)
  return std::fma(a, b, -0.0f);
#else
  return a * b;
#endif
}

CLEARANCE_HD inline real square_root(real a) {
#if defined(__CUDA_ARCH__)
  return __fsqrt_rn(a);
#else
  return std::sqrt(a);
#endif
}

CLEARANCE_HD inline real divide(real a, real b) {
#if defined(__CUDA_ARCH__)
  return __fdiv_rn(a, b);
#else
  return a / b;
#endif
}

CLEARANCE_HD constexpr vec3 operator+(vec3 a, vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
CLEARANCE_HD constexpr vec3 operator-(vec3 a, vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
CLEARANCE_HD constexpr vec3 operator-(vec3 a) { return {-a.x, -a.y, -a.z}; }
/// s * a + b.
CLEARANCE_HD inline vec3 fma(real s, vec3 a, vec3 b) { return {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)}; }
CLEARANCE_HD inline vec3 scaled(real s, vec3 a) { return fma(s, a, vec3{0, 0, 0}); }
CLEARANCE_HD inline real dot(vec3 a, vec3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
CLEARANCE_HD inline real length(vec3 a) { return square_root(dot(a, a)); }
/// A quicker root on a device, with a relative error of up to 2^-23 there. For bounds, which `slack` covers, never for
/// answers.
CLEARANCE_HD inline real rough_root(real a) {
#if defined(__CUDA_ARCH__)
  return ptx::rough_root(a);
#else
  return square_root(a);
#endif
}
/// The square root for loops that should become vector code. A host's own root reports negative numbers as errors,
/// which forbids that.
CLEARANCE_HD inline real looped_root(real a) {
#if defined(__CUDA_ARCH__)
  return rough_root(a);
#else
  real inverse =
      std::bit_cast<real>(0x5f3759dfu - (std::bit_cast<std::uint32_t>(a) >> 1));  // to 3 %; then Newton's steps
  for (int k = 0; k < 3; ++k) inverse *= 1.5f - 0.5f * a * inverse * inverse;
  return a * inverse;
#endif
}
CLEARANCE_HD inline real rough_length(vec3 a) { return rough_root(dot(a, a)); }
/// A quicker inverse likewise. That of a subnormal number may be infinite.
CLEARANCE_HD inline real rough_inverse(real a) {
#if defined(__CUDA_ARCH__)
  return ptx::rough_inverse(a);
#else
  return 1 / a;
#endif
}
CLEARANCE_HD inline vec3 cross(vec3 a, vec3 b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

CLEARANCE_HD constexpr real min(real a, real b) { return b < a ? b : a; }
CLEARANCE_HD constexpr real max(real a, real b) { return a < b ? b : a; }
/// The smaller number, for bounds: in one instruction on a device, which returns the number if the other is NaN.
CLEARANCE_HD inline real rough_min(real a, real b) {
#if defined(__CUDA_ARCH__)
  return fminf(a, b);
#else
  return min(a, b);
#endif
}
CLEARANCE_HD inline real rough_max(real a, real b) {
#if defined(__CUDA_ARCH__)
  return -fminf(-a, -b);
#else
  return max(a, b);
#endif
}
CLEARANCE_HD constexpr real clamp01(real t) { return t < 0 ? 0 : (t > 1 ? 1 : t); }
/// first ? a : b. `Looped`: by bits, for loops where compilers would turn a choice into branches.
template <bool Looped = true>
CLEARANCE_HD inline real choice(bool first, real a, real b) {
#if !defined(__CUDA_ARCH__)
  const std::uint32_t all = 0u - std::uint32_t(first);
  if constexpr (Looped)
    return std::bit_cast<real>((std::bit_cast<std::uint32_t>(a) & all) | (std::bit_cast<std::uint32_t>(b) & ~all));
#endif
  return first ? a : b;
}
template <bool Looped = true>
CLEARANCE_HD inline vec3 choice(bool first, vec3 a, vec3 b) {
  return {choice<Looped>(first, a.x, b.x), choice<Looped>(first, a.y, b.y), choice<Looped>(first, a.z, b.z)};
}
/// The same, and 0 for NaN.
CLEARANCE_HD inline real saturated(real t) {
#if defined(__CUDA_ARCH__)
  return __saturatef(t);
#else
  return t > 0 ? min(t, 1) : 0;
#endif
}
CLEARANCE_HD constexpr real absolute(real a) { return a < 0 ? -a : a; }

/// False for NaN, infinities and coordinates whose square would overflow (beyond 1e18 m).
CLEARANCE_HD constexpr bool is_finite(real a) { return -1e18f <= a && a <= 1e18f; }
CLEARANCE_HD inline bool is_finite(vec3 a) {
#if defined(__CUDA_ARCH__)
  return fabsf(a.x) <= 1e18f & fabsf(a.y) <= 1e18f & fabsf(a.z) <= 1e18f;  // no branches
#else
  return is_finite(a.x) && is_finite(a.y) && is_finite(a.z);
#endif
}

/// Rounds so that the compiler cannot see through it: g++ 12 at -O2 omits the rounding of neighbouring conversions to
/// float and back, and a proof about the rounded number would then hold for another one.
CLEARANCE_HD inline real to_float(double x) {
#if defined(__CUDA_ARCH__)
  return real(x);
#else
  const volatile real rounded = real(x);
  return rounded;
#endif
}

/// The largest float that is not above `x`, and the least that is not below.
CLEARANCE_HD inline real rounded_down(double x) {
  const real f = to_float(x);
  return double(f) > x ? nextafterf(f, -infinity) : f;
}
CLEARANCE_HD inline real rounded_up(double x) { return -rounded_down(-x); }

/// A computed `distance` to a volume of extent `size`, lowered so that rounding cannot push it above a true one.
CLEARANCE_HD constexpr real lowered(real distance, real size) { return distance - slack * (absolute(distance) + size); }

/// max(a, 0), but NaN for minus infinity. For loops where compilers would turn max into branches.
CLEARANCE_HD constexpr real positive_part(real a) { return (a + absolute(a)) * 0.5f; }
/// `positive_part` of a finite number, in one instruction on a device.
CLEARANCE_HD inline real rough_positive(real a) {
#if defined(__CUDA_ARCH__)
  return rough_max(a, 0);
#else
  return positive_part(a);
#endif
}
/// The largest squared distance to a volume, rounding included, at which its content may be within `reach`. It is NaN,
/// so that no comparison holds, if the reach is minus infinity.
CLEARANCE_HD constexpr real square_of_reach(real reach) {
  const real most = positive_part(reach);
  return most * most * (1 + 16 * slack) + least_normal;
}

/// A solid ball. Everything a volume must enclose is handed to it as balls (a point is a ball of radius 0).
struct ball {
  vec3 center;
  real radius;
};

/// x -> R x + t, in floats and in a fixed order of operations. Made from a double pose on the host (see pose.hpp).
struct rigid_transform {
  vec3 row[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  vec3 translation = {0, 0, 0};

  CLEARANCE_HD vec3 operator()(vec3 p) const {
    return {fma(row[0].x, p.x, fma(row[0].y, p.y, fma(row[0].z, p.z, translation.x))),
            fma(row[1].x, p.x, fma(row[1].y, p.y, fma(row[1].z, p.z, translation.y))),
            fma(row[2].x, p.x, fma(row[2].y, p.y, fma(row[2].z, p.z, translation.z)))};
  }
};

}  // namespace clearance
