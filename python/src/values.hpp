// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// C++ values in Python: numbers, enumerations, arrays that view a result's memory, and results with their members.

#include "arrays.hpp"
#include "declared.hpp"
#include "sentences.hpp"

#include <clearance/ground/numbered.hpp>
#include <clearance/io/digest.hpp>
#include <clearance/point_source.hpp>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>

namespace nb = nanobind;

/// What an answer is about: the robot, by the names of its parts, which are for what is printed, too; and where it was.
struct asked_about {
  part_names names;
  clearance::io::digest poses;
  std::vector<std::size_t> shape = {};  ///< Of the configurations, if they have several axes.
};

/// A result in Python.
template <class R>
struct answered {
  R value;
  asked_about about;
};

template <class T>
inline constexpr bool is_array = requires(const T t) { t.data(), t.size(); } && !std::is_same_v<T, std::string>;

/// A NumPy dtype for plain data: a structured one for the library's structs.
nb::object dtype_of_members(const nb::list& names, const nb::list& formats, const nb::list& offsets, std::size_t size);

template <class T>
const char* scalar_format() {
  if constexpr (std::is_same_v<T, bool>) return "?";
  if constexpr (std::is_same_v<T, float>) return "<f4";
  if constexpr (std::is_same_v<T, double>) return "<f8";
  if constexpr (sizeof(T) == 1) return "u1";
  return sizeof(T) == 4 ? "<u4" : "<u8";
}
template <class T>
nb::object format_of() {
  if constexpr (std::is_same_v<T, clearance::vec3>) {
    return nb::make_tuple("<f4", nb::make_tuple(3));
  } else if constexpr (std::is_same_v<T, clearance::position>) {
    return nb::make_tuple("<f8", nb::make_tuple(3));
  } else if constexpr (std::is_array_v<T>) {
    return nb::make_tuple(scalar_format<std::remove_extent_t<T>>(), nb::make_tuple(std::extent_v<T>));
  } else if constexpr (declared_struct<T>) {
    nb::list names, formats, offsets;
    std::apply(
        [&](const auto&... m) {
          const auto add = [&]<class O, class M>(const char* name, M O::* at) {
            alignas(T) static const char room[sizeof(T)] = {};
            const auto& fake = *reinterpret_cast<const T*>(room);
            names.append(name), formats.append(format_of<M>());
            offsets.append(reinterpret_cast<const char*>(&(fake.*at)) - room);
          };
          (add(m.name, m.at), ...);
        },
        declared<T>::members);
    return dtype_of_members(names, formats, offsets, sizeof(T));
  } else {
    return nb::str(scalar_format<T>());
  }
}
template <class T>
nb::object dtype_of() {
  static nb::object* const made = new nb::object(format_of<T>());  // kept until the process ends
  return *made;
}

/// A NumPy array that views memory of `owner`.
template <class T>
nb::object array_of(const T* data, std::size_t size, nb::handle owner) {
  if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
    return nb::cast(nb::ndarray<nb::numpy, const T, nb::ndim<1>>(data, {size}, owner));
  } else if constexpr (std::is_enum_v<T>) {
    return array_of(reinterpret_cast<const std::underlying_type_t<T>*>(data), size, owner);
  } else {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(data);
    return nb::cast(nb::ndarray<nb::numpy, const std::uint8_t, nb::ndim<1>>(bytes, {size * sizeof(T)}, owner))
        .attr("view")(dtype_of<T>());
  }
}

template <class V>
nb::object three(const V& v) {
  return nb::make_tuple(v.x, v.y, v.z);
}

/// `owner` is the Python object that holds `value`; `name` its member's.
template <class T>
nb::object to_python(const T& value, nb::handle owner, const asked_about& about) {
  if constexpr (std::is_same_v<T, clearance::vec3> || std::is_same_v<T, clearance::position>) {
    return three(value);
  } else if constexpr (std::is_same_v<T, std::uint32_t>) {
    return value == clearance::none ? nb::none() : nb::object(nb::int_(value));
  } else if constexpr (std::is_array_v<T>) {
    nb::dict by_reason;
    std::apply(
        [&](const auto&... v) { ((int(v.value) == 0 ? void() : void(by_reason[v.name] = value[int(v.value)])), ...); },
        declared<clearance::drop_reason>::values);
    return by_reason;
  } else if constexpr (is_array<T>) {
    return array_of(value.data(), value.size(), owner);
  } else if constexpr (declared_struct<T>) {
    return nb::cast(answered<T>{value, about});
  } else {
    return nb::cast(value);
  }
}

