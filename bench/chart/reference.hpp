// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene.hpp"

namespace chart {

/// The answer to a scene: displacements at its probes, time after time, and how far they may be off
/// themselves.
struct Reference {
  std::vector<Vec> u;
  double error = 0;  ///< relative, as that of a method
  std::string recipe;
};

/// sqrt(sum |u - v|^2 / sum |v|^2).
inline double relative_distance(const std::vector<Vec>& u, const std::vector<Vec>& v) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    difference += (u[i] - v[i]).squaredNorm();
    size += v[i].squaredNorm();
  }
  return std::sqrt(difference / size);
}

/// Of the closed form, or out of FOLDER/NAME.csv.
/// @throws std::runtime_error if there is none, or it is of other probes
inline Reference reference_of(const Scene& scene, const std::filesystem::path& folder) {
  Reference r;
  if (scene.closed_form) {
    for (const double t : times_of(scene))
      for (const Vec& X : scene.probes) r.u.push_back(scene.closed_form(X, t));
    r.error = 1e-9;  // the digits that it is written with
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
  while (std::getline(file, line)) {
    if (line.rfind("# error ", 0) == 0) {
      r.error = std::stod(line.substr(8));
    } else if (line.rfind("# ", 0) == 0) {
      r.recipe = line.substr(2);
    } else if (!line.empty() && line[0] != 'x') {
      std::istringstream in(line);
      Vec X, u;
      char comma = 0;
      in >> X[0] >> comma >> X[1] >> comma >> X[2] >> comma >> u[0] >> comma >> u[1] >> comma >> u[2];
      if (!in) fail("has a line that is not six numbers: '" + line + "'");
      if (r.u.size() >= scene.probes.size() || (X - scene.probes[r.u.size()]).norm() > 1e-6 * (1 + X.norm()))
        fail("is of other points than the scene asks for");
      r.u.push_back(u);
    }
  }
  if (r.u.size() != scene.probes.size()) fail("has too few points");
  if (!(r.error > 0)) fail("does not tell its own error");
  return r;
}

/// Writes FOLDER/NAME.csv.
inline void write_reference(const Scene& scene, const Reference& r, const std::filesystem::path& folder) {
  std::ofstream file(folder / (scene.name + ".csv"));
  file.precision(9);
  file << "# " << r.recipe << "\n# error " << r.error << "\nx,y,z,ux,uy,uz\n";
  for (std::size_t i = 0; i < r.u.size(); ++i) {
    const Vec& X = scene.probes[i];
    file << X[0] << ',' << X[1] << ',' << X[2] << ',' << r.u[i][0] << ',' << r.u[i][1] << ',' << r.u[i][2]
         << '\n';
  }
  if (!file.flush()) throw std::runtime_error("cannot write the reference of " + scene.name);
}

}  // namespace chart
