// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace stability {

/// A CSV file, written row by row.
class Table {
 public:
  /// @throws std::runtime_error if the file cannot be written
  Table(const std::filesystem::path& folder, const std::string& name, const std::string& header)
      : path_(folder / (name + ".csv")), out_(path_) {
    out_.precision(6);
    out_ << header << std::endl;
    if (!out_) throw std::runtime_error("cannot write '" + path_.string() + "'");
  }
  /// One row, flushed, so that a long run can be watched.
  template <class First, class... Rest>
  void row(const First& first, const Rest&... rest) {
    out_ << first;
    ((out_ << ',' << rest), ...);
    out_ << std::endl;
    if (!out_) throw std::runtime_error("cannot write '" + path_.string() + "'");
  }

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

/// Claims of a program: those that do not hold are printed, and make it fail.
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

/// main of a program of the atlas: `[--short] [output folder]`, by default out/stability. Calls body(folder,
/// short_form, claims), which writes tables and prints one line about each.
/// @return 0, 1 if a claim is violated or something fails, 2 for bad arguments
template <class Body>
int run(int argc, char** argv, const std::string& name, Body body) {
  std::filesystem::path folder;
  bool short_form = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--short") {
      short_form = true;
    } else if (argument.empty() || argument[0] == '-' || !folder.empty()) {
      std::cerr << "stability_" << name << ": unknown argument '" << argument << "'; usage: stability_"
                << name << " [--short] [output folder]\n";
      return 2;
    } else {
      folder = argument;
    }
  }
  if (folder.empty()) folder = std::filesystem::path("out") / "stability";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  try {
    Claims claims;
    body(folder, short_form, claims);
    std::printf("%d of %d claims hold.\n", claims.all() - claims.violated(), claims.all());
    return claims.violated() == 0 ? 0 : 1;
  } catch (const std::exception& failure) {
    std::cerr << "stability_" << name << ": " << failure.what() << '\n';
    return 1;
  }
}

}  // namespace stability
