// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/selection.hpp"

namespace deform {

using softsim::invalid;
using softsim::Side;
using softsim::Vec3;

inline constexpr const char* help =
    "deform: a tetrahedral mesh under load, from a file to a ParaView series and a picture. All values in SI "
    "units.\n"
    "\n"
    "  deform [MESH] [--static | --steps N --dt S] --material LAW --young E --poisson NU --density RHO --fix "
    "SIDE\n"
    "         [options]\n"
    "\n"
    "  MESH                     .msh (Gmsh ASCII 1, 2, 4.1), .vtk (legacy ASCII) or .vtu (ASCII); "
    "coordinates in metres.\n"
    "                           Without it the shipped organ is held, weighed down and pulled; --material, "
    "--young,\n"
    "                           --poisson, --density and --fix are required with it.\n"
    "  --static                 static equilibrium under the full load at once, by Newton's method (the "
    "default with\n"
    "                           MESH); mass, integrator and damping do not matter then\n"
    "  --steps N --dt S         N time steps of S seconds from rest\n"
    "  --material LAW           svk, neo-hookean, stable-neo-hookean or linear\n"
    "  --young E                Young's modulus, Pa\n"
    "  --poisson NU             Poisson's ratio, in (-1, 0.5)\n"
    "  --density RHO            kg/m^3\n"
    "  --region ID:E,NU[,RHO]   other parameters for the tetrahedra of one region (repeatable)\n"
    "  --cell-array NAME        the integer cell array of a .vtk or .vtu that holds the regions\n"
    "  --fix SIDE               hold the nodes of a side: xmin, xmax, ymin, ymax, zmin or zmax (repeatable)\n"
    "  --fix-depth FRACTION     a side takes the nodes within this fraction of the extent (0.02)\n"
    "  --gravity X,Y,Z          m/s^2 (0,0,0)\n"
    "  --pull SIDE:FX,FY,FZ     a total force in N, spread over the nodes of a side (repeatable)\n"
    "  --mass KIND              lumped (default) or consistent\n"
    "  --integrator NAME        backward-euler (default) or semi-explicit\n"
    "  --newton                 backward Euler: Newton's method to tolerance in every step, not one "
    "linearised solve\n"
    "  --rayleigh A,B           damping alpha in 1/s and beta in s (0,0)\n"
    "  --tolerance T            1e-6. Newton: residual over external load (norms); linearised step: relative "
    "residual\n"
    "                           of the linear solve\n"
    "  --scale S                multiply the coordinates of MESH by S (0.001 for a mesh in millimetres)\n"
    "  --write-every K          write every K-th step and the last one (default: about 50 in all)\n"
    "  --out DIR                folder of the results (out/ and the name of the mesh)\n"
    "  --no-picture             do not draw DIR/deform.png\n"
    "  --help                   this text\n"
    "\n"
    "Results in DIR: deform.pvd and deform_*.vtu for ParaView, deform.png, summary.json.\n"
    "Exit code: 0 converged; 1 the results cannot be written; 2 bad input, nothing is written; 3 a step did "
    "not converge,\n"
    "is not finite, turns elements inside out or makes energy out of nothing: what was written until then\n"
    "stays readable.\n";

/// Elastic parameters of one region.
struct RegionParameters {
  double young = 0, poisson = 0, density = 0;
};

/// A total force on a side.
struct Pull {
  Side side;
  Vec3<double> force;
};

/// What the command line asks for.
struct Options {
  bool show_help = false;
  std::string mesh;  // empty: the shipped organ
  std::string out;
  std::string material, cell_array;
  RegionParameters parameters;
  std::map<int, RegionParameters> regions;
  std::vector<Side> fix;
  double fix_depth = 0.02;
  Vec3<double> gravity = Vec3<double>::Zero();
  std::vector<Pull> pulls;
  bool statics = true, consistent_mass = false, semi_explicit = false, newton = false, picture = true;
  int steps = 0, write_every = 0;
  double dt = 0, alpha = 0, beta = 0, tolerance = 1e-6, scale = 1;
};

/// Cuts `text` at every `separator`.
inline std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// An option and the whole of its value, for the messages about a part of it.
struct Argument {
  std::string name, text;

  [[noreturn]] void refuse(const std::string& why) const { invalid(name + " " + text + ": " + why); }
};

/// The whole of `part` as a number.
template <class Number>
Number number(const Argument& argument, std::string_view part) {
  if (part.size() > 1 && part[0] == '+' && part[1] != '-') part.remove_prefix(1);
  Number value{};
  const char* end = part.data() + part.size();
  const auto [last, error] = std::from_chars(part.data(), end, value);
  const std::string quoted_part = std::string("'") + std::string(part) + "'";
  if (error == std::errc::result_out_of_range && last == end)
    argument.refuse(quoted_part + " is out of range");
  if (error != std::errc{} || last != end)
    argument.refuse(quoted_part + " is not " + (std::is_integral_v<Number> ? "a whole number" : "a number"));
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) argument.refuse("must be finite");
  return value;
}
template <class Number>
Number number(const Argument& argument) {
  return number<Number>(argument, argument.text);
}

