// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/ist.hpp>

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/sealed_file.hpp>
#include <clearance/io/write_file.hpp>

#include <set>
#include <span>

namespace clearance::io {

namespace {

constexpr sealed_form ist_form{ist_magic, ist_version, "an .ist file", ".ist files"};

void put_part(byte_writer& out, const packed_part& part) {
  out.put(std::uint32_t(part.name.size()));
  out.put(std::string_view(part.name));
  for (const auto& known : {part.solid, part.recipe})
    for (const std::uint8_t byte : known.bytes) out.put(byte);
  out.put(part.tolerance + part.spheres.tolerance);
  detail::for_each_member(part.spheres, [&]<class T>(const T& member) {
    if constexpr (std::same_as<T, double>) {
      out.put(member);
    } else if constexpr (std::same_as<T, pack_stop>) {
      out.put(std::uint32_t(member));
    } else {
      out.put(std::uint64_t(member.size()));
      for (const inner_sphere& s : member)
        for (const float number : {s.center.x, s.center.y, s.center.z, s.radius}) out.put(number);
    }
  });
}

packed_part take_part(byte_reader& in, const std::string& file) {
  packed_part part;
  part.name = in.take(in.take<std::uint32_t>());
  const std::string of = " of part " + io::quoted(part.name);
  for (auto* known : {&part.solid, &part.recipe}) std::ranges::copy(in.take(known->bytes.size()), known->bytes.begin());

  const auto length = [&] {
    const double value = in.take<double>();
    if (!(value >= 0)) refuse(file, "a length" + of + " is " + std::to_string(value));
    return value;
  };
  part.tolerance = length();

  detail::for_each_member(part.spheres, [&]<class T>(T& member) {
    if constexpr (std::same_as<T, double>) {
      member = length();
    } else if constexpr (std::same_as<T, pack_stop>) {
      const auto value = in.take<std::uint32_t>();
      if (value > std::uint32_t(pack_stop::search_limit))
        refuse(file, "the reason" + of + " is number " + std::to_string(value));
      member = pack_stop(value);
    } else {
      const auto count = in.take<std::uint64_t>();
      if (count == 0) refuse(file, "there is no sphere" + of);
      if (count > in.left() / 16) refuse(file, "has no room for the " + std::to_string(count) + " spheres" + of);
      for (std::uint64_t i = 0; i < count; ++i) {
        float n[4];
        for (float& number : n) number = in.take<float>();
        member.push_back(checked_sphere({n[0], n[1], n[2]}, n[3], file, "sphere " + std::to_string(i) + of));
      }
    }
  });

  const packing plain = uncertified(part.spheres.spheres);
  if (part.spheres.radius_min != plain.radius_min || part.spheres.radius_max != plain.radius_max)
    refuse(file, "the radii" + of + " are not what its figures say");
  return part;
}

}  // namespace

std::string ist_bytes(std::span<const packed_part> parts) {
  byte_writer body;
  for (const packed_part& part : parts) put_part(body, part);
  return sealed(ist_form, std::uint32_t(parts.size()), body.bytes());
}

std::vector<packed_part> read_ist(std::string_view bytes, const std::string& file) {
  unsealed records(bytes, file, ist_form);
  std::vector<packed_part> parts;
  std::set<std::string> names;
  for (std::uint32_t i = 0; i < records.count; ++i) {
    parts.push_back(take_part(records.in, file));
    if (!names.insert(parts[i].name).second) refuse(file, "has two parts " + io::quoted(parts[i].name));
  }
  records.finish(file);
  return parts;
}

std::vector<packed_part> load_ist(const std::string& file) { return read_ist(read_bytes(file), file); }

void save_ist(std::span<const packed_part> parts, const std::string& file) {
  const std::string bytes = ist_bytes(parts);
  try {
    read_ist(bytes, "clearance::save_ist");
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
  write_bytes(file, bytes);
}

}  // namespace clearance::io
