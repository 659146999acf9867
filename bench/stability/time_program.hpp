// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <system_error>

/// What the programs about time steps share: their command line, tables and verdict.
namespace time_atlas {

/// Command line of a program: [--short] [output folder] [--mesh path].
struct Arguments {
  bool is_short = false;
  std::filesystem::path folder = std::filesystem::path("out") / "stability";
  std::string mesh;  ///< empty: the program's own
};

/// A table in the output folder.
inline std::ofstream table(const Arguments& arguments, const std::string& name, const std::string& header) {
  std::ofstream csv(arguments.folder / (name + ".csv"));
  csv.precision(10);
  csv << header << '\n';
  return csv;
}

/// Counts promises that are broken, and names each on stderr.
class Promises {
 public:
  /// Says what is broken unless it holds.
  void check(bool holds, const std::string& what) {
    if (holds) return;
    std::cerr << "broken: " << what << '\n';
    ++broken_;
  }
  [[nodiscard]] int broken() const { return broken_; }

 private:
  int broken_ = 0;
};

/// Calls body(arguments, promises).
/// @return status of the program: 0, 1 if a promise is broken or something failed, 2 for bad arguments
template <class Body>
int run(int argc, char** argv, Body body) {
  Arguments arguments;
  bool has_folder = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--short") {
      arguments.is_short = true;
    } else if (argument == "--mesh" && i + 1 < argc) {
      arguments.mesh = argv[++i];
    } else if (argument.empty() || argument[0] == '-' || has_folder) {
      std::cerr << "unexpected argument '" << argument << "'; usage: " << argv[0]
                << " [--short] [--mesh path] [output folder]\n";
      return 2;
    } else {
      arguments.folder = argument;
      has_folder = true;
    }
  }
  std::error_code error;
  std::filesystem::create_directories(arguments.folder, error);
  if (!std::filesystem::is_directory(arguments.folder)) {
    std::cerr << "cannot write in '" << arguments.folder.string() << "'\n";
    return 2;
  }
  try {
    Promises promises;
    body(static_cast<const Arguments&>(arguments), promises);
    if (promises.broken() > 0) std::cerr << promises.broken() << " promises broken\n";
    return promises.broken() == 0 ? 0 : 1;
  } catch (const std::exception& failure) {
    std::cerr << argv[0] << ": " << failure.what() << '\n';
    return 1;
  }
}

}  // namespace time_atlas
