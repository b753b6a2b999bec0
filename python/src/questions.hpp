// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions in Python: values with the library's options, by the library's names.

#include "values.hpp"

#include <nanobind/stl/vector.h>

/// A question, and what its views look at.
template <class Q>
struct asked {
  Q question;
  nb::object kept;
};

[[noreturn]] void refuse_option(const char* question, const char* option, const char* wanted, nb::handle given);

template <class T>
const char* wanted_as() {
  if constexpr (std::is_same_v<T, bool>) return "True or False";
  if constexpr (std::is_floating_point_v<T>) return "a number";
  if constexpr (std::is_integral_v<T>) return "a whole number, 0 or more";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "a number or a sequence of numbers";
  if constexpr (declared_struct<T>) {
    static const std::string text = std::string("a ") + declared<T>::name;
    return text.c_str();
  }
  if constexpr (is_array<T>) {
    if constexpr (declared_struct<typename T::value_type>) return "a structured array, or a sequence of tuples";
  }
  return "an array of them";
}
template <class T>
const char* type_name() {
  if constexpr (std::is_same_v<T, bool>) return "bool";
  if constexpr (std::is_floating_point_v<T>) return "float";
  if constexpr (std::is_integral_v<T>) return "int";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "float | collections.abc.Sequence[float]";
  if constexpr (declared_struct<T>) return declared<T>::name;
  return "numpy.typing.NDArray";
}

/// Sets an option from what Python gives. Throws TypeError.
template <class Q, class T>
void set_option(asked<Q>& to, T& option, const char* name, nb::handle given) {
  try {
    if constexpr (std::is_same_v<T, std::vector<double>>) {
      if (!PySequence_Check(given.ptr()))
        option = {nb::cast<double>(nb::float_(given))};
      else if (nb::isinstance<nb::str>(given))
        throw nb::cast_error();
      else
        option.clear();
      if (PySequence_Check(given.ptr()))
        for (const nb::handle one : given) option.push_back(nb::cast<double>(nb::float_(one)));
    } else if constexpr (is_array<T>) {
      using element = std::remove_const_t<typename T::value_type>;
      const nb::module_ numpy = nb::module_::import_("numpy");
      if constexpr (declared_struct<element>)  // of a plain number NumPy would fill all members
        if (nb::cast<std::string>(numpy.attr("asarray")(given).attr("dtype").attr("kind")) != "V" && nb::len(given) &&
            !PyTuple_Check(nb::object(given[0]).ptr()))
          throw nb::cast_error();
      const nb::object plain = numpy.attr("ascontiguousarray")(given, dtype_of<element>()).attr("view")("u1");
      const auto bytes = nb::cast<nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig>>(plain);
      const std::span all(reinterpret_cast<const element*>(bytes.data()), bytes.size() / sizeof(element));
      if constexpr (std::is_constructible_v<T, std::span<const element>>)
        option = all, to.kept = plain;
      else
        option.assign(all.begin(), all.end());
    } else if constexpr (declared_struct<T>) {
      option = nb::cast<const asked<T>&>(given).question;
    } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      option = nb::cast<T>(given.attr("__index__")());
    } else {
      option = nb::cast<T>(given);
    }
  } catch (const nb::cast_error&) {
    refuse_option(declared<Q>::name, name, wanted_as<T>(), given);
  } catch (const nb::python_error&) {
    refuse_option(declared<Q>::name, name, wanted_as<T>(), given);
  }
}

/// "def __init__(self, d_max: float = inf, which: bool = False) -> None", as a user reads it.
template <class Q>
std::string signature_of() {
  const nb::object standing = nb::cast(asked<Q>{});
  std::string text = "def __init__(self";
  for_each_member<Q>([&]<class Owner, class T>(const member_as<Owner, T>& m) {
    text += std::string(", ") + m.name + ": ";
    if constexpr (is_array<T> && !std::is_same_v<T, std::vector<double>>) {
      constexpr bool owned = !std::is_trivially_copyable_v<T>;  // and may be left out
      const bool after_defaults = owned || text.find(" = ") != text.npos;
      text += after_defaults ? "numpy.typing.ArrayLike = ()" : type_name<T>();
    } else {
      text += type_name<T>();
    }
    if constexpr (std::is_arithmetic_v<T> || declared_struct<T>) {
      std::string shown = nb::cast<std::string>(nb::repr(standing.attr(m.name)));
      text += " = " + (shown == "inf" ? std::string("float('inf')") : shown);
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
      if (!(Q{}.*m.at).empty() || text.find(" = ") != text.npos)
        text += " = " + nb::cast<std::string>(nb::repr(standing.attr(m.name)));
    }
  });
  return text + ") -> None";
}

