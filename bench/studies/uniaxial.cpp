// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ostream>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/dual.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/system/system.hpp"
#include "study.hpp"

// Goulette & Chen 2015, Sec. 5.1 and Fig. 6: force against stretch of a cube of 1 m whose sides are free, for
// three laws, with `elastic` and with `heml`, against closed forms. E = 10 Pa, nu = 0.3. The state is
// homogeneous and linear tetrahedra hold it exactly, so that the solver's tolerance is all that is left.

namespace {

using namespace softsim;

constexpr double nu = 0.3, lambda = 10 * nu / (1.3 * 0.4), mu = 10 / 2.6, bulk = lambda + 2 * mu / 3;
constexpr double c1 = 0.4 * mu, c2 = 0.1 * mu;

// dw/ds and dw/dl of the energy density at the stretches s, l, l, Pa or a multiple of it: first
// Piola-Kirchhoff stresses.
template <class T>
struct Stress {
  T axial, lateral;
};
struct NeoHookeanForm {
  template <class T>
  Stress<T> operator()(const T& s, const T& l) const {
    using std::log;
    const T pressure = T(lambda) * log(s * l * l);
    return {T(mu) * (s - T(1) / s) + pressure / s, T(mu) * (l - T(1) / l) + pressure / l};
  }
};
struct MooneyRivlinForm {
  template <class T>
  Stress<T> operator()(const T& s, const T& l) const {
    using std::pow;
    const T J = s * l * l, k1 = pow(J, -2.0 / 3), k2 = k1 * k1, p = T(bulk) * (J - T(1));
    const T i1 = k1 * (s * s + T(2) * l * l), i2 = k2 * (T(2) * s * s + l * l) * l * l;
    return {T(c1) * (T(2) * k1 * s - T(2.0 / 3) * i1 / s) +
                T(c2) * (T(4) * k2 * s * l * l - T(4.0 / 3) * i2 / s) + p * l * l,
            T(c1) * (T(4) * k1 * l - T(4.0 / 3) * i1 / l) +
                T(c2) * (T(4) * k2 * (s * s + l * l) * l - T(8.0 / 3) * i2 / l) + T(2) * p * s * l};
  }
};

struct Point {
  double force, lateral;  // N on 1 m^2, lateral stretch
};

// The lateral stretch that leaves the sides free of stress, by Newton's method from `lateral`, and the force.
template <class Form>
Point closed_form(const Form& form, double s, double lateral) {
  using D = Dual<double, 1>;
  for (int k = 0; k < 50; ++k) {
    const D across = form(D(s), D::variable(lateral, 0)).lateral;
    const double step = across.value / across.derivative[0];
    lateral -= step;
    if (std::abs(step) < 1e-14) return {form(s, lateral).axial, lateral};
  }
  throw std::runtime_error(std::string("no lateral stretch found at stretch ") + std::to_string(s));
}
/// The paper's formula: P = mu (3 lambda + 2 mu) / (2 (lambda + mu)) (s^3 - s).
struct StVenantKirchhoffForm {};
Point closed_form(const StVenantKirchhoffForm&, double s, double) {
  return {mu * (3 * lambda + 2 * mu) / (2 * (lambda + mu)) * (s * s * s - s),
          std::sqrt(1 - nu * (s * s - 1))};
}

// A cube of n x 3 x 3 cells; inner nodes are moved by up to a fifth of a cell, those inside the two loaded
// sides along them.
TetrahedralMesh irregular_cube(int n) {
  const TetrahedralMesh regular = box_mesh({n, 3, 3}, {1, 1, 1});
  std::vector<Vec3<double>> points = regular.points();
  std::mt19937 bits(1);
  for (Vec3<double>& x : points)
    if (x.tail<2>().minCoeff() > 0 && x.tail<2>().maxCoeff() < 1)
      for (int axis = x[0] > 0 && x[0] < 1 ? 0 : 1; axis < 3; ++axis)
        x[axis] += 0.2 / 3 * (static_cast<double>(bits()) / 0x1p31 - 1);
  return {std::move(points), regular.tetrahedra()};
}

// A cube on rollers at x = 0, y = 0 and z = 0, compressed or pulled at x = 1.
template <class Term>
class Cube {
 public:
  Cube(const TetrahedralMesh& mesh, Term term)
      : mesh_(mesh),
        end_(nodes_near(mesh, Side::xmax, 0)),
        side_(nodes_near(mesh, Side::ymax, 0)),
        system_(mesh, std::move(term)),
        q_(mesh.points().size()) {
    for (int axis = 0; axis < 3; ++axis)
      for (const std::int32_t i : nodes_near(mesh, static_cast<Side>(2 * axis), 0))
        system_.prescribed.set(i, axis, 0);
  }
  // Moves on to the stretch s; the force and the mean lateral stretch there.
  Point to(double s) {
    for (const std::int32_t i : end_) system_.prescribed.set(i, 0, s - 1);
    if (s != 1) {  // at rest there is nothing but rounding to bring to zero
      const StepReport report = StaticSolver<System<Term>>({.tolerance = 1e-10}).solve(system_, q_);
      // what leaves the homogeneous state may end inside out; where that must not be, `uneven` shows it
      if (report.status != Status::converged && report.status != Status::inverted)
        throw std::runtime_error(std::string("stretch ") + std::to_string(s) + ": " +
                                 std::string(report.reason));
    }
    Vector<double> g = Vector<double>::Zero(q_.size());
    system_.add_gradient(q_, g);
    Point at{0, 1};
    for (const std::int32_t i : end_) at.force += block(g, i)[0];
    for (const std::int32_t i : side_) at.lateral += q_.point(i)[1] / static_cast<double>(side_.size());
    return at;
  }
  // Largest distance of a node from the homogeneous state, m.
  double uneven(double s, double l) const {
    double worst = 0;
    for (std::size_t i = 0; i < mesh_.points().size(); ++i) {
      const Vec3<double>& X = mesh_.points()[i];
      const Vec3<double> u((s - 1) * X[0], (l - 1) * X[1], (l - 1) * X[2]);
      worst = std::max(worst, (q_.point(static_cast<std::ptrdiff_t>(i)) - u).norm());
    }
    return worst;
  }

