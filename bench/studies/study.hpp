// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <system_error>

/// What the studies share. A study takes an output folder (default out/studies), writes <name>.csv there,
/// prints what it found and checks it.
namespace study {

/// Calls body(csv, long_form), which writes the rows, prints and returns whether the claims hold.
/// @param header first line of <name>.csv, columns between commas
/// @return status of the program: 0, 1 if a claim is violated or a solve fails, 2 for bad arguments
template <class Body>
int run(int argc, char** argv, const std::string& name, const std::string& header, bool has_long_form,
        Body body) {
  const auto refuse = [&](const std::string& why) {
    std::cerr << "study_" << name << ": " << why << "; usage: study_" << name
              << (has_long_form ? " [--long]" : "") << " [output folder]\n";
    return 2;
  };
  std::filesystem::path folder;
  bool long_form = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (has_long_form && argument == "--long")
      long_form = true;
    else if (argument.empty() || argument[0] == '-')
      return refuse(std::string("unknown argument '") + argument + "'");
    else if (!folder.empty())
      return refuse(std::string("second output folder '") + argument + "'");
    else
      folder = argument;
  }
  if (folder.empty()) folder = std::filesystem::path("out") / "studies";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::ofstream csv(folder / (name + ".csv"));
  csv.precision(12);
  csv << header << '\n';
  if (!csv.flush()) return refuse(std::string("cannot write in '") + folder.string() + "'");
  try {
    const bool holds = body(csv, long_form);
    if (!csv.flush()) return refuse(std::string("cannot write in '") + folder.string() + "'");
    if (!holds) std::cerr << "study_" << name << ": a claim is violated\n";
    return holds ? 0 : 1;
  } catch (const std::exception& failure) {
    std::cerr << "study_" << name << ": " << failure.what() << '\n';
    return 1;
  }
}

}  // namespace study
