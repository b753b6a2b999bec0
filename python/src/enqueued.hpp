// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where the answer to an enqueued question goes: arrays that a caller gives, or new ones.

#include "device_array.hpp"
#include "device_entry.hpp"
#include "values.hpp"

#include <nanobind/stl/optional.h>

/// A NumPy dtype, of a plain number too.
template <class T>
nb::object numpy_dtype() {
  return nb::module_::import_("numpy").attr("dtype")(dtype_of<T>());
}

/// An answer on a device, which may be on its way: arrays by name, and what the device reads until then.
struct enqueued_answer {
  nb::dict arrays;
  std::optional<clearance::distance_certainty> certain;
  int device = 0;
  void* stream = nullptr;
  std::shared_ptr<void> writer;
  nb::object kept;
  std::vector<std::shared_ptr<device_memory>> rewritten;  ///< Memory that others wrote before.
};

/// What a question is told to say how much room it needs: stands for pairwise::asked. A room is a number, not memory.
struct room_sizes {
  std::size_t points, of_robot, configurations;
  mutable std::vector<std::size_t> taken;

  std::size_t parts() const { return of_robot; }
  template <class T>
  T* space(std::size_t n) const {
    taken.push_back(n);
    return reinterpret_cast<T*>(taken.size() * alignof(std::max_align_t));
  }
  std::size_t of(const void* room) const {
    return taken[reinterpret_cast<std::uintptr_t>(room) / alignof(std::max_align_t) - 1];
  }
};

inline constexpr std::size_t usual_capacity = 1 << 16;  ///< As within has it.

/// How much a question writes. `capacity`: of pairs, if it lists those.
template <class Q>
typename out_of<Q>::type rooms_of(const Q& question, const room_sizes& a, std::size_t capacity) {
  using out = typename out_of<Q>::type;
  if constexpr (requires { typename Q::searched; }) {
    return a.template space<std::remove_pointer_t<out>>(results_of<Q>(a.configurations, a.parts()));
  } else if constexpr (requires(out to) { to.capacity; }) {
    return {a.template space<clearance::pair_distance>(capacity), capacity, a.template space<unsigned long long>(1),
            a.template space<clearance::point_counts>(1)};
  } else if constexpr (requires { question.space(a); }) {
    return question.space(a);
  } else if constexpr (requires(out to) { to.distances; }) {
    out to{{a.template space<clearance::real>(a.points)}, a.template space<clearance::point_counts>(1)};
    if (question.which)
      to.distances.part = a.template space<std::uint32_t>(a.points),
      to.distances.primitive = a.template space<std::uint32_t>(a.points);
    return to;
  } else if constexpr (requires(out to) { to.witnesses; }) {
    return {a.template space<clearance::part_minimum>(a.parts()), a.template space<clearance::part_witness>(a.parts())};
  } else if constexpr (requires(out to) { to.minima; }) {
    return {a.template space<clearance::min_distance_result>(1), a.template space<clearance::part_minimum>(a.parts())};
  } else {
    return a.template space<std::remove_pointer_t<out>>(1);
  }
}

