// SPDX-License-Identifier: BSD-3-Clause
#include "device_array.hpp"

#include "arrays.hpp"
#include "device_entry.hpp"

#include <nanobind/stl/string.h>

namespace {

nb::tuple tuple_of(const auto& numbers) {
  nb::list all;
  for (const auto n : numbers) all.append(n);
  return nb::tuple(all);
}

std::size_t item_of(const device_array& a) { return nb::cast<std::size_t>(a.dtype.attr("itemsize")); }

bool is_structured(nb::handle dtype) { return !nb::object(dtype.attr("names")).is_none(); }

std::vector<std::int64_t> strides_of(const std::vector<std::size_t>& shape, std::size_t item) {
  std::vector<std::int64_t> strides(shape.size());
  auto step = std::int64_t(item);
  for (std::size_t k = shape.size(); k-- > 0; step *= std::int64_t(shape[k])) strides[k] = step;
  return strides;
}

/// From the first byte to the last one.
std::size_t extent(const device_array& a) {
  std::size_t bytes = item_of(a);
  for (std::size_t k = 0; k < a.shape.size(); ++k) {
    if (a.shape[k] == 0) return 0;
    bytes += (a.shape[k] - 1) * std::size_t(a.strides[k]);
  }
  return bytes;
}

void copied_there(device_array* self, nb::handle given, const std::string& device) {
  const int there = device_number(device);
  if (there == on_the_host)
    throw std::invalid_argument("clearance: a DeviceArray lies on a CUDA device, not on the cpu");
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object array = numpy.attr("asarray")(given), plain = numpy.attr("ascontiguousarray")(array);
  const nb::object dtype = plain.attr("dtype");
  if (nb::cast<bool>(dtype.attr("hasobject")) || !nb::cast<bool>(dtype.attr("isnative")) ||
      text_of(dtype.attr("kind")).find_first_of("biufV") != 0)
    throw std::invalid_argument("clearance: array is one of numbers or records of this machine, not " +
                                shape_and_type(array));
  std::vector<std::size_t> shape;
  for (const nb::handle n : nb::object(array.attr("shape"))) shape.push_back(nb::cast<std::size_t>(n));
  const nb::object bytes = plain.attr("reshape")(-1).attr("view")("u1");
  const auto from = nb::cast<nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig>>(bytes);
  const device_door& door = open_device_door();
  const nb::gil_scoped_release others;
  auto memory = door.allocate(from.size(), there);
  door.bring(memory.get(), from.data(), from.size(), there, nullptr);
  door.wait(there, nullptr);
  const nb::gil_scoped_acquire python;
  const auto strides = strides_of(shape, nb::cast<std::size_t>(dtype.attr("itemsize")));
  auto* const data = static_cast<std::byte*>(memory.get());
  auto kept = std::make_shared<device_memory>(device_memory{std::move(memory), nullptr, nullptr});
  new (self) device_array{data, std::move(shape), strides, dtype, there, std::move(kept)};
}

nb::object on_host(const device_array& a) {
  std::vector<std::uint8_t> bytes(extent(a));
  if (!bytes.empty()) {
    const device_memory its = *a.memory;  // as it is now
    const nb::gil_scoped_release others;
    open_device_door().fetch(bytes.data(), a.data, bytes.size(), a.device, its.stream);
  }
  const std::size_t size = bytes.size();
  const nb::module_ numpy = nb::module_::import_("numpy");
  if (size == 0) return numpy.attr("empty")(tuple_of(a.shape), a.dtype);
  return numpy.attr("ndarray")(tuple_of(a.shape), a.dtype, own_array(std::move(bytes), {size}), 0, tuple_of(a.strides));
}

nb::object field_of(const device_array& a, const std::string& name) {
  if (!is_structured(a.dtype))
    throw nb::type_error(("this array has no fields, only values of " + text_of(a.dtype)).c_str());
  const nb::object fields = a.dtype.attr("fields");
  if (!nb::cast<bool>(fields.attr("__contains__")(name))) throw nb::key_error(name.c_str());
  const nb::object field = fields[name.c_str()];
  device_array made = a;
  made.dtype = field[nb::int_(0)], made.data += nb::cast<std::size_t>(field[nb::int_(1)]);
  if (const nb::object sub = made.dtype.attr("subdtype"); !sub.is_none()) {  // such as three numbers
    made.dtype = sub[nb::int_(0)];
    std::vector<std::size_t> inner;
    for (const nb::handle n : nb::object(sub[nb::int_(1)])) inner.push_back(nb::cast<std::size_t>(n));
    made.shape.insert(made.shape.end(), inner.begin(), inner.end());
    for (const std::int64_t step : strides_of(inner, item_of(made))) made.strides.push_back(step);
  }
  return nb::cast(std::move(made));
}

nb::dict cuda_interface(const device_array& a) {
  nb::dict made;
  made["version"] = 3;
  made["shape"] = tuple_of(a.shape), made["strides"] = tuple_of(a.strides);
  made["typestr"] = a.dtype.attr("str"), made["descr"] = a.dtype.attr("descr");
  made["data"] = nb::make_tuple(reinterpret_cast<std::uintptr_t>(a.data), false);
  const auto stream = reinterpret_cast<std::uintptr_t>(a.memory->stream);
  made["stream"] = stream == 0 ? 1 : stream;  // the legacy default stream
  return made;
}

/// The protocol's: what comes in the consumer's stream waits for what is written.
nb::object dlpack_of(nb::handle_t<device_array> self, nb::handle stream, const nb::kwargs& others) {
  const auto& a = nb::cast<const device_array&>(self);
  const std::string kind = text_of(a.dtype.attr("kind"));
  const auto code = kind == "f"   ? nb::dlpack::dtype_code::Float
                    : kind == "i" ? nb::dlpack::dtype_code::Int
                    : kind == "b" ? nb::dlpack::dtype_code::Bool
                                  : nb::dlpack::dtype_code::UInt;
  if (kind == "V") throw nb::buffer_error("clearance: DLPack has no records; give a field, array[\"distance\"]");
  std::intptr_t then = 0;
  if (!stream.is_none() && !nb::try_cast(stream, then))
    throw nb::type_error(("stream is an integer or None, not " + nb::cast<std::string>(nb::repr(stream))).c_str());
  const auto item = std::int64_t(item_of(a));
  std::vector<std::int64_t> steps;
  for (const std::int64_t s : a.strides) {
    if (s % item != 0)
      throw nb::buffer_error(("clearance: DLPack has no steps of " + std::to_string(s) + " bytes between values of " +
                              std::to_string(item) + "; __cuda_array_interface__ has")
                                 .c_str());
    steps.push_back(s / item);
  }
  if (then != -1) open_device_door().order(a.memory->stream, reinterpret_cast<void*>(then), a.device);
  const nb::ndarray<nb::array_api> made(a.data, a.shape.size(), a.shape.data(), self, steps.data(),
                                        nb::dlpack::dtype{std::uint8_t(code), std::uint8_t(8 * item), 1},
                                        nb::device::cuda::value, a.device);
  return nb::cast(made).attr("__dlpack__")(**others);
}

}  // namespace