/// Sets a member to what `to_python` made of it.
template <class T>
void from_python(T& to, nb::handle given) {
  if constexpr (std::is_same_v<T, clearance::vec3> || std::is_same_v<T, clearance::position>) {
    using number = std::remove_cvref_t<decltype(to.x)>;
    const auto at = [&](int k) { return number(nb::cast<double>(given[nb::int_(k)])); };
    to = {at(0), at(1), at(2)};
  } else if constexpr (std::is_same_v<T, std::uint32_t>) {
    to = given.is_none() ? clearance::none : nb::cast<std::uint32_t>(given);
  } else if constexpr (std::is_array_v<T>) {
    std::apply(
        [&](const auto&... v) {
          ((int(v.value) == 0 ? void() : void(to[int(v.value)] = nb::cast<std::uint64_t>(given[v.name]))), ...);
        },
        declared<clearance::drop_reason>::values);
  } else if constexpr (is_array<T>) {
    using element = typename T::value_type;
    const nb::object plain =
        nb::module_::import_("numpy").attr("ascontiguousarray")(given, dtype_of<element>()).attr("reshape")(-1);
    const auto bytes = nb::cast<nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig>>(plain.attr("view")("u1"));
    to.resize(bytes.size() / sizeof(element));
    if (bytes.size() != 0) std::memcpy(to.data(), bytes.data(), bytes.size());
  } else if constexpr (declared_struct<T>) {
    to = nb::cast<const answered<T>&>(given).value;
  } else if constexpr (std::is_floating_point_v<T>) {
    to = T(nb::cast<double>(given));
  } else {
    to = nb::cast<T>(given);
  }
}

/// The least one that fits, as in "MinDistanceResult(distance=0.1640, ...)".
std::string repr_of(nb::handle object, const char* name, std::span<const char* const> members);

template <class T, class F>
void for_each_member(F f) {
  std::apply([&](const auto&... m) { (f(m), ...); }, declared<T>::members);
}

/// The members by their names, as plain values: those of nested results too, states as their names, arrays as copies.
nb::dict dict_of(nb::handle object, std::span<const char* const> members);

/// A part by its number, or by the name of its link. Throws IndexError or ValueError.
std::size_t part_of(nb::handle given, const char* argument, const part_names& names);

/// What pickle keeps of whom a result is about; and back.
nb::tuple kept_of(const asked_about& about);
asked_about about_of(const nb::tuple& kept);

/// What Python gives for an argument of a method, whatever it is, so that the refusal is a sentence.
template <class T>
struct given_for {
  nb::handle it;
};
/// Throws IndexError for a number that is none of anything, TypeError for what is no number.
template <class T>
T argument_of(given_for<T> given, const char* name, const part_names& names = {}) {
  if constexpr (std::is_integral_v<T>)
    return std::string_view(name) == "part" ? part_of(given.it, name, names) : index_of(given.it, name);
  else
    return number_of(given.it, name);
}
template <class T>
struct nb::detail::type_caster<given_for<T>> {
  NB_TYPE_CASTER(given_for<T>, const_name<std::is_integral_v<T>>("int", "float"))
  bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept {
    value.it = given;
    return true;
  }
};

/// A method of a result, for Python.
template <class R, class Call, class... A>
struct method_of {
  Call call;
  std::array<const char*, sizeof...(A)> names;

  nb::object operator()(nb::handle_t<answered<R>> self, given_for<A>... given) const {
    const auto& its = nb::cast<const answered<R>&>(self);
    std::size_t k = 0;
    const std::tuple<A...> all{argument_of(given, names[k++], its.about.names)...};
    return to_python(std::apply([&](const A&... a) -> decltype(auto) { return call(its.value, a...); }, all), self,
                     its.about);
  }
};
template <class R, class Call, class... Names>
void bind_method(nb::class_<answered<R>>& bound, const method_as<Call, Names...>& method) {
  const auto bind = [&]<class... A>(auto (Call::*)(const R&, A...) const) {
    std::apply(
        [&](const auto... names) {
          bound.def(method.name, method_of<R, Call, A...>{method.call, {names...}}, nb::arg(names).none()...,
                    method.doc);
        },
        method.arguments);
  };
  bind(&Call::operator());
}

