// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "discretise.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/face_loads.hpp"
#include "softsim/potential/quadrature.hpp"

// Models on hexahedra and ten-node tetrahedra.

namespace chart {

std::vector<Model> solids() {
  using namespace softsim;
  return {
      Model("hex8", "hexahedra",
            []<class T>(std::type_identity<T>, const Scene& s, int resolution) {
              const HexahedralMesh mesh = hexahedra_of(s, resolution);
              return std::visit([&](const auto& law) { return discrete<T>(s, mesh, elastic<T>(mesh, law)); },
                                s.law);
            }),
      Model("hex8_corotational", "corotational",
            []<class T>(std::type_identity<T>, const Scene& s, int resolution) {
              const HexahedralMesh mesh = hexahedra_of(s, resolution);
              return discrete<T>(s, mesh,
                                 elastic<T>(mesh, Corotational::from_young_poisson(s.young, s.poisson)));
            }),
      Model("tet10", "ten-node tetrahedra",
            []<class T>(std::type_identity<T>, const Scene& s, int resolution) {
              const QuadraticTetrahedralMesh mesh(s.tetrahedra(resolution));
              return std::visit([&](const auto& law) { return discrete<T>(s, mesh, elastic<T>(mesh, law)); },
                                s.law);
            }),
  };
}

}  // namespace chart