/// Numbers with commas between them.
inline std::vector<double> numbers(const Argument& argument, std::string_view part, std::size_t least,
                                   std::size_t most) {
  std::vector<double> values;
  for (const std::string_view piece : split(part, ',')) values.push_back(number<double>(argument, piece));
  if (values.size() < least || values.size() > most)
    argument.refuse(std::string("needs ") + std::to_string(least) +
                    (most > least ? std::string(" or ") + std::to_string(most) : "") +
                    " numbers with commas between them");
  return values;
}

inline Vec3<double> vector(const Argument& argument, std::string_view part) {
  const std::vector<double> v = numbers(argument, part, 3, 3);
  return {v[0], v[1], v[2]};
}

inline Side side(const Argument& argument, std::string_view part) {
  const auto found = softsim::parse_side(part);
  if (!found) argument.refuse("the side must be one of xmin, xmax, ymin, ymax, zmin, zmax");
  return *found;
}

/// The parts before and after the colon.
inline std::pair<std::string_view, std::string_view> at_colon(const Argument& argument, const char* form) {
  const std::string_view text = argument.text;
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) argument.refuse(std::string("must be ") + form);
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// Which of two words.
inline bool is_second(const Argument& argument, const std::string& first, const std::string& second) {
  if (argument.text != first && argument.text != second)
    argument.refuse(std::string("must be ") + first + " or " + second);
  return argument.text == second;
}

/// The shipped organ, held at its bottom, under its weight, pulled up and out at the tip of its left lobe;
/// used for what the command line leaves open when it names no mesh.
inline Options organ_defaults() {
  Options o;
  o.material = "neo-hookean";
  o.parameters = {10000, 0.4, 1060};
  o.fix = {Side::zmin};
  o.fix_depth = 0.2;
  o.gravity = {0, 0, -9.81};
  o.pulls = {{Side::xmax, {1, 0, 2.2}}};
  o.statics = false;
  o.steps = 100;
  o.dt = 0.01;
  o.newton = true;
  o.alpha = 2;
  return o;
}

/// Names of all options; true for those that take a value.
inline const std::map<std::string, bool>& option_names() {
  static const std::map<std::string, bool> names{
      {"--static", false},    {"--steps", true},       {"--dt", true},         {"--material", true},
      {"--young", true},      {"--poisson", true},     {"--density", true},    {"--region", true},
      {"--cell-array", true}, {"--fix", true},         {"--fix-depth", true},  {"--gravity", true},
      {"--pull", true},       {"--mass", true},        {"--integrator", true}, {"--newton", false},
      {"--rayleigh", true},   {"--tolerance", true},   {"--scale", true},      {"--write-every", true},
      {"--out", true},        {"--no-picture", false}, {"--help", false},      {"-h", false}};
  return names;
}

/// Splits the command line into the names of meshes and the options with their values.
inline std::pair<std::vector<std::string>, std::vector<Argument>> tokens(
    const std::vector<std::string>& words) {
  std::vector<std::string> meshes;
  std::vector<Argument> named;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].empty() || words[i][0] != '-') {
      meshes.push_back(words[i]);
      continue;
    }
    const std::size_t equals = words[i].find('=');
    Argument argument{words[i].substr(0, equals), ""};
    const auto known = option_names().find(argument.name);
    if (known == option_names().end()) invalid(argument.name + ": unknown option (--help lists them)");
    if (equals != std::string::npos)
      argument.text = words[i].substr(equals + 1);
    else if (known->second && i + 1 < words.size() && option_names().count(words[i + 1]) == 0)
      argument.text = words[++i];
    if (known->second && argument.text.empty()) invalid(argument.name + ": needs a value");
    if (!known->second && equals != std::string::npos) invalid(argument.name + ": takes no value");
    named.push_back(argument);
  }
  return {meshes, named};
}

