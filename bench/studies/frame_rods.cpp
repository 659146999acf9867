// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "frame_rods.hpp"

#include <cmath>
#include <cstdio>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "softsim/material/st_venant_kirchhoff.hpp"
#include "study.hpp"

// Rods of one row of frames that bend and twist far, against the number of frames. Weights linear along the
// row, with one section of samples between two frames or two, with half arms (LinkedShapes), and Shepard's.
// Errors are distances of the tip over the length of the rod.

namespace {

using namespace frame_rods;

const std::vector<Method> methods{{"linear_1_section", Blend::linear, 1},
                                  {"linear_2_sections", Blend::linear, 2},
                                  {"linked_1_section", Blend::linked, 1},
                                  {"linked_2_sections", Blend::linked, 2},
                                  {"shepard_4_sections", Blend::shepard, 4}};

using Frames = std::vector<int>;
using Error = std::function<double(const Method&, int)>;

void line(std::ostream& csv, const std::string& problem, const char* method, int frames, const char* quantity,
          double value, double reference, double error, double rate = NAN) {
  csv << problem << ',' << method << ',' << frames << ',' << quantity << ',' << value << ',';
  if (std::isfinite(reference)) csv << reference;
  csv << ',' << error << ',';
  if (std::isfinite(rate)) csv << rate;
  csv << std::endl;
}

// Errors against the number of frames, which doubles the gaps: all of one method.
std::vector<double> sweep(std::ostream& csv, const std::string& problem, const Method& method,
                          const Frames& frames, const Error& error) {
  std::vector<double> errors;
  for (const int n : frames) {
    errors.push_back(error(method, n));
    const double rate = errors.size() < 2 ? NAN : std::log2(errors[errors.size() - 2] / errors.back());
    line(csv, problem, method.name, n, "tip_error_over_length", errors.back(), NAN, errors.back(), rate);
  }
  return errors;
}

// All methods. With one section, linked or not, the order is 2 until what is left of the rod's thickness
// shows, and the error ends below `tolerance`; linear weights with two sections lock.
bool converges(std::ostream& csv, const std::string& problem, const Frames& frames, double tolerance,
               const Error& error) {
  std::vector<std::vector<double>> errors;
  std::printf("%s, %d frames:", problem.c_str(), frames.back());
  for (const Method& method : methods) {
    errors.push_back(sweep(csv, problem, method, frames, error));
    std::printf(" %s %.3g;", method.name, errors.back().back());
  }
  std::printf("\n");
  const auto order = [&](std::size_t method) { return std::log2(errors[method][0] / errors[method][1]); };
  return order(0) > 1.7 && order(2) > 1.7 && errors[0].back() < tolerance && errors[2].back() < tolerance &&
         errors[3].back() < tolerance && errors[1].back() > 20 * errors[0].back();
}

bool bends_as_predicted(std::ostream& csv) {
  bool holds = true;
  for (const Method& method : methods)
    for (const int n : {5, 9, 17, 33, 65, 129}) {
      const double value = small_deflection(method, n), predicted = predicted_small_deflection(method, n);
      const bool known = method.blend != Blend::shepard;
      line(csv, "small_deflection", method.name, n, "tip_deflection_over_beam", value,
           known ? predicted : NAN, value - 1);
      holds = holds && (!known || std::abs(value / predicted - 1) < 1e-4);
    }
  return holds;
}

bool twists_as_predicted(std::ostream& csv) {
  double worst = 0;
  for (const int n : {4, 10, 19}) {
    const double theta = std::numbers::pi / (n - 1), expected = std::pow(std::cos(theta / 2), 2);
    const std::vector<double> J = torsion(n, 5);
    if (J.empty()) return false;
    for (const double j : J) worst = std::max(worst, std::abs(j - expected));
    line(csv, "torsion", "linear_5_sections", n, "J_at_mid_gap", J.front(), expected, J.front() - expected);
  }
  std::printf("torsion by half a turn: J in the middles of the gaps is cos^2(theta/2) within %.1g\n", worst);
  return worst < 1e-9;
}

// An isotropic law takes the shrinking of the sections for strain, Rod does not.
bool sections_lock(std::ostream& csv) {
  constexpr double side = 0.1, moment = 2 * std::numbers::pi * ring_stiffness / ring_length;
  const double E = 12 * ring_stiffness / std::pow(side, 4);
  const auto law = softsim::StVenantKirchhoff::from_young_poisson(E, 0);
  double error = 0;
  for (const int n : {9, 17, 33, 65}) {
    const Rod rod(straight(n, ring_length), side, methods[0]);
    const Tip tip = under_moment(rod, softsim::elastic(rod.body, law), moment, 20);
    error = (tip.u - Vec(-ring_length, 0, 0)).norm() / ring_length;
    line(csv, "roll_up_isotropic", methods[0].name, n, "tip_error_over_length", error, NAN, error);
  }
  std::printf("roll-up with St. Venant-Kirchhoff, L/t = 100, 65 frames: %.3g\n", error);
  return std::isfinite(error);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "problem,method,frames,quantity,value,reference,error,rate";
  return study::run(argc, argv, "frame_rods", header, false, [](std::ostream& csv, bool) {
    csv.precision(8);
    const Frames all{5, 9, 17, 33, 65}, fine{17, 33, 65};
    bool holds = converges(csv, "roll_up", fine, 0.005, roll_up);
    for (const Bend& bend : bends)
      holds = converges(csv, "bend_45_force_" + std::to_string(static_cast<int>(bend.force)), all, 0.001,
                        [&](const Method& method, int n) { return bend_45(method, n, bend); }) &&
              holds;
    for (const bool uniform : {false, true})
      for (const Elastica& goal : uniform ? uniform_loads : tip_loads)
        holds = converges(csv,
                          std::string("elastica_") + (uniform ? "uniform_" : "tip_") +
                              std::to_string(static_cast<int>(goal.load)),
                          all, 0.001,
                          [&](const Method& method, int n) { return elastica(method, n, goal, uniform); }) &&
                holds;
    holds = bends_as_predicted(csv) && holds;
    holds = sections_lock(csv) && holds;
    return twists_as_predicted(csv) && holds;
  });
}
