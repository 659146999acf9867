// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <system_error>

/// The programs of the stability atlas, and what they share: atlas_<name> [--short] [--mesh PATH] [FOLDER]
/// writes tables into FOLDER (default out/stability), prints a line about each and checks what it claims.
namespace atlas {

/// Command line of a program.
struct Arguments {
  bool short_form = false;
  std::filesystem::path folder = std::filesystem::path("out") / "stability";
  std::string mesh;  ///< empty: the program's own
};

/// FOLDER/<name>.csv, written by << or row by row.
class Table : public std::ofstream {
 public:
  /// @param header first line, columns between commas
  /// @throws std::runtime_error if the file cannot be written
  Table(const Arguments& arguments, const std::string& name, const std::string& header)
      : std::ofstream(arguments.folder / (name + ".csv")) {
    precision(8);
    *this << header << std::endl;
    if (!*this)
      throw std::runtime_error(std::string("cannot write '") + name + ".csv' in '" +
                               arguments.folder.string() + "'");
  }
  /// One row, flushed, so that a long run can be watched.
  template <class First, class... Rest>
  void row(const First& first, const Rest&... rest) {
    *this << first;
    ((*this << ',' << rest), ...);
    *this << std::endl;
  }
};

/// What a program claims: claims that do not hold are printed, and make it fail.
class Claims {
 public:
  void check(bool holds, const std::string& claim) {
    ++all_;
    if (holds) return;
    ++violated_;
    std::cerr << "violated: " << claim << '\n';
  }
  [[nodiscard]] int all() const { return all_; }
  [[nodiscard]] int violated() const { return violated_; }

 private:
  int all_ = 0, violated_ = 0;
};

/// CPU time of this thread, s: others' work on a shared machine does not count.
inline double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// main of a program: calls body(arguments, claims).
/// @return 0, 1 if a claim is violated or something fails, 2 for bad arguments
template <class Body>
int run(int argc, char** argv, Body body) {
  Arguments arguments;
  bool has_folder = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--short") {
      arguments.short_form = true;
    } else if (argument == "--mesh" && i + 1 < argc) {
      arguments.mesh = argv[++i];
    } else if (argument.empty() || argument[0] == '-' || has_folder) {
      std::cerr << "unexpected argument '" << argument << "'; usage: " << argv[0]
                << " [--short] [--mesh PATH] [FOLDER]\n";
      return 2;
    } else {
      arguments.folder = argument;
      has_folder = true;
    }
  }
  std::error_code error;
  std::filesystem::create_directories(arguments.folder, error);
  try {
    Claims claims;
    body(static_cast<const Arguments&>(arguments), claims);
    std::printf("%d of %d claims hold.\n", claims.all() - claims.violated(), claims.all());
    return claims.violated() == 0 ? 0 : 1;
  } catch (const std::exception& failure) {
    std::cerr << argv[0] << ": " << failure.what() << '\n';
    return 1;
  }
}

}  // namespace atlas