/// Fills `to` with arrays of `given` (a mapping, or None) or with new ones. Throws std::invalid_argument, which names
/// the array.
template <class Q>
typename out_of<Q>::type arrays_for(const Q& question, const room_sizes& sizes, std::optional<std::size_t> capacity,
                                    nb::handle given, const asker<Q>& its, enqueued_answer& answer) {
  using out = typename out_of<Q>::type;
  constexpr bool lists = requires(out to) { to.capacity; };
  if (capacity && !lists)
    throw std::invalid_argument(std::string("clearance: capacity is of pairs, and ") + declared<Q>::name +
                                " lists none");
  nb::dict there;
  if (!given.is_none()) {
    if (!nb::hasattr(given, "keys"))
      throw std::invalid_argument("clearance: out is a mapping of names to arrays, or an answer of enqueue, not " +
                                  shape_and_type(given));
    there.attr("update")(given);
  }
  out to = rooms_of(question, sizes, capacity.value_or(usual_capacity));
  std::string names;
  std::size_t used = 0;
  const auto place = [&](const auto& array) {
    auto& pointer = array.at(to);
    if (pointer == nullptr) return;
    using value = std::remove_const_t<std::remove_pointer_t<std::remove_reference_t<decltype(pointer)>>>;
    constexpr bool reads = std::is_const_v<std::remove_pointer_t<std::remove_reference_t<decltype(pointer)>>>;
    constexpr bool is_list = lists && std::is_same_v<value, clearance::pair_distance>;
    names += (names.empty() ? "" : ", ") + std::string(array.name);
    std::size_t count = sizes.of(pointer);
    if (there.contains(array.name)) {
      ++used;
      const nb::object one = there[array.name];
      const bool any = is_list && !capacity;
      pointer = reinterpret_cast<value*>(writable_there(one, "out[\"" + std::string(array.name) + "\"]",
                                                        numpy_dtype<value>(), count, any, answer.device));
      if constexpr (is_list) to.capacity = count;
      if (device_array* its = nullptr; nb::try_cast(one, its) && its && !reads) answer.rewritten.push_back(its->memory);
      answer.arrays[array.name] = one;
      return;
    }
    device_array made = make_device_array(numpy_dtype<value>(), count, answer.device, answer.stream, answer.writer);
    if constexpr (reads) {  // what stands in the question
      if (question.minima.size() != count)
        throw std::invalid_argument(std::string("clearance: ") + array.name + " of " + declared<Q>::name + " has " +
                                    std::to_string(question.minima.size()) + " values, and there are " +
                                    std::to_string(count) + " parts; out[\"" + array.name +
                                    "\"] may have those on the device");
      open_device_door().bring(made.data, question.minima.data(), count * sizeof(value), answer.device, its.stream());
    }
    pointer = reinterpret_cast<value*>(made.data);
    answer.arrays[array.name] = nb::cast(std::move(made));
  };
  std::apply([&](const auto&... array) { (place(array), ...); }, declared<Q>::out);
  if (used != there.size())
    for (const auto& [name, array] : there)
      if (!answer.arrays.contains(name))
        throw std::invalid_argument("clearance: out[" + nb::cast<std::string>(nb::repr(name)) + "] is not written by " +
                                    declared<Q>::name + "; it writes: " + names);
  return to;
}

inline void bind_enqueued(nb::module_& m) {
  nb::class_<enqueued_answer>(
      m, "DeviceAnswer",
      "What Query.enqueue returns: the arrays that a device writes, by the names that C++ has. It may still be on its "
      "way; work in the stream that was given waits for it, and so does .numpy() of an array.")
      .def(
          "__getitem__",
          [](const enqueued_answer& a, const std::string& name) -> nb::object {
            if (!a.arrays.contains(name.c_str())) throw nb::key_error(name.c_str());
            return a.arrays[name.c_str()];
          },
          nb::arg("name"), nb::sig("def __getitem__(self, name: str) -> typing.Any"))
      .def(
          "keys", [](const enqueued_answer& a) { return nb::list(a.arrays.attr("keys")()); },
          nb::sig("def keys(self) -> list[str]"), "The names of the arrays.")
      .def(
          "__iter__", [](const enqueued_answer& a) { return nb::iter(a.arrays); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[str]"))
      .def("__len__", [](const enqueued_answer& a) { return a.arrays.size(); })
      .def_prop_ro(
          "certain", [](const enqueued_answer& a) { return a.certain; },
          "How certain each distance is, where a question says it; or None.")
      .def(
          "wait", [](const enqueued_answer& a) { open_device_door().wait(a.device, a.stream); },
          nb::call_guard<nb::gil_scoped_release>(), "Waits until it is written.")
      .def("__repr__", [](const enqueued_answer& a) {
        std::string text = "<DeviceAnswer on " + device_name(a.device) + ":";
        for (const auto& [name, array] : a.arrays) text += " " + nb::cast<std::string>(name);
        return text + ">";
      });
}
