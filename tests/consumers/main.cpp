// The stress of a slightly stretched block, as a program outside softsim's tree would ask for it.
// SPDX-License-Identifier: MIT
#include <softsim/softsim.hpp>

#include <cmath>
#include <cstdio>

int main() {
  const double young = 10.0, poisson = 0.3, strain = 1e-6;
  const auto law = softsim::NeoHookean::from_young_poisson(young, poisson);
  softsim::Mat3<double> F = softsim::Mat3<double>::Identity();
  F(0, 0) += strain;
  const softsim::Mat3<double> P = law.first_piola(F);

  // small strains: (lambda + 2 mu) e, up to terms of order e relative
  const double expected = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)) * strain;
  std::printf("P(0,0) = %.9g Pa, small-strain theory says %.9g Pa\n", P(0, 0), expected);
  return std::abs(P(0, 0) / expected - 1) < 1e-4 ? 0 : 1;
}
