// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
//
// The recipe of organ.msh: a smooth two-lobed implicit surface, shaped roughly like a liver, meshed by CGAL.
// Not part of the library's build. On Debian 12, with libcgal-dev 5.5, libgmp-dev, libmpfr-dev and Boost:
//
//   g++ -std=c++17 -O2 make_organ.cpp -lgmp -lmpfr -o make_organ && ./make_organ organ.msh
//
// The random seed is fixed and no step is limited by time, so the same CGAL gives the same mesh. CGAL's
// meshing headers are under the GPL; that concerns this program once built, not the mesh that it writes.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <map>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
namespace params = CGAL::parameters;

// Metres. x runs from the right lobe to the left lobe, y from front to back, z up.
struct Ellipsoid {
  std::array<double, 3> centre, semi_axes;
  double pitch;  // turn about y, radians; positive lowers the +x end

  // About the signed distance, exact to first order at the surface.
  double operator()(const Point& p) const {
    const double c = std::cos(pitch), s = std::sin(pitch);
    const double dx = p.x() - centre[0], dy = p.y() - centre[1], dz = p.z() - centre[2];
    const std::array<double, 3> local{c * dx - s * dz, dy, s * dx + c * dz};
    double scaled = 0, gradient = 0;
    for (int i = 0; i < 3; ++i) {
      const double u = local[i] / semi_axes[i];
      scaled += u * u;
      gradient += u * u / (semi_axes[i] * semi_axes[i]);
    }
    scaled = std::sqrt(scaled);
    return scaled < 1e-9 ? -*std::min_element(semi_axes.begin(), semi_axes.end())
                         : scaled * (scaled - 1) / std::sqrt(gradient);
  }
};

const Ellipsoid right_lobe{{-0.043, 0.000, 0.000}, {0.067, 0.064, 0.050}, 0.15};
const Ellipsoid left_lobe{{0.045, -0.010, 0.021}, {0.066, 0.044, 0.0215}, 0.22};
const Ellipsoid hollow{{0.020, 0.020, -0.056}, {0.060, 0.060, 0.042}, -0.15};  // where the stomach would lie

// Minimum of a and b, rounded over a distance k.
double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}

double organ(const Point& p) {
  return -smooth_min(-smooth_min(right_lobe(p), left_lobe(p), 0.035), hollow(p), 0.025);
}

double smallest_dihedral(const std::array<Point, 4>& x) {
  double smallest = 180;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const int k = (i != 0 && j != 0) ? 0 : (i != 1 && j != 1) ? 1 : 2;
      const int l = 6 - i - j - k;
      smallest = std::min(smallest, std::abs(CGAL::approximate_dihedral_angle(x[i], x[j], x[k], x[l])));
    }
  }
  return smallest;
}

int main(int argc, char** argv) {
  const char* path = argc > 1 ? argv[1] : "organ.msh";
  CGAL::get_default_random() = CGAL::Random(2026);
  CGAL::Random seed(2026);
  const Domain domain = Domain::create_implicit_mesh_domain(organ, Kernel::Sphere_3(Point(0, 0, 0), 0.04),
                                                            params::relative_error_bound = 1e-7,
                                                            params::p_rng = &seed);
  const double edge = 0.0118;
  const Criteria criteria(params::facet_angle = 30, params::facet_size = edge,
                          params::facet_distance = 0.1 * edge, params::cell_radius_edge_ratio = 2,
                          params::cell_size = edge);
  const Complex mesh = CGAL::make_mesh_3<Complex>(
      domain, criteria, params::odt(params::max_iteration_number = 200),
      params::perturb(params::sliver_bound = 20), params::exude(params::sliver_bound = 20));  // degrees

  std::map<Triangulation::Vertex_handle, int> number;
  std::vector<Point> nodes;
  std::vector<std::array<int, 5>> rows;  // region, four nodes
  double volume = 0, smallest = 1, largest = 0, dihedral = 180;
  for (auto cell = mesh.cells_in_complex_begin(); cell != mesh.cells_in_complex_end(); ++cell) {
    std::array<Point, 4> x;
    std::array<int, 5> row{};
    for (int i = 0; i < 4; ++i) {
      x[i] = cell->vertex(i)->point().point();
      const auto [entry, is_new] = number.try_emplace(cell->vertex(i), static_cast<int>(nodes.size()) + 1);
      if (is_new) nodes.push_back(x[i]);
      row[i + 1] = entry->second;
    }
    const Point middle = CGAL::centroid(x[0], x[1], x[2], x[3]);
    row[0] = right_lobe(middle) < left_lobe(middle) ? 1 : 2;
    rows.push_back(row);
    const double v = CGAL::volume(x[0], x[1], x[2], x[3]);
    volume += v;
    smallest = std::min(smallest, v);
    largest = std::max(largest, v);
    dihedral = std::min(dihedral, smallest_dihedral(x));
  }

  std::ofstream file(path);
  file << std::setprecision(9) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
       << "$PhysicalNames\n2\n3 1 \"right lobe\"\n3 2 \"left lobe\"\n$EndPhysicalNames\n"
       << "$Nodes\n" << nodes.size() << '\n';
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    file << i + 1 << ' ' << nodes[i].x() << ' ' << nodes[i].y() << ' ' << nodes[i].z() << '\n';
  }
  file << "$EndNodes\n$Elements\n" << rows.size() << '\n';
  for (std::size_t e = 0; e < rows.size(); ++e) {
    file << e + 1 << " 4 2 " << rows[e][0] << ' ' << rows[e][0];
    for (int i = 1; i < 5; ++i) file << ' ' << rows[e][i];
    file << '\n';
  }
  file << "$EndElements\n";
  if (!file.flush()) {
    std::fprintf(stderr, "%s: cannot be written\n", path);
    return 1;
  }
  std::printf("%zu tetrahedra, %zu nodes, volume %.4e m^3 (%.2e to %.2e), smallest dihedral angle %.1f deg\n",
              rows.size(), nodes.size(), volume, smallest, largest, dihedral);
}
