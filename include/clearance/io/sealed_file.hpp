// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What this library's own binary files have in common. Bytes: docs/packing.md#the-ist-format-version-1.

#include <clearance/io/bytes.hpp>

namespace clearance::io {

/// A kind of file: 8 bytes that it begins with, its version, and how sentences call it.
struct sealed_form {
  std::string_view magic;
  std::uint32_t version;
  const char *one, *many;  ///< "an .ist file", ".ist files"
};

/// A file of `count` records: a header of 24 bytes, the records, and a checksum of both.
std::string sealed(const sealed_form& form, std::uint32_t count, std::string_view records);

/// The records of a file that is whole, undamaged and of this version.
struct unsealed {
  byte_reader in;
  std::uint32_t count = 0;

  /// Error sentences name `file`, which must outlive this.
  unsealed(std::string_view bytes, const std::string& file, const sealed_form& form);
  /// Refuses bytes after the last record.
  void finish(const std::string& file) const {
    if (in.left() != 0) refuse(file, "has " + std::to_string(in.left()) + " bytes after its last part");
  }
};

}  // namespace clearance::io
