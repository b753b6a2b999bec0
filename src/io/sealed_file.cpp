// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/sealed_file.hpp>

#include "io/png_check.hpp"

#include <clearance/io/bytes.hpp>

namespace clearance::io {

std::string sealed(const sealed_form& form, std::uint32_t count, std::string_view records) {
  byte_writer out;
  out.reserve(28 + records.size());
  out.put(form.magic);
  out.put(form.version);
  out.put(count);
  out.put(std::uint64_t(24 + records.size() + 4));
  out.put(records);
  out.put(png_crc(out.bytes()));
  return out.bytes();
}

unsealed::unsealed(std::string_view bytes, const std::string& file, const sealed_form& form) : in({}, file) {
  if (!bytes.starts_with(form.magic)) refuse(file, std::string("is not ") + form.one);
  if (bytes.size() < 28) refuse(file, "is cut short: " + std::to_string(bytes.size()) + " bytes hold no header");
  in = byte_reader(bytes.substr(0, bytes.size() - 4), file);
  in.take(form.magic.size());
  const auto version = in.take<std::uint32_t>();
  if (version == form.version << 24)
    refuse(file, std::string("is written in big-endian byte order, and ") + form.many + " are little-endian");
  if (version != form.version)
    refuse(file, "is of version " + std::to_string(version) + ", and this clearance reads version " +
                     std::to_string(form.version));
  count = in.take<std::uint32_t>();
  const auto size = in.take<std::uint64_t>();
  if (size != bytes.size())
    refuse(file, std::string(size > bytes.size() ? "is cut short" : "has bytes after its end") + ": it should have " +
                     std::to_string(size) + " bytes, and has " + std::to_string(bytes.size()));
  if (byte_reader(bytes.substr(bytes.size() - 4), file).take<std::uint32_t>() !=
      png_crc(bytes.substr(0, bytes.size() - 4)))
    refuse(file, "is damaged (the checksum does not match)");
  if (count == 0) refuse(file, "holds no part");
}

}  // namespace clearance::io