template <class Q>
nb::object option_of(const asked<Q>& self, nb::handle owner, const auto& at) {
  using type = std::remove_cvref_t<decltype(self.question.*at)>;
  if constexpr (std::is_same_v<type, std::vector<double>>)
    return nb::tuple(nb::cast(self.question.*at));
  else if constexpr (declared_struct<type>)
    return nb::cast(asked<type>{self.question.*at, {}});
  else
    return to_python(self.question.*at, owner, {});
}

template <class Q>
nb::class_<asked<Q>> bind_question(nb::module_& m) {
  nb::class_<asked<Q>> bound(m, declared<Q>::name, declared<Q>::doc);
  static std::vector<const char*> members;
  std::string docs;
  for_each_member<Q>([&](const auto& member) {
    members.push_back(member.name);
    docs += (docs.empty() ? "" : "\n") + std::string(member.name) + ": " + member.doc;
    bound.def_prop_ro(
        member.name,
        [at = member.at](nb::handle_t<asked<Q>> self) { return option_of(nb::cast<const asked<Q>&>(self), self, at); },
        member.doc);
  });
  static const std::string signature = signature_of<Q>(), about = docs;
  bound.def(
      "__init__",
      [](asked<Q>* self, const nb::args& given, const nb::kwargs& named) {
        new (self) asked<Q>{};
        try {
          if (given.size() > members.size())
            throw nb::type_error((std::string(declared<Q>::name) + " takes " + std::to_string(members.size()) +
                                  " options, and " + std::to_string(given.size()) + " are given")
                                     .c_str());
          std::size_t i = 0, used = 0;
          for_each_member<Q>([&](const auto& member) {
            const bool by_name = named.contains(member.name);
            if (i < given.size() && by_name)
              throw nb::type_error((std::string(declared<Q>::name) + ": " + member.name + " is given twice").c_str());
            if (i < given.size()) set_option(*self, self->question.*(member.at), member.name, given[i]);
            if (by_name) set_option(*self, self->question.*(member.at), member.name, named[member.name]), ++used;
            ++i;
          });
          if (used != named.size()) {
            std::string known;
            for (const char* name : members) known += (known.empty() ? "" : ", ") + std::string(name);
            for (const auto& [key, value] : named)
              if (known.empty() || std::ranges::find(members, nb::cast<std::string>(key)) == members.end())
                throw nb::type_error((std::string(declared<Q>::name) + " has no option " + nb::cast<std::string>(key) +
                                      (known.empty() ? "" : "; it has: " + known))
                                         .c_str());
          }
        } catch (...) {
          self->~asked<Q>();
          throw;
        }
      },
      nb::sig(signature.c_str()), about.c_str());
  bound.def("__repr__", [](nb::handle self) {
    std::string text = std::string(declared<Q>::name) + '(';
    for (const char* name : members)
      text +=
          (text.back() == '(' ? "" : ", ") + std::string(name) + '=' + nb::cast<std::string>(nb::repr(self.attr(name)));
    return text + ')';
  });
  const auto values = [](nb::handle self) {
    nb::list all;
    for (const char* name : members) all.append(self.attr(name));
    return nb::tuple(all);
  };
  bound.def("__reduce__", [values](nb::handle self) { return nb::make_tuple(self.type(), values(self)); });
  const auto compared = [](nb::handle self) {
    nb::list all;
    for (const char* name : members) {
      const nb::object value = self.attr(name);
      all.append(nb::hasattr(value, "tobytes") ? value.attr("tobytes")() : value);
    }
    return nb::tuple(all);
  };
  bound.def("__eq__", [compared](nb::handle self, nb::handle other) {
    return self.type().is(other.type()) && compared(self).equal(compared(other));
  });
  bound.def("__hash__", [compared](nb::handle self) { return nb::hash(compared(self)); });
  return bound;
}
