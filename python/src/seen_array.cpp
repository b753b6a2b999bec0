// SPDX-License-Identifier: BSD-3-Clause
#include "seen_array.hpp"

#include "arrays.hpp"

#include <nanobind/stl/string.h>

#include <optional>

namespace {

std::optional<seen_array> from_dlpack(nb::handle given) {
  nb::ndarray<nb::ro> array;
  if (!nb::try_cast(given, array)) return {};
  seen_array seen;
  seen.data = static_cast<const std::byte*>(array.data());
  seen.item = std::size_t(array.dtype().bits) / 8;
  for (std::size_t k = 0; k < array.ndim(); ++k) {
    seen.shape.push_back(array.shape(k));
    seen.strides.push_back(array.stride(k) * std::int64_t(seen.item));
  }
  const auto code = nb::dlpack::dtype_code(array.dtype().code);
  seen.kind = code == nb::dlpack::dtype_code::Float  ? 'f'
              : code == nb::dlpack::dtype_code::UInt ? 'u'
              : code == nb::dlpack::dtype_code::Int  ? 'i'
              : code == nb::dlpack::dtype_code::Bool ? 'b'
                                                     : '?';
  if (array.device_type() == nb::device::cuda::value)
    seen.device = array.device_id();
  else if (array.device_type() != nb::device::cpu::value && array.device_type() != 3)  // 3: pinned
    return {};
  seen.kept = nb::cast(array);
  return seen;
}

}  // namespace

seen_array from_interface(nb::handle given, const nb::dict& interface, int device, const char* argument) {
  seen_array seen;
  const auto typestr = nb::cast<std::string>(interface["typestr"]);
  if (typestr.size() < 3) return seen;  // objects: refused as what they are
  if (typestr[0] == '>')
    throw std::invalid_argument(std::string("clearance: ") + argument +
                                " has the byte order of another machine; byteswap it first: " + shape_and_type(given));
  seen.kind = typestr[1], seen.item = std::size_t(std::stoul(typestr.substr(2))), seen.device = device;
  const nb::object data = interface["data"];
  seen.data = reinterpret_cast<const std::byte*>(nb::cast<std::uintptr_t>(data[nb::int_(0)]));
  for (const nb::handle n : nb::object(interface["shape"])) seen.shape.push_back(nb::cast<std::size_t>(n));
  if (interface.contains("strides") && !interface["strides"].is_none()) {
    for (const nb::handle s : nb::object(interface["strides"])) seen.strides.push_back(nb::cast<std::int64_t>(s));
  } else {
    std::int64_t step = std::int64_t(seen.item);
    seen.strides.resize(seen.shape.size());
    for (std::size_t k = seen.shape.size(); k-- > 0; step *= std::int64_t(seen.shape[k])) seen.strides[k] = step;
  }
  seen.kept = nb::borrow(given);
  return seen;
}

seen_array array_seen(nb::handle given, const char* argument, const char* wanted) {
  if (auto seen = from_dlpack(given)) return *seen;
  if (nb::hasattr(given, "__cuda_array_interface__")) {
    const nb::dict interface = given.attr("__cuda_array_interface__");
    int device = 0;
    if (nb::hasattr(given, "device") && nb::hasattr(given.attr("device"), "id"))
      device = nb::cast<int>(given.attr("device").attr("id"));
    return from_interface(given, interface, device, argument);
  }
  if (nb::hasattr(given, "__array_interface__"))  // such as a field of packed records, which DLPack cannot describe
    return from_interface(given, given.attr("__array_interface__"), on_the_host, argument);
  if (nb::isinstance<nb::list>(given) || nb::isinstance<nb::tuple>(given)) {
    try {
      if (auto seen = from_dlpack(nb::module_::import_("numpy").attr("asarray")(given, "f8"))) return *seen;
    } catch (nb::python_error&) {
    }
  }
  throw std::invalid_argument(std::string("clearance: ") + argument + " is " + wanted + ", not " +
                              shape_and_type(given));
}
