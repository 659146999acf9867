// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <system_error>
#include <type_traits>
#include <vector>

#include "softsim/core/error.hpp"

namespace frames {

using softsim::invalid;

inline constexpr const char* help =
    "frames: bodies of frames, with six degrees of freedom a node, after Bosman 2015, Sec. 4.3. SI units.\n"
    "\n"
    "  frames beam|sheet|line [options]\n"
    "\n"
    "  beam             three cantilevers under their own weight, E = 3, 9 and 18 kPa, nu = 0.3: 16 x 1 x 1 "
    "m,\n"
    "                   1 kg; sections of 9 frames, 36 samples between two sections, trilinear functions\n"
    "  sheet            4 x 2 x 0.1 m, E = 25 kPa, nu = 0.3, both short sides fixed, 300 N downward on the\n"
    "                   frames in the middle; 13 x 7 frames, 32 x 16 x 2 samples, Shepard's functions\n"
    "  line             a rod 9 m long, radius 0.2 m, E = 10 kPa, nu = 0, one end turned by 180 degrees;\n"
    "                   10 frames, 50 samples, Shepard's functions\n"
    "  --young PA       another Young's modulus (of the beam: this one instead of three)\n"
    "  --frames N       frames along the length: 17 in a beam, 13 in a sheet (4 k + 1), 10 in a line\n"
    "  --out DIR        folder of the results (out/ and the name of the example)\n"
    "  --no-picture     do not draw a picture\n"
    "  --help           this text\n"
    "\n"
    "Results in DIR, for every body (beam_3000, ..., sheet, line): BODY_samples.pvd and BODY_frames.pvd for\n"
    "ParaView, with a state per load step, and BODY.json; and one picture, beam.png for instance.\n"
    "Exit code: 0 converged; 1 a solve failed or results cannot be written: what was written stays; 2 bad\n"
    "input, nothing is written.\n";

/// What the command line asks for.
struct Options {
  bool show_help = false, picture = true;
  std::string example, out;
  double young = 0;  ///< Pa; 0: as in the thesis
  int frames = 0;    ///< along the length; 0: as in the thesis
};

/// The whole of `text` as a number.
template <class Number>
Number number(const std::string& name, const std::string& text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  bool good = error == std::errc{} && last == end;
  if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(value);
  if (!good)
    invalid(name + " '" + text + "': must be a " + (std::is_integral_v<Number> ? "whole" : "finite") +
            " number");
  return value;
}

/// Refuses numbers of frames that an example cannot be made of.
inline void check_frames(const Options& o) {
  const auto refuse = [&](const std::string& why) {
    invalid(std::string("--frames ") + std::to_string(o.frames) + ": " + why);
  };
  if (o.example == "beam" && o.frames < 9) refuse("a beam takes at least 9, gaps of twice its height");
  if (o.frames > 200) refuse("must be at most 200");
  if (o.example == "sheet" && (o.frames < 5 || o.frames % 4 != 1))
    refuse("a sheet takes 4 k + 1, such as 9, 13 or 17, so that one lies in the middle");
}

/// Reads the command line. @throws std::invalid_argument with one sentence
inline Options parse(const std::vector<std::string>& words) {
  Options o;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const auto value = [&]() -> const std::string& {
      if (i + 1 == words.size() || words[i + 1].empty()) invalid(word + ": needs a value");
      return words[++i];
    };
    if (word == "--help" || word == "-h") {
      o.show_help = true;
      return o;
    }
    if (word == "--no-picture") {
      o.picture = false;
    } else if (word == "--out") {
      o.out = value();
    } else if (word == "--young") {
      o.young = number<double>(word, value());
      if (!(o.young > 0)) invalid(word + " " + softsim::to_text(o.young) + ": must be positive");
    } else if (word == "--frames") {
      o.frames = number<int>(word, value());
      if (o.frames < 2) invalid(word + " " + std::to_string(o.frames) + ": must be at least 2");
    } else if (word.starts_with("-")) {
      invalid(word + ": unknown option (--help lists them)");
    } else if (!o.example.empty()) {
      invalid(word + ": only one example can be given (" + o.example + " is the first)");
    } else {
      o.example = word;
    }
  }
  if (o.example.empty()) invalid("an example is missing: beam, sheet or line");
  if (o.example != "beam" && o.example != "sheet" && o.example != "line")
    invalid(o.example + ": no such example, there are beam, sheet and line");
  if (o.frames == 0) o.frames = o.example == "beam" ? 17 : o.example == "sheet" ? 13 : 10;
  check_frames(o);
  if (o.out.empty()) o.out = std::string("out/") + o.example;
  return o;
}

}  // namespace frames