int device_number(const std::string& device) {
  if (device == "cpu") return on_the_host;
  if (device == "cuda") return 0;
  if (device.starts_with("cuda:") && device.size() > 5 && device.size() < 10 &&
      device.find_first_not_of("0123456789", 5) == device.npos)
    return std::stoi(device.substr(5));
  throw std::invalid_argument("clearance: device is \"" + device + "\"; it is \"cpu\" or \"cuda:0\" and so on");
}

std::string device_name(int device) {
  return device == on_the_host ? std::string("cpu") : "cuda:" + std::to_string(device);
}

device_array make_device_array(nb::object dtype, std::size_t count, int device, void* stream,
                               std::shared_ptr<void> writer) {
  const auto item = nb::cast<std::size_t>(dtype.attr("itemsize"));
  if (count > (std::size_t(1) << 48) / item)
    throw std::invalid_argument("clearance: no device has room for " + std::to_string(count) + " values of " +
                                std::to_string(item) + " bytes");
  auto bytes = open_device_door().allocate(count * item, device);
  auto* const data = static_cast<std::byte*>(bytes.get());
  auto memory = std::make_shared<device_memory>(device_memory{std::move(bytes), std::move(writer), stream});
  return {data, {count}, {std::int64_t(item)}, std::move(dtype), device, std::move(memory)};
}

