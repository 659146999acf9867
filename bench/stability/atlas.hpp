// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <system_error>
#include <vector>

/// What the programs of the atlas share: atlas_<name> [FOLDER] [--short] [FILE...], tables FOLDER/<table>.csv
/// (default out/stability), one line a table on standard output, and an exit code that says whether every
/// promise holds.
namespace atlas {

/// CPU time of this thread, s: others' work on a shared machine does not count.
inline double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// How a program was called.
struct Call {
  std::filesystem::path folder = std::filesystem::path("out") / "stability";
  bool short_form = false;
  std::vector<std::string> files;  ///< meshes to work on

  /// FOLDER/<table>.csv with its first line. @throws std::runtime_error if it cannot be written
  [[nodiscard]] std::ofstream table(const std::string& name, const std::string& header) const {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    std::ofstream csv(folder / (name + ".csv"));
    csv.precision(8);
    csv << header << '\n';
    if (!csv.flush()) throw std::runtime_error(std::string("cannot write in '") + folder.string() + "'");
    return csv;
  }
};

/// Calls body(call), which returns whether all promises hold.
/// @return status of the program: 0, 1 if a promise is broken or something fails, 2 for bad arguments
template <class Body>
int run(int argc, char** argv, const std::string& name, Body body) {
  Call call;
  bool folder_given = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--short") {
      call.short_form = true;
    } else if (argument.empty() || argument[0] == '-') {
      std::cerr << "atlas_" << name << ": unknown argument '" << argument << "'; usage: atlas_" << name
                << " [FOLDER] [--short] [FILE...]\n";
      return 2;
    } else if (!folder_given) {
      call.folder = argument;
      folder_given = true;
    } else {
      call.files.push_back(argument);
    }
  }
  try {
    if (body(call)) return 0;
    std::cerr << "atlas_" << name << ": a promise is broken\n";
  } catch (const std::exception& failure) {
    std::cerr << "atlas_" << name << ": " << failure.what() << '\n';
  }
  return 1;
}

}  // namespace atlas
