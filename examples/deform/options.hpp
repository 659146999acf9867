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
    "deform: a tetrahedral mesh under load, from a file to a ParaView series and a picture. All values in SI units.\n"
    "\n"
    "  deform [MESH] [--static | --steps N --dt S] --material LAW --young E --poisson NU --density RHO --fix SIDE\n"
    "         [options]\n"
    "\n"
    "  MESH                     .msh (Gmsh ASCII 1, 2, 4.1), .vtk (legacy ASCII) or .vtu (ASCII); coordinates in metres.\n"
    "                           Without it the shipped organ is held, weighed down and pulled; --material, --young,\n"
    "                           --poisson, --density and --fix are required with it.\n"
    "  --static                 static equilibrium under the full load at once (the default with MESH)\n"
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
    "  --newton                 backward Euler: Newton's method to tolerance in every step, not one linearised solve\n"
    "  --rayleigh A,B           damping alpha in 1/s and beta in s (0,0)\n"
    "  --tolerance T            1e-6. Newton: residual over external load (norms); linearised step: relative residual\n"
    "                           of the linear solve\n"
    "  --scale S                multiply the coordinates of MESH by S (0.001 for a mesh in millimetres)\n"
    "  --write-every K          write every K-th step and the last one (default: about 50 in all)\n"
    "  --out DIR                folder of the results (out/ and the name of the mesh)\n"
    "  --no-picture             do not draw DIR/deform.png\n"
    "  --help                   this text\n"
    "\n"
    "Results in DIR: deform.pvd and deform_*.vtu for ParaView, deform.png, summary.json.\n"
    "Exit code: 0 converged, 2 bad input (nothing is written), 3 a step did not converge or is not finite.\n";

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

/// The whole of `text` as a number. @throws std::invalid_argument naming the option
template <class Number>
Number number(std::string_view option, std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || last != end || text.empty())
    invalid(std::string(option) + " " + std::string(text) + ": not " +
            (std::is_integral_v<Number> ? "a whole number" : "a number"));
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) invalid(std::string(option) + " " + std::string(text) + ": must be finite");
  return value;
}

/// `count` numbers with commas between them.
inline std::vector<double> numbers(std::string_view option, std::string_view text, std::size_t least, std::size_t most) {
  std::vector<double> values;
  for (const std::string_view part : split(text, ',')) values.push_back(number<double>(option, part));
  if (values.size() < least || values.size() > most)
    invalid(std::string(option) + " " + std::string(text) + ": needs " + std::to_string(least) +
            (most > least ? " or " + std::to_string(most) : "") + " numbers with commas between them");
  return values;
}

inline Vec3<double> vector(std::string_view option, std::string_view text) {
  const std::vector<double> v = numbers(option, text, 3, 3);
  return {v[0], v[1], v[2]};
}

inline Side side(std::string_view option, std::string_view text) {
  const auto found = softsim::parse_side(text);
  if (!found) invalid(std::string(option) + " " + std::string(text) + ": must be one of xmin, xmax, ymin, ymax, zmin, zmax");
  return *found;
}

/// One of two words.
inline bool is_second(std::string_view option, std::string_view text, std::string_view first, std::string_view second) {
  if (text != first && text != second)
    invalid(std::string(option) + " " + std::string(text) + ": must be " + std::string(first) + " or " + std::string(second));
  return text == second;
}

/// The shipped organ, held at its bottom, under its weight, pulled up and out at the tip of its left lobe; used for what
/// the command line leaves open when it names no mesh.
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

