// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How declarations.py writes down what it read.

#include <tuple>

/// Specialised for each question, result and enumeration: name, doc, and members and methods, or values; and `out`, if
/// the question can be enqueued.
template <class T>
struct declared;

template <class T>
concept declared_struct = requires { declared<T>::members; };
template <class T>
concept declared_enum = requires { declared<T>::values; };

template <class Owner, class T>
struct member_as {
  const char* name;
  T Owner::* at;
  const char* doc;
};
template <class Owner, class T>
member_as(const char*, T Owner::*, const char*) -> member_as<Owner, T>;

/// An array where a device writes: `at(out)` is the pointer to it.
template <class At>
struct out_as {
  const char* name;
  At at;
};
template <class At>
out_as(const char*, At) -> out_as<At>;

template <class Call, class... Names>
struct method_as {
  const char* name;
  Call call;
  const char* doc;
  std::tuple<Names...> arguments;

  constexpr method_as(const char* its_name, Call its_call, const char* its_doc, Names... names)
      : name(its_name), call(its_call), doc(its_doc), arguments(names...) {}
};

template <class E>
struct value_as {
  const char* name;
  E value;
};
