// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "any_system.hpp"
#include "discretise.hpp"
#include "scene.hpp"
#include "softsim/material/continued.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/material/fung.hpp"
#include "softsim/material/holzapfel_gasser_ogden.hpp"
#include "softsim/material/isochoric_neo_hookean.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/ogden.hpp"
#include "softsim/material/projected.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/material/sum.hpp"
#include "softsim/material/veronda_westmann.hpp"
#include "softsim/material/yeoh.hpp"

namespace atlas {

/// A law of the atlas: small-strain moduli are Young's modulus 1 Pa and a given Poisson's ratio.
struct LawEntry {
  std::string name;
  bool everywhere;  ///< defined for every F, inverted ones included
  std::vector<Discretisation> discretisations;
  std::function<Elasticity(const Mesh&, Discretisation)> make;
};

/// All laws, with the ways that bodies are made of them.
inline std::vector<LawEntry> all_laws(double nu) {
  using namespace softsim;
  using enum Discretisation;
  std::vector<LawEntry> laws;
  // linear tetrahedra by elastic()
  const auto plain = [&]<class Law>(const std::string& name, bool everywhere, const Law& law) {
    laws.push_back(
        {name, everywhere, {elastic}, [law](const Mesh& m, Discretisation) { return tetrahedra(m, law); }});
  };
  // and with a filtered tangent
  const auto both = [&]<class Law>(const std::string& name, bool everywhere, const Law& law) {
    plain(name, everywhere, law);
    plain(name + " projected", everywhere, projected(law));
  };
  // in all discretisations
  const auto full = [&]<class Law>(const std::string& name, bool everywhere, const Law& law) {
    laws.push_back({name, everywhere,
                    InvariantLaw<Law> ? std::vector{elastic, heml, quadratic, hexahedra}
                                      : std::vector{elastic, quadratic, hexahedra},
                    [law](const Mesh& m, Discretisation d) { return elasticity(m, law, d); }});
    plain(name + " projected", everywhere, projected(law));
  };
  const Lame lame = Lame::from_young_poisson(1, nu);
  const double bulk = lame.lambda + 2 * lame.mu / 3, c1 = lame.mu / 2;

  const auto stable = StableNeoHookean::from_young_poisson(1, nu);
  full("stable NH", true, stable);
  plain("stable NH absolute", true, projected(stable, SpdFilter::absolute));
  if (lame.lambda > 0)
    laws.push_back({"stable NH", true, {nodal_volume}, [lame](const Mesh& m, Discretisation) {
                      return averaged_stable_neo_hookean(m, lame);
                    }});
  full("corotational", true, Corotational::from_young_poisson(1, nu));
  plain("warped stiffness", true, WarpedStiffness::from_young_poisson(1, nu));
  full("continued NH", true, Continued<NeoHookean>(NeoHookean::from_young_poisson(1, nu)));
  both("continued NH 0.9", true, Continued<NeoHookean>(NeoHookean::from_young_poisson(1, nu), 0.9));
  full("St. Venant-Kirchhoff", true, StVenantKirchhoff::from_young_poisson(1, nu));
  plain("linear", true, LinearElastic::from_young_poisson(1, nu));
  plain("stable NH + fibres", true,
        stable + HolzapfelGasserOgden({.k1 = 0.1, .k2 = 0.05}).along(Vec::UnitX()));
  both("neo-Hookean", false, NeoHookean::from_young_poisson(1, nu));
  const auto mooney = MooneyRivlin::from_young_poisson(1, nu, 0.5);
  plain("Mooney-Rivlin", false, mooney);
  both("continued Mooney-Rivlin", true, Continued<MooneyRivlin>(mooney));
  if (lame.lambda > 0) {  // the penalty
    const CoupledMooneyRivlin coupled(lame.mu / 3, lame.mu / 6, lame.lambda);
    plain("coupled Mooney-Rivlin", false, coupled);
    both("continued coupled M.-R.", true, Continued<CoupledMooneyRivlin>(coupled));
  }
  plain("continued isochoric NH", true,
        Continued<IsochoricNeoHookean>(IsochoricNeoHookean::from_young_poisson(1, nu)));
  both("Ogden", false, Ogden({{lame.mu, 1.3}, {0.7 * lame.mu / 5, 5}}, bulk));
  plain("Yeoh", false, Yeoh(c1, 0.1 * c1, 0.01 * c1, bulk));
  both("continued Yeoh", true, Continued<Yeoh>(Yeoh(c1, 0.1 * c1, 0.01 * c1, bulk)));
  plain("Fung", false, Fung(lame.mu, 0.1, bulk));
  plain("continued Fung", true, Continued<Fung>(Fung(lame.mu, 0.1, bulk)));
  plain("Veronda-Westmann", false, VerondaWestmann::from_young_poisson(1, nu, 1));
  return laws;
}

}  // namespace atlas