std::byte* writable_there(nb::handle given, const std::string& argument, nb::handle dtype, std::size_t& count,
                          bool any_count, int device) {
  const std::string wanted = "an array of " + (any_count ? std::string("any number of") : std::to_string(count)) +
                             " values of dtype " + text_of(dtype) + " on " + device_name(device) + ", without gaps";
  const auto refuse = [&](const std::string& but) {
    throw std::invalid_argument("clearance: " + argument + " is " + wanted + ", not " + but);
  };
  const auto item = nb::cast<std::size_t>(dtype.attr("itemsize"));
  const device_array* known = nullptr;
  seen_array seen;
  if (nb::try_cast(given, known) && known) {
    seen = {known->data,     known->shape, known->strides, text_of(known->dtype.attr("kind"))[0],
            item_of(*known), known->device};
    if (!known->dtype.equal(dtype)) refuse(shape_and_type(given));
  } else {
    seen = array_seen(given, argument.c_str(), wanted.c_str());
    if (nb::hasattr(given, "__cuda_array_interface__") &&
        nb::cast<bool>(given.attr("__cuda_array_interface__")["data"][nb::int_(1)]))
      refuse("one that is read-only");
  }
  const bool records = seen.kind == 'V' || (is_structured(dtype) && seen.kind == 'u' && seen.item == 1);
  std::size_t values = 1;
  for (const std::size_t n : seen.shape) values *= n;
  if (is_structured(dtype) ? !records : seen.kind != text_of(dtype.attr("kind"))[0] || seen.item != item)
    refuse(shape_and_type(given));
  if (seen.strides != strides_of(seen.shape, seen.item) && values > 1) refuse("one with gaps");
  if (values * seen.item % item != 0) refuse(shape_and_type(given));
  values = values * seen.item / item;
  if (!any_count && values != count) refuse(shape_and_type(given));
  count = values;
  if (seen.device == on_the_host) refuse("one on the cpu");
  if (seen.device != device) refuse("one on " + device_name(seen.device));
  auto* const memory = const_cast<std::byte*>(seen.data);
  if (values != 0 && open_device_door().holder(memory) != device) refuse("memory that is not its own");
  return memory;
}

void bind_device_array(nb::module_& m) {
  nb::class_<device_array>(
      m, "DeviceArray",
      "An array in a CUDA device's memory, which it owns: for torch, CuPy, JAX and Numba by DLPack and "
      "__cuda_array_interface__. array[\"distance\"] views a field of records. Its memory is given back with the last "
      "view, which waits for the device.")
      .def("__init__", &copied_there, nb::arg("array").none(), nb::arg("device") = "cuda:0",
           "Copies an array of numbers or records from the host.",
           nb::sig("def __init__(self, array: numpy.typing.ArrayLike, device: str = 'cuda:0') -> None"))
      .def_prop_ro(
          "shape", [](const device_array& a) { return tuple_of(a.shape); },
          nb::sig("def shape(self) -> tuple[int, ...]"), "As NumPy's.")
      .def_prop_ro(
          "dtype", [](const device_array& a) { return a.dtype; }, nb::sig("def dtype(self) -> typing.Any"),
          "As NumPy's.")
      .def_prop_ro(
          "device", [](const device_array& a) { return device_name(a.device); }, "Where it lies: \"cuda:0\" and so on.")
      .def("numpy", &on_host, "A copy on the host, after what is enqueued has been written.",
           nb::sig("def numpy(self) -> numpy.typing.NDArray[typing.Any]"))
      .def("__getitem__", &field_of, nb::arg("field"), nb::sig("def __getitem__(self, field: str) -> DeviceArray"))
      .def(
          "__array__",
          [](const device_array&, const nb::args&, const nb::kwargs&) -> nb::object {
            throw nb::type_error("clearance: this array lies on a device; array.numpy() copies it");
          },
          nb::sig("def __array__(self, *given: typing.Any, **named: typing.Any) -> typing.NoReturn"))
      .def_prop_ro("__cuda_array_interface__", &cuda_interface,
                   nb::sig("def __cuda_array_interface__(self) -> dict[str, typing.Any]"))
      .def("__dlpack__", &dlpack_of, nb::arg("stream").none() = nb::none(), nb::arg("others"),
           nb::sig("def __dlpack__(self, stream: int | None = None, **others: typing.Any) -> typing.Any"))
      .def(
          "__dlpack_device__", [](const device_array& a) { return nb::make_tuple(nb::device::cuda::value, a.device); },
          nb::sig("def __dlpack_device__(self) -> tuple[int, int]"))
      .def("__repr__", [](const device_array& a) {
        return "<DeviceArray " + text_of(tuple_of(a.shape)) + " of " + text_of(a.dtype) + " on " +
               device_name(a.device) + ">";
      });
}
