// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads a point cloud from a file, by the ending of its name. PLY and plain text are read here.

#include <clearance/io/cloud.hpp>
#include <clearance/io/error.hpp>

#include <string>
#include <string_view>

namespace clearance::io {

/// Reads a PLY file from memory; `file` is its name in the cloud and in errors.
cloud read_ply(std::string_view rest, const std::string& file);

/// Reads the vertices of a PLY file, ascii or binary, in the file's order, in double. Everything else is checked and
/// skipped. Throws std::runtime_error with a sentence if a value does not fit its type, or a count does not fit the
/// data.
cloud load_ply(const std::string& file, const read_limits& limits = {});

/// Reads a PCD file from memory; `file` is its name in the cloud and in errors.
cloud read_pcd(std::string_view bytes, const std::string& file, const read_limits& limits = {});

/// Reads a PCD file: ascii, binary or binary_compressed; its fields in any order and of any type; others are skipped.
/// Throws std::runtime_error naming file and line, also if POINTS does not match the data.
cloud load_pcd(const std::string& file, const read_limits& limits = {});

/// Reads a text file with one point per line: x y z in metres, then anything. Every line has the same number of words,
/// so that two lines run together are refused. Blanks, tabs, commas and semicolons separate words. A # at the start of
/// a word begins a comment, and so does // at the start of a line; "nan" keeps a record's place. Throws
/// std::runtime_error naming file and line, also for decimal commas and empty coordinates.
cloud load_xyz(const std::string& file, const read_limits& limits = {});

/// The ending of a file's name in small letters, with its dot.
std::string extension(const std::string& file);

/// Reads a point cloud by the ending of its name: .pcd, .ply, .xyz or .txt. Throws std::runtime_error.
cloud load_cloud(const std::string& file, const read_limits& limits = {});

}  // namespace clearance::io