/// A class for a result, with its members as properties and its own questions as methods.
template <class R>
nb::class_<answered<R>> bind_result(nb::module_& m) {
  nb::class_<answered<R>> bound(m, declared<R>::name, declared<R>::doc);
  static std::vector<const char*> members;
  for_each_member<R>([&](const auto& member) {
    members.push_back(member.name);
    bound.def_prop_ro(
        member.name,
        [at = member.at, of_each = std::string_view(member.name) == "of"](nb::handle_t<answered<R>> self) {
          const auto& its = nb::cast<const answered<R>&>(self);
          nb::object value = to_python(its.value.*at, self, its.about);
          if (of_each && its.about.shape.size() > 1) value = value.attr("reshape")(nb::cast(its.about.shape));
          return value;
        },
        member.doc);
  });
  std::apply([&](const auto&... method) { (bind_method(bound, method), ...); }, declared<R>::methods);
  if constexpr (requires(const R& r) {
                  { r.part } -> std::convertible_to<std::uint32_t>;
                })
    bound.def_prop_ro(
        "link",
        [](const answered<R>& self) -> nb::object {
          const auto part = self.value.part;
          if (!self.about.names || part >= self.about.names->size()) return nb::none();
          return nb::cast((*self.about.names)[part]);
        },
        "The name of that part, or None.");
  if constexpr (requires(const R& r) { r.a + r.b; })
    bound.def_prop_ro(
        "links",
        [](const answered<R>& self) -> nb::object {
          const auto& names = self.about.names;
          if (!names || self.value.a >= names->size() || self.value.b >= names->size()) return nb::none();
          return nb::make_tuple((*names)[self.value.a], (*names)[self.value.b]);
        },
        nb::sig("def links(self) -> tuple[str, str] | None"), "The names of both parts, or None.");
  if constexpr (requires(const R& r) { typename decltype(r.parts)::value_type; }) {
    static const std::string signature =
        std::string("def of(self, part: int | str) -> ") + declared<typename decltype(R::parts)::value_type>::name;
    bound.def(
        "of",
        [](nb::handle_t<answered<R>> self, nb::handle part) {
          const auto& its = nb::cast<const answered<R>&>(self);
          const std::size_t k = part_of(part, "part", its.about.names);
          clearance::check_number("part", k, its.value.parts.size());
          return to_python(its.value.parts[k], self, its.about);
        },
        nb::arg("part").none(), nb::sig(signature.c_str()),
        "The answer about one part, by its number or its link's name. Raises IndexError or ValueError if there is "
        "none.");
  }
  if constexpr (requires(const R& r, const part_names& names) { sentence_of(r, names); })
    bound.def("__str__", [](const answered<R>& self) { return sentence_of(self.value, self.about.names); });
  bound.def("__repr__", [](nb::handle self) { return repr_of(self, declared<R>::name, members); });
  bound.def(
      "to_dict", [](nb::handle self) { return dict_of(self, members); },
      nb::sig("def to_dict(self) -> dict[str, typing.Any]"),
      "All members by their names: numbers, names of states, tuples, nested dictionaries, and copies of arrays.");
  bound.def("__copy__", [](nb::handle self) { return nb::borrow(self); });  // it never changes
  bound.def("__deepcopy__", [](nb::handle self, nb::handle) { return nb::borrow(self); }, nb::arg("memo"));
  bound.def("__getstate__", [](nb::handle self) {
    nb::list all;
    for (const char* name : members) all.append(self.attr(name));
    return nb::make_tuple(nb::tuple(all), kept_of(nb::cast<const answered<R>&>(self).about));
  });
  bound.def("__setstate__", [](answered<R>& self, const nb::tuple& state) {
    const nb::tuple values(state[0]);
    if (values.size() != members.size())
      throw std::invalid_argument(std::string("clearance: another version pickled this ") + declared<R>::name);
    new (&self) answered<R>{{}, about_of(nb::tuple(state[1]))};
    std::size_t k = 0;
    for_each_member<R>([&](const auto& member) { from_python(self.value.*(member.at), values[k++]); });
  });
  return bound;
}