 private:
  const TetrahedralMesh& mesh_;
  std::vector<std::int32_t> end_, side_;
  System<Term> system_;
  State<double> q_;
};
// What the study looks at over all laws and routes.
struct Summary {
  std::ostream& csv;
  double error = 0, uneven = 0, row_error = 0;  // relative; m; N or 1
  int rows = 0;
};

// Force and lateral stretch at the stretches n / 40: roots found elsewhere, to ten digits.
struct Row {
  int n;
  Point at;
};
using Rows = std::vector<Row>;

// From one stretch n / 40 to another, state by state. Compares, and returns the forces.
template <class Term, class Form>
std::vector<double> follow(Summary& summary, const std::string& name, const TetrahedralMesh& mesh,
                           const Term& term, const Form& form, const Rows& rows, int from, int to) {
  Cube<Term> cube(mesh, term);
  std::vector<double> forces;
  const int step = to > from ? 1 : -1;
  Point exact{0, 1};
  for (int n = from; n != to + step; n += step) {
    const double s = n / 40.0;
    exact = closed_form(form, s, exact.lateral);
    const Point at = cube.to(s);
    forces.push_back(at.force);
    const double error = std::abs(at.force - exact.force) / (n == 40 ? mu : std::abs(exact.force));
    summary.csv << name << ',' << s << ',' << at.force << ',' << exact.force << ',' << at.lateral << ','
                << error << '\n';
    summary.error = std::max(summary.error, error);
    summary.uneven = std::max(summary.uneven, cube.uneven(s, exact.lateral));
    for (const Row& row : rows)
      if (row.n == n) {
        summary.row_error = std::max({summary.row_error, std::abs(row.at.force - exact.force),
                                      std::abs(row.at.lateral - exact.lateral)});
        ++summary.rows;
      }
  }
  return forces;
}

// Both routes, from the shortest stretch to rest and from there to the longest.
template <class Law, class Form>
void compare(Summary& summary, const std::string& name, const Law& law, const Form& form, const Rows& rows,
             int shortest) {
  const TetrahedralMesh mesh = irregular_cube(3);
  const auto both = [&](const std::string& label, const auto& term) {
    (void)follow(summary, label, mesh, term, form, rows, 40, shortest);
    (void)follow(summary, label, mesh, term, form, rows, 41, 64);
  };
  both(name + ",elastic", elastic(mesh, law));
  both(name + ",heml", heml(mesh, law));
}

// St. Venant-Kirchhoff softens below 1 / sqrt(3), and a cube that is longer than one cell then crushes some
// of its layers and lets the others go. Nodes that are all on the loaded sides cannot, and follow the curve.
bool st_venant_kirchhoff(Summary& summary) {
  const auto law = StVenantKirchhoff::from_young_poisson(10, nu);
  const StVenantKirchhoffForm form;
  const Rows rows{{20, {-1.875, std::sqrt(1.225)}},     {28, {-1.785, std::sqrt(1.153)}},
                  {36, {-0.855, std::sqrt(1.057)}},     {44, {1.155, std::sqrt(0.937)}},
                  {50, {3.515625, std::sqrt(0.83125)}}, {60, {9.375, std::sqrt(0.625)}}};
  compare(summary, "st_venant_kirchhoff", law, form, rows, 24);
  const TetrahedralMesh one = irregular_cube(1);
  bool softens = true;
  const auto below = [&](const std::string& route, const auto& term) {
    const std::vector<double> forces =
        follow(summary, std::string("st_venant_kirchhoff,") + route, one, term, form, rows, 23, 16);
    for (std::size_t i = 1; i < forces.size(); ++i) softens = softens && forces[i] > forces[i - 1];
  };
  below("elastic", elastic(one, law));
  below("heml", heml(one, law));

  const TetrahedralMesh three = irregular_cube(3);
  Cube cube(three, elastic(three, law));
  for (int n = 39; n >= 23; --n) (void)cube.to(n / 40.0);
  const double uneven = cube.uneven(0.575, closed_form(form, 0.575, 1).lateral);
  std::printf(
      "St. Venant-Kirchhoff: the force softens below the stretch 0.577 as it must (%s). A cube of three "
      "cells\n"
      "leaves the homogeneous state there: nodes %.2f m away from it at 0.575.\n",
      softens ? "seen" : "NOT seen", uneven);
  return softens && uneven > 0.01;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "law,route,stretch,force,closed_form,lateral,relative_error";
  return study::run(argc, argv, "uniaxial", header, false, [](std::ostream& csv, bool) {
    Summary summary{csv};
    const bool softens = st_venant_kirchhoff(summary);
    compare(summary, "neo_hookean", NeoHookean::from_young_poisson(10, nu), NeoHookeanForm(),
            {{20, {-9.3535205689, 1.2107673905}},
             {28, {-4.0523042431, 1.1079347328}},
             {36, {-1.0872218514, 1.0317024344}},
             {44, {0.9307743218, 0.9714929459}},
             {60, {3.7828017639, 0.8801745918}}},
            16);
    compare(summary, "mooney_rivlin", MooneyRivlin::from_young_poisson(10, nu, c2 / c1), MooneyRivlinForm(),
            {{20, {-11.8600926545, 1.1073652470}},
             {28, {-4.7096702399, 1.0978546193}},
             {36, {-1.1370062528, 1.0313094682}},
             {44, {0.8943292526, 0.9713688023}},
             {60, {3.2077924344, 0.8813559026}}},
            20);  // several lateral stretches leave the sides free below
    std::printf(
        "Forces: relative error %.1e at most; lateral stretch and every node: %.1e m at most. The closed "
        "forms\n"
        "are %d reference values within %.1e.\n",
        summary.error, summary.uneven, summary.rows, summary.row_error);
    // Newton's tolerance is 1e-10 of the nodal forces, the force's error a small multiple of it; rows have
    // ten digits after the point.
    return softens && summary.error < 1e-8 && summary.uneven < 1e-8 && summary.rows == 32 &&
           summary.row_error < 1e-10;
  });
}
