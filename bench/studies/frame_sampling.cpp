// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "frame_statics.hpp"
#include "softsim/mesh/sampling.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "study.hpp"

// What samples cost in accuracy: the soft beam of frame_statics with frames on the nodes of one mesh, and
// more and more samples in it: Gauss points, equal shares of a lattice in each element, and samples scattered
// over the body (Poisson-disk) with equal or Voronoi shares. The error is that of the sampling alone: against
// so many Gauss points that more change nothing. Nodes inside are moved, as in a real mesh.

namespace {

using namespace frame_statics;
using softsim::ElementSamples, softsim::HexahedralMesh, softsim::IntegrationPoint, softsim::Samples,
    softsim::TetrahedralMesh;

constexpr std::array<int, 3> cells{8, 2, 2};

// The beam with its nodes displaced by up to a fifth of a cell; those of a side stay in it.
template <class Mesh>
Mesh moved(const Mesh& mesh) {
  std::vector<Vec> X = mesh.points();
  for (Vec& x : X) {
    Vec d;
    for (int a = 0; a < 3; ++a) {
      const double cell = soft.size[a] / cells[static_cast<std::size_t>(a)];
      const bool side = x[a] < 1e-9 || x[a] > soft.size[a] - 1e-9;
      d[a] = side ? 0 : 0.2 * cell * std::sin(5 * x[(a + 1) % 3] + 7 * x[(a + 2) % 3] + 3 * x[a] + a);
    }
    x += d;
  }
  return Mesh(X, mesh.elements());
}

std::vector<IntegrationPoint<3>> tensor_rule(int n) {
  std::vector<IntegrationPoint<3>> rule;
  const auto line = softsim::gauss_legendre(n);
  for (const auto& z : line)
    for (const auto& y : line)
      for (const auto& x : line) rule.push_back({{x.x, y.x, z.x}, x.weight * y.weight * z.weight});
  return rule;
}
// A cube pressed into a tetrahedron, so that any number of Gauss points fits.
std::vector<IntegrationPoint<3>> collapsed_rule(int n) {
  std::vector<IntegrationPoint<3>> rule = tensor_rule(n);
  for (auto& [xi, weight] : rule) {
    const double a = (1 + xi[0]) / 2, b = (1 + xi[1]) / 2, c = (1 + xi[2]) / 2;
    xi = {a, b * (1 - a), c * (1 - a) * (1 - b)};
    weight *= (1 - a) * (1 - a) * (1 - b) / 8;
  }
  return rule;
}
Samples gauss(const HexahedralMesh& mesh, int n) {
  return softsim::detail::samples_in_elements<softsim::TrilinearHexahedronShape>(
      mesh, tensor_rule(n), softsim::detail::Weights::reference_volume);
}
Samples gauss(const TetrahedralMesh& mesh, int n) {
  return softsim::detail::samples_in_elements<softsim::detail::LinearTetrahedronMap>(
      mesh, collapsed_rule(n), softsim::detail::Weights::reference_volume);
}

using Errors = std::map<std::string, std::vector<double>>;

class Sweep {
 public:
  explicit Sweep(std::ostream& csv) : csv_(csv) {}

  // Errors of the tip by method and samples per element.
  template <class Mesh, class Rules>
  Errors operator()(const std::string& name, const Mesh& mesh, const Rules& gauss_rules,
                    const std::vector<int>& equal) {
    const auto tip = [&](const Samples& samples) {
      return with_frames(soft, mesh, Arms::half, samples, 4).u;
    };
    const Vec reference = tip(gauss(mesh, 6)), coarser = tip(gauss(mesh, 5));
    settled = settled && (reference - coarser).norm() < 1e-6 * reference.norm();
    Errors errors;
    const auto add = [&](const std::string& method, const Samples& samples) {
      const double per_element = static_cast<double>(samples.positions.size()) /
                                 static_cast<double>(mesh.elements().size()),
                   error = (tip(samples) - reference).norm() / reference.norm();
      errors[method].push_back(error);
      csv_ << name << ',' << method << ',' << per_element << ',' << error << std::endl;
      std::printf("%s, %s, %.1f samples an element: %.2g of the deflection\n", name.c_str(), method.c_str(),
                  per_element, error);
    };
    for (const auto& samples : gauss_rules) add("gauss", samples);
    const softsim::SurfaceDomain body = softsim::surface_domain(softsim::box_mesh({1, 1, 1}, soft.size));
    for (const int n : equal) {
      add("equal", softsim::equal_samples(mesh, n));
      const double spacing =
          0.9 * std::cbrt(soft.size.prod() / (n * static_cast<double>(mesh.elements().size())));
      for (const auto shares : {softsim::VolumeShares::equal, softsim::VolumeShares::voronoi})
        add(shares == softsim::VolumeShares::equal ? "scattered_equal" : "scattered_voronoi",
            softsim::sample(body, spacing, {.shares = shares}));
    }
    return errors;
  }

  bool settled = true;

 private:
  std::ostream& csv_;
};

// The second Gauss rule is as exact as promised and beats all samples of other kinds, and scattered ones need
// Voronoi shares.
bool gauss_is_best(const Errors& errors, double promised) {
  const double gauss = errors.at("gauss")[1];
  const auto all_above = [](const std::vector<double>& these, const auto& below) {
    return std::equal(these.begin(), these.end(), below.begin(), std::greater<>());
  };
  const auto floor = [&](const std::string& method) {
    return *std::min_element(errors.at(method).begin(), errors.at(method).end());
  };
  return gauss < promised && floor("equal") > gauss && floor("scattered_voronoi") > floor("equal") &&
         all_above(errors.at("scattered_equal"), errors.at("scattered_voronoi"));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "mesh,method,samples_per_element,error";
  return study::run(argc, argv, "frame_sampling", header, true, [](std::ostream& csv, bool long_form) {
    Sweep sweep(csv);
    const auto hexahedra = moved(softsim::box_hexahedra(cells, soft.size));
    std::vector<Samples> rules{softsim::gauss_samples(hexahedra),
                               softsim::gauss_samples(hexahedra, softsim::ElementRule::mass)};
    std::vector<int> equal{8, 27};
    if (long_form) {
      rules.push_back(gauss(hexahedra, 4));
      equal.insert(equal.end(), {64, 125, 216});
    }
    const auto cubes = sweep("hexahedra", hexahedra, rules, equal);
    const auto tetrahedra = moved(softsim::box_mesh(cells, soft.size));
    rules = {softsim::gauss_samples(tetrahedra, 4), softsim::gauss_samples(tetrahedra, 14)};
    equal = {4, 10};
    if (long_form) equal.insert(equal.end(), {20, 35, 56});
    const auto simplices = sweep("tetrahedra", tetrahedra, rules, equal);
    return sweep.settled && gauss_is_best(cubes, 1e-3) && gauss_is_best(simplices, 1e-8);
  });
}
