// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Arrays as clouds, of any library: those of std, CUDA's and Thrust's. No header of theirs is included, because what
// matters is what their elements and pointers can do.

#include <clearance/ground/borrowed.hpp>
#include <clearance/points/coordinate_arrays.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/slice.hpp>
#include <clearance/points/strided_points.hpp>

#include <iterator>
#include <memory>
#include <tuple>

namespace clearance {

/// A record with the members x, y and z, all float or all double: vec3, CUDA's float3, float4 and double3, PCL's
/// points.
template <class T>
concept xyz_record = std::is_standard_layout_v<T> && std::is_trivially_copyable_v<T> && requires(const T t) {
  requires std::is_same_v<decltype(t.x), float> || std::is_same_v<decltype(t.x), double>;
  requires std::is_same_v<decltype(t.x), decltype(t.y)> && std::is_same_v<decltype(t.x), decltype(t.z)>;
};

/// A source in a device's memory, which a host must not read. Its type says so, for the question that is asked.
template <point_source S>
struct in_device_memory : S {
  using can = can_all<typename S::can, clearance::can<sources::slicing>>;
  static constexpr bool only_on_device = true;

  CLEARANCE_HD in_device_memory(const S& source) : S(source) {}

  in_device_memory at(const std::byte* copy) const
    requires copied_source<S>
  {
    return S::at(copy);
  }
  template <class F>
  in_device_memory with_pieces(const F& f) const
    requires source_in_pieces<S>
  {
    return S::with_pieces(f);
  }

  CLEARANCE_HD auto slice(std::size_t begin, std::size_t end) const {
    const auto piece = clearance::slice(static_cast<const S&>(*this), begin, end);
    return in_device_memory<std::remove_const_t<decltype(piece)>>(piece);
  }
};

namespace detail {

/// The source itself, without the mark that its memory is a device's.
template <point_source S>
const S& read_here(const S& source) {
  return source;
}
template <point_source S>
const S& read_here(const in_device_memory<S>& source) {
  return source;
}

/// The address that a pointer or an iterator of any library stands for; nothing for those that do not say one.
template <class P>
constexpr auto address_of(const P& p) {
  if constexpr (std::is_pointer_v<P>)
    return p;
  else if constexpr (std::contiguous_iterator<P>)
    return std::to_address(p);
  else if constexpr (requires { requires std::is_pointer_v<decltype(p.get())>; })  // thrust::device_ptr
    return p.get();
  else if constexpr (requires {
                       requires std::is_same_v<decltype(*p), decltype(*p.base())>;
                     })  // an iterator of thrust::device_vector
    return address_of(p.base());
}
template <class P>
using pointed_to = std::remove_cv_t<std::remove_pointer_t<decltype(address_of(std::declval<const P&>()))>>;

template <class P>
concept points_to_records = xyz_record<pointed_to<P>>;

/// Three iterators as one, such as Thrust's zip iterator.
template <class P, std::size_t I>
using zipped_iterator = std::remove_cvref_t<decltype(get<I>(std::declval<const P&>().get_iterator_tuple()))>;
template <class P>
concept zips_coordinates = requires(const P p) {
  requires std::tuple_size<std::remove_cvref_t<decltype(p.get_iterator_tuple())>>::value == 3;
  requires std::is_same_v<pointed_to<zipped_iterator<P, 0>>, real>;
  requires std::is_same_v<pointed_to<zipped_iterator<P, 1>>, real>;
  requires std::is_same_v<pointed_to<zipped_iterator<P, 2>>, real>;
};

/// Thrust's pointers into a device's memory give no plain reference.
template <class P>
concept host_readable = std::is_lvalue_reference_v<decltype(*std::declval<const P&>())>;

template <class P>
concept zip_host_readable = host_readable<zipped_iterator<P, 0>> && host_readable<zipped_iterator<P, 1>> &&
                            host_readable<zipped_iterator<P, 2>>;

/// Throws std::invalid_argument unless neighbours of an iterator are neighbours in memory.
template <class P>
auto first_address(const P& first, std::size_t count) {
  const auto address = address_of(first);
  if (count > 1 && address_of(first + 1) != address + 1)
    refuse_source("points are given by an iterator over what is not an array");
  return address;
}

template <xyz_record T>
auto records_at(const T* first, std::size_t count) {
  using scalar = std::remove_const_t<decltype(T::x)>;
  constexpr bool tight = std::is_same_v<scalar, real> && sizeof(T) == sizeof(vec3) && offsetof(T, x) == 0 &&
                         offsetof(T, y) == sizeof(real) && offsetof(T, z) == 2 * sizeof(real);
  if constexpr (tight) {
    return point_span(reinterpret_cast<const vec3*>(first), count);
  } else {
    strided_points<scalar> records;
    records.data = reinterpret_cast<const std::byte*>(first);
    records.count = count;
    records.step = sizeof(T);
    records.offset[0] = offsetof(T, x);
    records.offset[1] = offsetof(T, y);
    records.offset[2] = offsetof(T, z);
    return records;
  }
}
template <bool OnHost, class S>
auto marked(const S& source) {
  if constexpr (OnHost)
    return source;
  else
    return in_device_memory<S>(source);
}

}  // namespace detail

/// The source of `count` points from an array's pointer or iterator on, of any library, to records with x, y and z; or
/// from a zip of three to floats. Metres. Throws std::invalid_argument if an iterator's elements are no array.
template <detail::points_to_records P>
auto points_of(const P& first, std::size_t count) {
  return detail::marked<detail::host_readable<P>>(detail::records_at(detail::first_address(first, count), count));
}
template <detail::zips_coordinates P>
auto points_of(const P& first, std::size_t count) {
  const auto& axes = first.get_iterator_tuple();
  const coordinate_arrays arrays{detail::first_address(get<0>(axes), count), detail::first_address(get<1>(axes), count),
                                 detail::first_address(get<2>(axes), count), count};
  return detail::marked<detail::zip_host_readable<P>>(arrays);
}

/// An array of points, or a view of one: whatever has a pointer to records with x, y and z, and a size.
template <class C>
concept point_container = !point_source<C> && (std::is_convertible_v<const C&, point_span> || requires(const C& c) {
  { std::size(c) } -> std::convertible_to<std::size_t>;
  requires detail::points_to_records<decltype(std::data(c))>;
});
/// An array that owns its points; a span views those of another array.
template <class C>
concept owning_points = point_container<C> && requires(const C& c) { std::data(c); } &&
                        !std::ranges::borrowed_range<C> && !requires { typename C::element_type; };

/// The source of an array's points, where they lie. Its `filter` can be set; `uncertain` and `sharded` take it.
template <point_container C>
auto points_of(const C& points CLEARANCE_LIFETIMEBOUND) {
  if constexpr (std::is_convertible_v<const C&, point_span>)
    return point_span(points);
  else
    return points_of(std::data(points), std::size(points));
}
template <owning_points C>
void points_of(const C&&) = delete;  // the points would be gone before they are read; name them

/// What an array's points become.
template <point_container C>
using points_in = decltype(points_of(std::declval<const C&>()));

}  // namespace clearance