/// Reads the command line. @throws std::invalid_argument with one sentence
inline Options parse(const std::vector<std::string>& arguments) {
  Options o;
  std::map<std::string, bool> given;
  std::vector<std::string> positional;
  std::vector<std::pair<std::string, std::string>> named;
  const std::map<std::string, bool> takes_value{
      {"--static", false}, {"--steps", true}, {"--dt", true}, {"--material", true}, {"--young", true},
      {"--poisson", true}, {"--density", true}, {"--region", true}, {"--cell-array", true}, {"--fix", true},
      {"--fix-depth", true}, {"--gravity", true}, {"--pull", true}, {"--mass", true}, {"--integrator", true},
      {"--newton", false}, {"--rayleigh", true}, {"--tolerance", true}, {"--scale", true}, {"--write-every", true},
      {"--out", true}, {"--no-picture", false}, {"--help", false}, {"-h", false}};
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string name = arguments[i];
    if (name.empty() || name[0] != '-') {
      positional.push_back(name);
      continue;
    }
    std::string value;
    const std::size_t equals = name.find('=');
    if (equals != std::string::npos) {
      value = name.substr(equals + 1);
      name.resize(equals);
    }
    const auto known = takes_value.find(name);
    if (known == takes_value.end()) invalid(name + ": unknown option (--help lists them)");
    if (!known->second && equals != std::string::npos) invalid(name + ": takes no value");
    if (known->second && equals == std::string::npos) {
      if (i + 1 == arguments.size()) invalid(name + ": needs a value");
      value = arguments[++i];  // may start with a minus sign
    }
    given[name] = true;
    named.emplace_back(name, value);
  }
  if (given.count("--help") + given.count("-h") > 0) {
    o.show_help = true;
    return o;
  }
  if (positional.size() > 1) invalid(positional[1] + ": only one mesh can be given (" + positional[0] + " is the first)");
  if (positional.empty()) o = organ_defaults();
  else if (positional[0].empty()) invalid("the mesh file's name is empty");
  else o.mesh = positional[0];
  if (given.count("--fix") > 0) o.fix.clear();
  if (given.count("--pull") > 0) o.pulls.clear();
  if (given.count("--integrator") > 0 && given.count("--newton") == 0) o.newton = false;

  for (const auto& [name, text] : named) {
    if (name == "--static") o.statics = true;
    else if (name == "--newton") o.newton = true;
    else if (name == "--no-picture") o.picture = false;
    else if (name == "--steps") o.steps = number<int>(name, text);
    else if (name == "--dt") o.dt = number<double>(name, text);
    else if (name == "--material") o.material = text;
    else if (name == "--young") o.parameters.young = number<double>(name, text);
    else if (name == "--poisson") o.parameters.poisson = number<double>(name, text);
    else if (name == "--density") o.parameters.density = number<double>(name, text);
    else if (name == "--cell-array") o.cell_array = text;
    else if (name == "--fix") o.fix.push_back(side(name, text));
    else if (name == "--fix-depth") o.fix_depth = number<double>(name, text);
    else if (name == "--gravity") o.gravity = vector(name, text);
    else if (name == "--mass") o.consistent_mass = is_second(name, text, "lumped", "consistent");
    else if (name == "--integrator") o.semi_explicit = is_second(name, text, "backward-euler", "semi-explicit");
    else if (name == "--tolerance") o.tolerance = number<double>(name, text);
    else if (name == "--scale") o.scale = number<double>(name, text);
    else if (name == "--write-every") o.write_every = number<int>(name, text);
    else if (name == "--out") o.out = text;
    else if (name == "--rayleigh") {
      const std::vector<double> v = numbers(name, text, 2, 2);
      o.alpha = v[0];
      o.beta = v[1];
    } else if (name == "--pull") {
      const std::size_t colon = text.find(':');
      if (colon == std::string::npos) invalid("--pull " + text + ": must be SIDE:FX,FY,FZ");
      o.pulls.push_back({side(name, std::string_view(text).substr(0, colon)), vector(name, std::string_view(text).substr(colon + 1))});
    }
  }
  const bool dynamic = given.count("--steps") + given.count("--dt") > 0;
  if (given.count("--static") > 0 && dynamic) invalid("--static and --steps/--dt exclude each other");
  if (dynamic && !o.mesh.empty() && (given.count("--steps") == 0 || given.count("--dt") == 0))
    invalid("--steps and --dt must be given together");
  if (dynamic) o.statics = false;

  if (!o.mesh.empty())
    for (const char* required : {"--material", "--young", "--poisson", "--density", "--fix"})
      if (given.count(required) == 0) invalid(std::string(required) + ": required when a mesh is given");
  for (const auto& [name, text] : named)
    if (name == "--region") {
      const std::size_t colon = text.find(':');
      if (colon == std::string::npos) invalid("--region " + text + ": must be ID:E,NU or ID:E,NU,RHO");
      const std::vector<double> v = numbers(name, std::string_view(text).substr(colon + 1), 2, 3);
      o.regions[number<int>(name, std::string_view(text).substr(0, colon))] = {v[0], v[1], v.size() == 3 ? v[2] : o.parameters.density};
    }
  if (o.material != "svk" && o.material != "neo-hookean" && o.material != "stable-neo-hookean" && o.material != "linear")
    invalid("--material " + o.material + ": must be svk, neo-hookean, stable-neo-hookean or linear");
  if (!o.statics && o.steps < 1) invalid("--steps " + std::to_string(o.steps) + ": must be at least 1");
  if (!o.statics && !(o.dt > 0)) invalid("--dt " + softsim::to_text(o.dt) + " s: must be positive");
  if (!(o.tolerance > 0 && o.tolerance < 1)) invalid("--tolerance " + softsim::to_text(o.tolerance) + ": must lie in (0, 1)");
  if (!(o.scale > 0)) invalid("--scale " + softsim::to_text(o.scale) + ": must be positive");
  if (!(o.alpha >= 0 && o.beta >= 0)) invalid("--rayleigh " + softsim::to_text(o.alpha) + "," + softsim::to_text(o.beta) + ": must not be negative");
  if (given.count("--write-every") > 0 && o.write_every < 1)
    invalid("--write-every " + std::to_string(o.write_every) + ": must be at least 1");
  if (o.newton && o.semi_explicit) invalid("--newton: only backward-euler solves for its step");
  if (o.out.empty()) {
    const std::string name = o.mesh.empty() ? "organ" : o.mesh.substr(o.mesh.find_last_of('/') + 1);
    o.out = "out/" + name.substr(0, name.find_last_of('.'));
  }
  return o;
}

}  // namespace deform
