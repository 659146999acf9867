// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "near_incompressible.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

#include "study.hpp"

// How linear tetrahedra lock, and how much of it is left with the volume averaged at the nodes: two problems,
// two methods and two meshes each (--long: three) over Poisson's ratio; the ratio is to a mixed reference.

namespace {

using namespace near_incompressible;

// Ratios of both methods, the last at nu = 0.4999.
struct Ratios {
  double linear = 0, nodal_smallest = 1, nodal_largest = 1;
};

Ratios sweep(std::ostream& csv, const char* name, const Problem& problem, double Answers::*answer) {
  Ratios ratios;
  const auto line = [&](const char* method, const Answers& reference, double value) {
    const double ratio = value / reference.*answer;
    csv << name << ',' << reference.nu << ',' << method << ',' << problem.mesh.tetrahedra().size() << ','
        << value << ',' << ratio << std::endl;
    return ratio;
  };
  softsim::State<double> plain(problem.mesh.points().size()), nodal = plain;
  for (const Answers& reference : references) {
    ratios.linear = line("linear", reference, solve_plain(problem, plain, reference.nu));
    const double ratio = line("nodal_volume", reference, solve_nodal(problem, nodal, reference.nu));
    ratios.nodal_smallest = std::isfinite(ratio) ? std::min(ratios.nodal_smallest, ratio) : 0;
    ratios.nodal_largest = std::max(ratios.nodal_largest, ratio);
  }
  return ratios;
}

// Coarse to fine; whether plain tetrahedra lock on the finest mesh and those with averaged volumes do not.
template <class Make>
bool locks(std::ostream& csv, const char* name, const std::vector<int>& cells, Make make,
           double Answers::*answer) {
  Ratios finest;
  for (const int n : cells) finest = sweep(csv, name, make(n), answer);
  std::printf(
      "%s, %d cells a side: at nu = 0.4999 linear tetrahedra give %.2f of the answer; with the volume "
      "averaged\n"
      "at the nodes it is %.3f to %.3f of it over nu = 0.3 to 0.4999.\n",
      name, cells.back(), finest.linear, finest.nodal_smallest, finest.nodal_largest);
  return std::isfinite(finest.linear) && !(finest.linear > 0.75 && finest.linear < 1.5) &&
         finest.nodal_smallest > 0.97 && finest.nodal_largest < 1.03;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string header = "problem,nu,method,tetrahedra,answer,ratio";
  return study::run(argc, argv, "near_incompressible", header, true, [](std::ostream& csv, bool long_form) {
    csv.precision(6);
    const std::vector<int> cook = long_form ? std::vector<int>{8, 16, 32} : std::vector<int>{8, 16};
    const std::vector<int> block = long_form ? std::vector<int>{4, 8, 12} : std::vector<int>{4, 8};
    const bool first = locks(csv, "cook", cook, cooks_membrane, &Answers::cook);
    return locks(csv, "block", block, bonded_block, &Answers::block) && first;
  });
}