/// Puts one option into place.
inline void apply(const Argument& argument, Options& o) {
  const auto& [name, text] = argument;
  if (name == "--static")
    o.statics = true;
  else if (name == "--newton")
    o.newton = true;
  else if (name == "--no-picture")
    o.picture = false;
  else if (name == "--steps")
    o.steps = number<int>(argument);
  else if (name == "--dt")
    o.dt = number<double>(argument);
  else if (name == "--material")
    o.material = text;
  else if (name == "--young")
    o.parameters.young = number<double>(argument);
  else if (name == "--poisson")
    o.parameters.poisson = number<double>(argument);
  else if (name == "--density")
    o.parameters.density = number<double>(argument);
  else if (name == "--cell-array")
    o.cell_array = text;
  else if (name == "--fix")
    o.fix.push_back(side(argument, text));
  else if (name == "--fix-depth")
    o.fix_depth = number<double>(argument);
  else if (name == "--gravity")
    o.gravity = vector(argument, text);
  else if (name == "--mass")
    o.consistent_mass = is_second(argument, "lumped", "consistent");
  else if (name == "--integrator")
    o.semi_explicit = is_second(argument, "backward-euler", "semi-explicit");
  else if (name == "--tolerance")
    o.tolerance = number<double>(argument);
  else if (name == "--scale")
    o.scale = number<double>(argument);
  else if (name == "--write-every")
    o.write_every = number<int>(argument);
  else if (name == "--out")
    o.out = text;
  else if (name == "--rayleigh") {
    const std::vector<double> v = numbers(argument, text, 2, 2);
    o.alpha = v[0];
    o.beta = v[1];
    if (!(o.alpha >= 0 && o.beta >= 0)) argument.refuse("must not be negative");
  } else if (name == "--pull") {
    const auto [where, force] = at_colon(argument, "SIDE:FX,FY,FZ");
    o.pulls.push_back({side(argument, where), vector(argument, force)});
  } else if (name == "--region") {
    const auto [id, values] = at_colon(argument, "ID:E,NU or ID:E,NU,RHO");
    const std::vector<double> v = numbers(argument, values, 2, 3);
    const auto [place, is_new] =
        o.regions.emplace(number<int>(argument, id), RegionParameters{v[0], v[1], v.size() == 3 ? v[2] : 0});
    if (!is_new) argument.refuse("this region was given before");
  }
}

/// Reads the command line. @throws std::invalid_argument with one sentence
inline Options parse(const std::vector<std::string>& words) {
  const auto [meshes, named] = tokens(words);
  std::map<std::string, int> given;
  for (const Argument& argument : named) ++given[argument.name];
  const auto has = [&](const char* name) { return given.count(name) > 0; };

  Options o;
  o.show_help = has("--help") || has("-h");
  if (o.show_help) return o;
  if (meshes.size() > 1) invalid(meshes[1] + ": only one mesh can be given (" + meshes[0] + " is the first)");
  if (meshes.empty()) {
    o = organ_defaults();
    if (has("--fix")) o.fix.clear();
    if (has("--pull")) o.pulls.clear();
    if (has("--integrator")) o.newton = false;
  } else {
    o.mesh = meshes[0];
    if (o.mesh.empty()) invalid("the mesh file's name is empty");
    for (const char* required : {"--material", "--young", "--poisson", "--density", "--fix"})
      if (!has(required)) invalid(std::string(required) + ": required when a mesh is given");
    if (has("--steps") != has("--dt")) invalid("--steps and --dt must be given together");
  }
  for (const Argument& argument : named) apply(argument, o);
  if (has("--steps") || has("--dt")) {
    if (has("--static")) invalid("--static and --steps/--dt exclude each other");
    o.statics = false;
  }

  for (auto& [id, region] : o.regions)
    if (region.density == 0) region.density = o.parameters.density;
  if (o.material != "svk" && o.material != "neo-hookean" && o.material != "stable-neo-hookean" &&
      o.material != "linear")
    invalid(std::string("--material ") + o.material +
            ": must be svk, neo-hookean, stable-neo-hookean or linear");
  const auto check = [](bool good, const std::string& what, double value, const std::string& why) {
    if (!good) invalid(what + " " + softsim::to_text(value) + ": " + why);
  };
  check(o.statics || o.steps >= 1, "--steps", o.steps, "must be at least 1");
  check(o.statics || o.dt > 0, "--dt", o.dt, "must be positive");
  check(o.tolerance > 0 && o.tolerance < 1, "--tolerance", o.tolerance, "must lie in (0, 1)");
  check(o.scale > 0, "--scale", o.scale, "must be positive");
  check(!has("--write-every") || o.write_every >= 1, "--write-every", o.write_every, "must be at least 1");
  check(o.fix_depth >= 0 && o.fix_depth <= 1, "--fix-depth", o.fix_depth, "must lie in [0, 1]");
  if (o.newton && o.semi_explicit) invalid("--newton: only backward-euler solves for its step");
  if (o.out.empty()) {
    const std::string name = o.mesh.empty() ? "organ" : o.mesh.substr(o.mesh.find_last_of('/') + 1);
    o.out = std::string("out/") + name.substr(0, name.find_last_of('.'));
  }
  return o;
}

}  // namespace deform
