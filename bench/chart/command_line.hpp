// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes.hpp"

namespace chart {

/// What a user has to hear in one sentence.
struct BadArguments : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A number out of the value of an option.
inline double positive_number(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double x = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != 0 || !(x > 0) || !(x < 1e12))
    throw BadArguments(option + " '" + text + "': must be a positive number");
  return x;
}

/// The words of a command line, one after the other.
class Words {
 public:
  Words(int argc, char** argv) : words_(argv + 1, argv + argc) {}
  /// The next word, if there is one.
  bool next(std::string& word) {
    if (at_ == words_.size()) return false;
    word = words_[at_++];
    return true;
  }
  /// The value of an option.
  std::string value_of(const std::string& option) {
    if (at_ == words_.size()) throw BadArguments(option + ": a value is missing");
    return words_[at_++];
  }
  /// The same, a number.
  double positive(const std::string& option) { return positive_number(option, value_of(option)); }

 private:
  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

/// The scenes of these names, or all.
inline std::vector<Scene> scenes_named(const std::vector<std::string>& names,
                                       const std::string& organ_mesh = SOFTSIM_ORGAN) {
  const std::vector<Scene> all = scenes(organ_mesh);
  std::vector<Scene> result;
  for (const std::string& name : names) {
    const std::size_t before = result.size();
    std::copy_if(all.begin(), all.end(), std::back_inserter(result),
                 [&](const Scene& s) { return name == "all" || s.name == name; });
    if (result.size() == before) throw BadArguments("no scene '" + name + "'; chart --list names them");
  }
  return result;
}

/// Puts the quantity of this name first; nothing if none is named.
inline void ask_for(const std::string& quantity, Scene& scene) {
  if (quantity.empty()) return;
  auto& all = scene.quantities;
  const auto asked =
      std::find_if(all.begin(), all.end(), [&](const Quantity& q) { return q.name == quantity; });
  if (asked == all.end())
    throw BadArguments("--quantity '" + quantity + "': " + scene.name +
                       " does not ask for it; chart --list names what it asks for");
  std::rotate(all.begin(), asked, asked + 1);
}

}  // namespace chart
