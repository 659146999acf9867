// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>

#include "oscillator.hpp"
#include "program.hpp"

// Stability regions: how much a damped oscillator grows in one step of every integrator, by its stability
// function and as it is simulated, over the plane of z = h lambda; and the rows of d'Aulignac's Table 3.3.

namespace {

using namespace atlas;
using std::string;

struct Largest {
  double difference = 0, at_re = 0, at_im = 0;
  int count = 0;
  void take(double predicted, double measured, double re, double im) {
    ++count;
    const double d = std::abs(predicted - measured) / std::max(1.0, predicted);
    if (d <= difference) return;
    difference = d;
    at_re = re;
    at_im = im;
  }
};

// Order of a method from how its slow root differs from exp(z), z = -Omega/2, at two small z.
template <class I>
int order_of(Oscillator& body, const I& integrator) {
  const auto error = [&](double Omega) {
    return std::abs(measured_growth(body, integrator, Omega, 1.25) - std::exp(-Omega / 2));
  };
  const double slope = std::log2(error(0.2) / error(0.1));
  return static_cast<int>(std::lround(slope)) - 1;
}

void check_regions(const Arguments& arguments, Claims& claims) {
  Table csv(arguments, "regions", "method,kind,re,im,predicted,measured");
  Table summary(arguments, "regions_summary",
                "method,points,largest_difference,at_re,at_im,largest_off_double_roots,"
                "real_pair_difference,left_half_plane,at_minus_1e6,order");
  const double spacing = arguments.short_form ? 0.25 : 0.05;
  Oscillator body;
  std::puts("method                 points  max diff   off double  real pairs   sup left   z=-1e6  order");
  for_each_integrator<LinearSystem>([&](const string& name, auto integrator, bool is_explicit) {
    const double widest = is_explicit ? 1 : 4;  // implicit regions are of another size
    Largest pairs, plain, real;
    const auto compare = [&](double Omega, double xi, double re, double im, const char* kind) {
      const double predicted = integrator.spectral_radius(Omega, xi);
      const double measured = measured_growth(body, integrator, Omega, xi);
      csv << name << ',' << kind << ',' << re << ',' << im << ',' << predicted << ',' << measured << '\n';
      return std::pair(predicted, measured);
    };
    const int columns = static_cast<int>(std::lround(5 / spacing)),
              rows = static_cast<int>(std::lround(4 / spacing));
    for (int i = 0; i <= columns; ++i)
      for (int j = 0; j <= rows; ++j) {
        const double re = widest * (-4 + i * spacing), im = widest * j * spacing;
        const std::complex<double> z(re, im);
        const double Omega = std::abs(z);
        if (Omega < 1e-9 || (im == 0 && re > 0)) continue;
        if (!is_explicit && re > 0) continue;  // poles, which make a step of no use
        const auto [predicted, measured] = compare(Omega, -re / Omega, re, im, "pair");
        pairs.take(predicted, measured, re, im);
        // Beside a double root, as the oscillator has on the real axis, a rounding error e moves it by
        // sqrt(e).
        const double moved = integrator.spectral_radius(Omega, -re / Omega * (1 - 1e-7) + 1e-9);
        if (im > 0 && std::abs(moved - predicted) < 1e-6) plain.take(predicted, measured, re, im);
      }
    for (int i = 0; i <= 40; ++i) {
      const double Omega = std::pow(10.0, -1.5 + i / 20.0 * (is_explicit ? 1 : 1.5));
      for (const double xi : {1.01, 1.5, 3.0, 10.0}) {
        const double slow = -Omega / (xi + std::sqrt(xi * xi - 1)), fast = Omega * Omega / slow;
        const auto [predicted, measured] = compare(Omega, xi, slow, fast, "real");
        real.take(predicted, measured, slow, fast);
      }
    }
    // A-stable: nothing in the left half plane grows. The border is where the largest value is.
    double supremum = 0;
    for (int i = 0; i <= 160; ++i)
      for (const double xi : {0.0, 1e-3, 0.01, 0.1, 0.3, 0.6, 0.9, 1.0, 2.0, 10.0})
        supremum = std::max(supremum, integrator.spectral_radius(std::pow(10.0, -2 + i / 20.0), xi));
    // both roots at -1e6 with xi = 1
    const double far = measured_growth(body, integrator, 1e6, 1);
    const double far_predicted = integrator.spectral_radius(1e6, 1);
    const int order = order_of(body, integrator);
    std::printf("%-22s %6d  %.1e   %.1e    %.1e   %9.3g %9.3g  %d\n", name.c_str(), pairs.count,
                pairs.difference, plain.difference, real.difference, supremum, far, order);
    summary << name << ',' << pairs.count << ',' << pairs.difference << ',' << pairs.at_re << ','
            << pairs.at_im << ',' << plain.difference << ',' << real.difference << ',' << supremum << ','
            << far << ',' << order << '\n';
    claims.check(plain.difference < 1e-8, name + ": growth differs from prediction off double roots");
    claims.check(pairs.difference < 1e-4, name + ": growth differs from prediction");
    claims.check(real.difference < 1e-6, name + ": growth of real pairs differs from prediction");
    claims.check(is_explicit || std::abs(far - far_predicted) < 1e-3 * std::max(1.0, far_predicted),
                 name + ": growth at z = -1e6 differs from prediction");
  });
}

// A motion of any length is stable where the prediction is a percent below 1, and grows a percent above it.
void check_long_runs(const Arguments& arguments, Claims& claims) {
  Table csv(arguments, "regions_long_runs", "method,xi,Omega,predicted,grown");
  Oscillator body;
  int right = 0, all = 0;
  for_each_integrator<LinearSystem>([&](const string& name, auto integrator, bool is_explicit) {
    const int steps = arguments.short_form ? 400 : 4000;
    for (const double xi : {0.0, 0.05, 0.3, 0.8})
      for (int i = 1; i <= 24; ++i) {
        const double Omega = (is_explicit ? 0.15 : 1.5) * i;
        const double predicted = integrator.spectral_radius(Omega, xi);
        if (std::abs(predicted - 1) < 0.01) continue;
        const double grown = growth_of_long_run(body, integrator, Omega, xi, predicted > 1 ? 200 : steps);
        csv << name << ',' << xi << ',' << Omega << ',' << predicted << ',' << grown << '\n';
        ++all;
        right += predicted > 1 ? grown > 1 : grown < 1;
      }
  });
  std::printf("long runs: %d of %d grow or decay as predicted\n", right, all);
  claims.check(right == all, "a long run grows or decays against the prediction");
}

void check_contraction(const Arguments& arguments, Claims& claims) {
  using namespace softsim;
  using S = ContractiveBody::S;
  Table csv(arguments, "b_stability", "method,pairs,largest_growth,step,u_a,w_a,u_b,w_b");
  const ContractiveBody body;
  const int pairs = arguments.short_form ? 2000 : 100000;
  const auto check = [&](const string& name, auto integrator, bool contractive) {
    const Contraction worst = contraction(body, integrator, pairs);
    csv << name << ',' << pairs << ',' << worst.growth << ',' << worst.step << ',' << worst.a.u << ','
        << worst.a.w << ',' << worst.b.u << ',' << worst.b.w << '\n';
    std::printf("distance of two motions, %-28s at most x %.6f in a step (h = %.3g s)\n", name.c_str(),
                worst.growth, worst.step);
    // pairs are at least 1e-6 apart, steps exact to 1e-13
    if (contractive) claims.check(worst.growth <= 1 + 1e-6, name + " is not contractive");
    if (!contractive) claims.check(worst.growth > 1.001, name + " was seen to be contractive");
  };
  const auto options = [](auto scheme, bool newton) {
    return ImplicitOptions<decltype(scheme)>{.dt = 1, .scheme = scheme, .newton = newton, .tolerance = 1e-13};
  };
  check("backward Euler", BackwardEuler<S>(options(Theta(), true)), true);
  check("implicit midpoint", ImplicitMidpoint<S>(options(Midpoint(), true)), true);
  check("theta 0.7", Implicit<Theta, S>(options(Theta{0.7}, true)), true);
  check("trapezoidal", Implicit<Trapezoidal, S>(options(Trapezoidal(), true)), false);
  check("backward Euler, linearised", BackwardEuler<S>(options(Theta(), false)), false);
  check("implicit midpoint, linearised", ImplicitMidpoint<S>(options(Midpoint(), false)), false);
  check("explicit Euler", ExplicitEuler<S>({.dt = 1}), false);
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, [](const Arguments& arguments, Claims& claims) {
    check_regions(arguments, claims);
    check_long_runs(arguments, claims);
    check_contraction(arguments, claims);
  });
}
