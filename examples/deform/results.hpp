// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "softsim/io/write_vtu.hpp"
#include "softsim/softsim.hpp"

namespace deform {

/// One vector per point as a field for display.
inline softsim::Field point_field(const std::string& name, const softsim::Vector<double>& v) {
  const softsim::Vector<double> packed = softsim::pack(v);
  return {name, 3, {packed.begin(), packed.end()}};
}

/// Writes the state as the next time of the series: deformed points; displacement, velocity and force at
/// points (the sum of elastic force and load: at a held node, minus its reaction); J, Cauchy stress and
/// strain energy in cells.
template <class System, class Law>
void write_state(softsim::VtuSeries& series, const softsim::TetrahedralMesh& mesh, const System& system,
                 const std::vector<Law>& laws, const std::vector<std::int32_t>& law_index,
                 const softsim::Motion<double>& motion) {
  std::vector<softsim::Vec3<double>> points = mesh.points();
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += motion.q.point(static_cast<std::ptrdiff_t>(i));
  softsim::Vector<double> force = softsim::Vector<double>::Zero(system.size());
  system.add_gradient(motion.q, force);
  force = -force;

  softsim::Field j{"J", 1, {}}, von_mises{"von_mises", 1, {}}, principal{"principal_cauchy_stress", 3, {}},
      energy{"strain_energy_density", 1, {}}, region{"region", 1, {}};
  for (const softsim::ElementField& f : softsim::element_fields(mesh, laws, law_index, motion.q)) {
    j.values.push_back(f.j);
    von_mises.values.push_back(f.von_mises);
    for (const double stress : f.principal) principal.values.push_back(stress);
    energy.values.push_back(f.energy_density);
  }
  region.values.assign(mesh.region().begin(), mesh.region().end());
  series.add(motion.time, points, mesh.tetrahedra(),
             {point_field("displacement", motion.q.displacement), point_field("velocity", motion.v),
              point_field("force", force)},
             {j, von_mises, principal, energy, region});
}

/// What summary.json holds.
struct Summary {
  std::size_t nodes = 0, tetrahedra = 0, fixed_nodes = 0, inverted_tetrahedra = 0;
  double volume = 0, mass = 0, max_displacement = 0, strain_energy = 0, kinetic_energy = 0, time = 0,
         residual = 0;
  softsim::Status status = softsim::Status::converged;
  std::string reason;
  int steps = 0;
  long newton_iterations = 0, linear_iterations = 0;
  double seconds_solving = 0, real_time_factor = 0;
};

/// Text as a JSON string.
inline std::string json_string(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) result += c;
  }
  return result + '"';
}

/// A number as JSON, with all its digits; null if it is not finite.
inline std::string json(double value) {
  if (!std::isfinite(value)) return "null";
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}

/// Writes summary.json, complete or not at all.
inline void write_summary(const std::string& path, const Summary& s, const std::string& mesh,
                          const std::string& material) {
  softsim::detail::AtomicFile file(path);
  file.write(
      std::string("{\n  \"mesh\": ") + json_string(mesh) + ",\n  \"material\": " + json_string(material) +
      ",\n  \"nodes\": " + std::to_string(s.nodes) + ",\n  \"tetrahedra\": " + std::to_string(s.tetrahedra) +
      ",\n  \"fixed_nodes\": " + std::to_string(s.fixed_nodes) + ",\n  \"volume\": " + json(s.volume) +
      ",\n  \"mass\": " + json(s.mass) +
      ",\n  \"status\": " + json_string(std::string(softsim::to_string(s.status))) +
      ",\n  \"reason\": " + json_string(s.reason) + ",\n  \"steps\": " + std::to_string(s.steps) +
      ",\n  \"time\": " + json(s.time) + ",\n  \"max_displacement\": " + json(s.max_displacement) +
      ",\n  \"strain_energy\": " + json(s.strain_energy) + ",\n  \"kinetic_energy\": " +
      json(s.kinetic_energy) + ",\n  \"inverted_tetrahedra\": " + std::to_string(s.inverted_tetrahedra) +
      ",\n  \"newton_iterations\": " + std::to_string(s.newton_iterations) +
      ",\n  \"linear_iterations\": " + std::to_string(s.linear_iterations) +
      ",\n  \"residual\": " + json(s.residual) + ",\n  \"seconds_solving\": " + json(s.seconds_solving) +
      ",\n  \"real_time_factor\": " + json(s.real_time_factor) + "\n}\n");
  file.commit();
}

}  // namespace deform
