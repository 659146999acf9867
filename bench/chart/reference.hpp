// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene.hpp"

namespace chart {

/// The answer to a scene, and how far it may be off itself.
struct Reference {
  Answer answer;
  std::vector<double> errors;  ///< of the scene's quantities, as those of a method
  std::string recipe;
};

/// Of the closed form, or out of FOLDER/NAME.csv.
/// @throws std::runtime_error if there is none, it is of other probes, or lacks a quantity
inline Reference reference_of(const Scene& scene, const std::filesystem::path& folder) {
  Reference r;
  if (scene.closed_form) {
    for (const double t : times_of(scene))
      for (const Vec& X : scene.probes) r.answer.u.push_back(scene.closed_form(X, t));
    r.answer.energy = {scene.closed_energy};
    r.answer.force = scene.closed_force;
    r.errors.assign(scene.quantities.size(), 1e-9);  // the digits that it is written with
    r.recipe = "closed form";
    return r;
  }
  const std::filesystem::path path = folder / (scene.name + ".csv");
  std::ifstream file(path);
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error("the reference of " + scene.name + ", '" + path.string() + "', " + what +
                             "; chart --reference " + scene.name + " makes it");
  };
  if (!file) fail("is missing");
  std::string line;
  r.errors.assign(scene.quantities.size(), not_told);
  while (std::getline(file, line)) {
    std::istringstream in(line);
    std::string word, of;
    if (line.rfind("# error ", 0) == 0) {
      double error = not_told;
      in >> word >> word >> of >> error;
      for (std::size_t k = 0; k < scene.quantities.size(); ++k)
        if (scene.quantities[k].name == of) r.errors[k] = error;
    } else if (line.rfind("# energy ", 0) == 0) {
      r.answer.energy = {std::stod(line.substr(9))};
    } else if (line.rfind("# force ", 0) == 0) {
      in >> word >> word >> r.answer.force[0] >> r.answer.force[1] >> r.answer.force[2];
    } else if (line.rfind("# ", 0) == 0) {
      r.recipe = line.substr(2);
    } else if (!line.empty() && line[0] != 'x') {
      Vec X, u;
      char comma = 0;
      in >> X[0] >> comma >> X[1] >> comma >> X[2] >> comma >> u[0] >> comma >> u[1] >> comma >> u[2];
      if (!in) fail("has a line that is not six numbers: '" + line + "'");
      const std::size_t next = r.answer.u.size();
      if (next >= scene.probes.size() || (X - scene.probes[next]).norm() > 1e-6 * (1e-3 + X.norm()))
        fail("is of other points than the scene asks for");
      r.answer.u.push_back(u);
    }
  }
  if (r.answer.u.size() != scene.probes.size()) fail("has too few points");
  for (std::size_t k = 0; k < scene.quantities.size(); ++k)
    if (!(r.errors[k] > 0)) fail("does not tell its own error of the " + scene.quantities[k].name);
  return r;
}

/// Writes FOLDER/NAME.csv.
inline void write_reference(const Scene& scene, const Reference& r, const std::filesystem::path& folder) {
  std::ofstream file(folder / (scene.name + ".csv"));
  file.precision(9);
  file << "# " << r.recipe << '\n';
  for (std::size_t k = 0; k < scene.quantities.size(); ++k)
    file << "# error " << scene.quantities[k].name << ' ' << r.errors[k] << '\n';
  if (!r.answer.energy.empty() && std::isfinite(r.answer.energy[0]))
    file << "# energy " << r.answer.energy[0] << '\n';
  if (!r.answer.force.hasNaN())
    file << "# force " << r.answer.force[0] << ' ' << r.answer.force[1] << ' ' << r.answer.force[2] << '\n';
  file << "x,y,z,ux,uy,uz\n";
  for (std::size_t i = 0; i < r.answer.u.size(); ++i) {
    const Vec &X = scene.probes[i], &u = r.answer.u[i];
    file << X[0] << ',' << X[1] << ',' << X[2] << ',' << u[0] << ',' << u[1] << ',' << u[2] << '\n';
  }
  if (!file.flush()) throw std::runtime_error("cannot write the reference of " + scene.name);
}

/// What the answers on three meshes, each twice as fine as the one before, tend to (Richardson); its own
/// error is half of what that adds to the finest.
inline Reference extrapolated(const Scene& scene, const std::array<Answer, 3>& a) {
  // how much of the last correction is still to come, if corrections go on shrinking like that
  const auto to_come = [](double before, double last) {
    return last > 0 ? 1 / (std::exp2(std::clamp(std::log2(before / last), 0.5, 4.0)) - 1) : 0;
  };
  Reference r;
  const double of_u = to_come(relative_distance(a[0].u, a[1].u), relative_distance(a[1].u, a[2].u));
  for (std::size_t i = 0; i < a[2].u.size(); ++i)
    r.answer.u.push_back(a[2].u[i] + of_u * (a[2].u[i] - a[1].u[i]));
  const double last = a[2].energy[0] - a[1].energy[0];
  r.answer.energy = {a[2].energy[0] +
                     to_come(std::abs(a[1].energy[0] - a[0].energy[0]), std::abs(last)) * last};
  const Vec of_force = a[2].force - a[1].force;
  r.answer.force = a[2].force + to_come((a[1].force - a[0].force).norm(), of_force.norm()) * of_force;
  for (const Quantity& q : scene.quantities)
    r.errors.push_back(std::max(q.error(scene, a[2], r.answer) / 2, 1e-9));
  return r;
}

}  // namespace chart
