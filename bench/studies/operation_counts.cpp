// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

// How many floating-point operations one force evaluation takes, beside Goulette & Chen 2015, Table 5, and
// d'Aulignac 2001, Tables 2.1 and 2.3. Nothing is counted by hand: the library's own kernels run on a scalar
// that keeps a record (counting_scalar.hpp), between a gather and a scatter like those of `Elements`.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "counting_scalar.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/mesh/edges.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/potential/edge_lengths.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/potential/mass_tensor.hpp"
#include "softsim/potential/spring.hpp"

namespace {

using namespace softsim;
using studies::Counting;
using studies::Operations;
using studies::Tape;
using studies::tape;

// Table 5 of Goulette & Chen 2015, in operations.
constexpr double table5_mass_tensor = 2999e3, table5_heml = 70e3;
constexpr int table5_tetrahedra = 320;
// "Internal Forces", running total, of d'Aulignac 2001: Table 2.3 (one tetrahedron, Green strain and second
// Piola-Kirchhoff stress) and Table 2.1 (one spring with its damper).
constexpr long daulignac_tetrahedron = 560, daulignac_spring = 34;

/// The paper's cube: 4 x 4 x 4 cells of five tetrahedra, mirrored from cell to cell: 125 nodes, 320
/// tetrahedra.
TetrahedralMesh paper_cube() {
  constexpr int n = 4;
  std::vector<Vec3<double>> points;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.push_back(Vec3<double>(i, j, k) / n);
  std::vector<Tetrahedron> tetrahedra;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const bool mirrored = (i + j + k) % 2 == 1;
        const auto corner = [&](int a, int b, int c) {
          return static_cast<std::int32_t>(((k + c) * (n + 1) + j + b) * (n + 1) + i +
                                           (mirrored ? 1 - a : a));
        };
        const std::int32_t p = corner(0, 0, 0), q = corner(1, 1, 0), r = corner(1, 0, 1), s = corner(0, 1, 1);
        for (Tetrahedron t : {Tetrahedron{p, q, r, s}, Tetrahedron{corner(1, 0, 0), p, q, r},
                              Tetrahedron{corner(0, 1, 0), p, q, s}, Tetrahedron{corner(0, 0, 1), p, r, s},
                              Tetrahedron{corner(1, 1, 1), q, r, s}}) {
          const auto at = [&](std::size_t c) { return points[static_cast<std::size_t>(t[c])]; };
          if ((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) < 0) std::swap(t[2], t[3]);
          tetrahedra.push_back(t);
        }
      }
  return TetrahedralMesh(std::move(points), std::move(tetrahedra));
}

/// What one kernel takes for one stencil.
struct Count {
  Operations kernel;  ///< the force of the stencil from its (relative) unknowns
  long everything;    ///< with gather, balance and scatter
  long written;       ///< the kernel as the source has it, repeated and unused operations included
  double error;       ///< of its force against the same kernel on double, relative to the largest component
};

template <class E>
constexpr bool is_relative = requires {
  requires E::translation_invariant;
};
template <class E>
constexpr bool is_of_positions = requires {
  requires E::from_positions;
};

/// Runs E's force on a stencil with rest positions X and displacements u, as `Elements` does: points relative
/// to point 0, whose own force is minus the sum of the others, if a translation changes nothing.
template <class E>
Count count(const E& model, const typename E::template Data<double>& rest,
            const std::array<Vec3<double>, E::points>& X, const std::array<Vec3<double>, E::points>& u) {
  constexpr std::size_t points = E::points, numbers = sizeof(rest) / sizeof(double);
  typename E::template Data<Counting> data;
  static_assert(sizeof(data) == numbers * sizeof(Counting));

  tape().clear();
  std::array<double, numbers> values;
  std::memcpy(values.data(), static_cast<const void*>(&rest), sizeof(rest));
  std::array<Counting, numbers> variables;
  for (std::size_t k = 0; k < numbers; ++k) variables[k] = Counting::variable(values[k]);
  std::memcpy(static_cast<void*>(&data), variables.data(), sizeof(data));
  const auto variable = [](const Vec3<double>& x) {
    return Vec3<Counting>(Counting::variable(x[0]), Counting::variable(x[1]), Counting::variable(x[2]));
  };

  std::array<Vec3<double>, points> from = u;
  std::array<Vec3<Counting>, points> y, at;
  for (std::size_t i = 0; i < points; ++i) {
    if constexpr (is_of_positions<E>) from[i] += X[i];
    at[i] = variable(from[i]);
    y[i] = variable(Vec3<double>::Zero());
  }
  Local<Counting, E::points> gathered;
  Local<double, E::points> plain;
  for (std::size_t i = 0; i < points; ++i) {
    gathered.points[i] = at[i];
    plain.points[i] = from[i];
    if constexpr (is_relative<E>) {
      plain.points[i] -= from[0];
      for (int a = 0; a < 3; ++a)
        gathered.points[i][a] = i == 0 ? Counting(0) : Counting(at[i][a] - at[0][a]);
    }
  }
  const auto f = model.gradient(data, gathered);
  const Eigen::Matrix<double, 3 * E::points, 1> reference = model.gradient(rest, plain);

  Count result{};
  std::vector<Tape::Id> ends, arguments;
  constexpr std::size_t first = is_relative<E> ? 1 : 0;
  for (std::size_t i = first; i < points; ++i)
    for (int a = 0; a < 3; ++a) ends.push_back(f[3 * static_cast<int>(i) + a].id);
  for (int k = 3 * static_cast<int>(first); k < 3 * E::points; ++k)
    result.error = std::max(result.error, std::abs(f[k].value - reference[k]));
  result.error /= reference.cwiseAbs().maxCoeff();

  // The gather's differences are operations of the gather, not of the kernel.
  const Operations with_gather = tape().needed_for(ends);
  for (const auto& p : gathered.points)
    for (int a = 0; a < 3; ++a) arguments.push_back(p[a].id);
  const Operations gather = tape().needed_for(arguments);
  result.kernel = with_gather;
  result.kernel.additions -= gather.additions;
  result.written = tape().written() - gather.additions;

  Vec3<Counting> sum(Counting(0), Counting(0), Counting(0));
  ends.clear();
  for (std::size_t i = first; i < points; ++i)
    for (int a = 0; a < 3; ++a) {
      const Counting part = f[3 * static_cast<int>(i) + a];
      y[i][a] += part;
      ends.push_back(y[i][a].id);
      if constexpr (is_relative<E>) sum[a] -= part;
    }
  if constexpr (is_relative<E>)
    for (int a = 0; a < 3; ++a) ends.push_back(Counting(y[0][a] + sum[a]).id);
  result.everything = tape().needed_for(ends).total();
  return result;
}

/// Mass tensors summed up at the nodes (Goulette & Chen 2015, Eq. 42), one term of each sum as it stands
/// there, for what Table 5 counts. Operations of one term.
struct NodalTerms {
  long B, C, D;
};
NodalTerms nodal_terms() {
  const auto vector = [] {
    return Vec3<Counting>(Counting::variable(1), Counting::variable(2), Counting::variable(3));
  };
  const auto operations = [](auto term) {
    const long before = tape().written();
    term();
    return tape().written() - before;
  };
  tape().clear();
  const Vec3<Counting> Uj = vector(), Uk = vector(), Ul = vector(), Cjkp = vector(), Cpjk = vector();
  Vec3<Counting> F = vector();
  const Counting D = Counting::variable(4);
  Mat3<Counting> B;
  for (int i = 0; i < 9; ++i) B(i) = Counting::variable(5);
  return {operations([&] { F += B * Uj; }), operations([&] {
            const Mat3<Counting> outer = Uk * Uj.transpose();
            const Vec3<Counting> product = outer * Cjkp, twice = Counting(2) * product;
            F += twice;
            const Counting dot = Uj.dot(Uk);
            F += dot * Cpjk;
          }),
          operations([&] {
            const Counting c = D * Uk.dot(Uj);
            F += c * Ul;
          })};
}

/// Numbers of terms in the sums of Eq. 42 on a mesh: over all of {p, N(p)}^n, and those whose tensor is not
/// zero because one tetrahedron holds all of its nodes.
struct NodalSums {
  long pairs = 0, triples = 0, quadruples = 0, nonzero_triples = 0, nonzero_quadruples = 0;
};
NodalSums nodal_sums(const TetrahedralMesh& mesh) {
  std::vector<std::set<std::int32_t>> star(mesh.points().size());
  std::set<std::array<std::int32_t, 3>> triples;
  std::set<std::array<std::int32_t, 4>> quadruples;
  for (const Tetrahedron& t : mesh.tetrahedra())
    for (const std::int32_t p : t)
      for (const std::int32_t j : t) {
        star[static_cast<std::size_t>(p)].insert(j);
        for (const std::int32_t k : t) {
          triples.insert({p, j, k});
          for (const std::int32_t l : t) quadruples.insert({p, j, k, l});
        }
      }
  NodalSums n;
  for (const auto& s : star) {
    const long size = static_cast<long>(s.size());
    n.pairs += size;
    n.triples += size * size;
    n.quadruples += size * size * size;
  }
  n.nonzero_triples = static_cast<long>(triples.size());
  n.nonzero_quadruples = static_cast<long>(quadruples.size());
  return n;
}

class Report {
 public:
  explicit Report(const std::string& path) : csv_(path) {
    if (!csv_) throw std::invalid_argument(path + ": cannot be written");
    csv_ << "kernel,law,per,additions,multiplications,divisions,square_roots,functions,kernel_operations,"
            "with_gather_and_scatter,as_written,cube_thousand\n";
    std::printf("%-14s %-20s %5s %5s %4s %5s %5s %7s %9s %8s %12s\n", "kernel", "law", "add", "mul", "div",
                "sqrt", "func", "kernel", "+gather,", "as", "paper's cube");
    std::printf("%-14s %-20s %5s %5s %4s %5s %5s %7s %9s %8s %12s\n", "", "", "", "", "", "", "", "total",
                "scatter", "written", "(thousand)");
  }
  void line(const std::string& kernel, const std::string& law, const Count& c, long stencils, long per_node) {
    const double cube = static_cast<double>(c.everything * stencils + per_node) / 1000;
    const Operations& n = c.kernel;
    const char* per = stencils == table5_tetrahedra ? "tetrahedron" : "edge";
    std::printf("%-14s %-20s %5ld %5ld %4ld %5ld %5ld %7ld %9ld %8ld %12.1f\n", kernel.c_str(), law.c_str(),
                n.additions, n.multiplications, n.divisions, n.square_roots, n.functions, n.total(),
                c.everything, c.written, cube);
    csv_ << kernel << ',' << law << ',' << per << ',' << n.additions << ',' << n.multiplications << ','
         << n.divisions << ',' << n.square_roots << ',' << n.functions << ',' << n.total() << ','
         << c.everything << ',' << c.written << ',' << cube << '\n';
  }
  /// A row from the literature: only what is printed there is filled in.
  void cited(const std::string& source, const std::string& law, const std::string& per, long operations,
             const std::string& cube) {
    csv_ << source << ',' << law << ',' << per << ",,,,,," << operations << ",,," << cube << '\n';
  }

 private:
  std::ofstream csv_;
};

int failures = 0;
void claim(bool holds, const char* sentence) {
  if (!holds) ++failures;
  std::printf("%s: %s\n", holds ? "holds" : "VIOLATED", sentence);
}

int run(const std::string& folder) {
  std::filesystem::create_directories(folder);
  Report report(folder + "/operation_counts.csv");

  const TetrahedralMesh cube = paper_cube();
  const long nodes = static_cast<long>(cube.points().size()),
             tetrahedra = static_cast<long>(cube.tetrahedra().size());
  const long edges = static_cast<long>(mesh_edges(cube).edges.size());

  // Any tetrahedron that has no zeros in it, at 10 to 20 % strain.
  const std::array<Vec3<double>, 4> X{{{0.1, 0.2, 0.3}, {1.2, 0.1, 0.2}, {0.3, 1.1, 0.4}, {0.2, 0.4, 1.3}}};
  const std::array<Vec3<double>, 4> u{
      {{0.02, 0.03, -0.01}, {0.15, -0.04, 0.05}, {-0.06, 0.11, 0.03}, {0.04, 0.05, -0.12}}};
  const auto rest = LinearTetrahedron::make(X);
  const double E = 1e4, nu = 0.4;
  double worst = 0;
  const auto tell = [&](const char* kernel, const char* law, const auto& model, const auto& data) {
    using Model = std::remove_cvref_t<decltype(model)>;
    const Count c = count(model, data, X, u);
    // positions are rest + displacement, made once for all nodes
    report.line(kernel, law, c, tetrahedra, is_of_positions<Model> ? 3 * nodes : 0);
    worst = std::max(worst, c.error);
    return c;
  };
  const auto all_routes = [&](const char* name, const auto& law) {
    using Law = std::remove_cvref_t<decltype(law)>;
    const std::array<Count, 3> c{
        tell("heml", name, Heml<Law>{law}, Heml<Law>::make(rest)),
        tell("edge_lengths", name, EdgeLengths<Law>{law}, EdgeLengths<Law>::make(rest)),
        tell("elastic", name, Elastic<LinearTetrahedron, Law>{law}, rest)};
    return c;
  };

  const auto svk = all_routes("svk", StVenantKirchhoff::from_young_poisson(E, nu));
  const auto nh = all_routes("neo_hookean", NeoHookean::from_young_poisson(E, nu));
  const auto snh = all_routes("stable_neo_hookean", StableNeoHookean::from_young_poisson(E, nu));
  const auto mr = all_routes("mooney_rivlin", MooneyRivlin::from_young_poisson(E, nu, 0.5));
  const Lame lame = Lame::from_young_poisson(E, nu);
  const Count tensor = tell("mass_tensor", "svk", MassTensor{}, MassTensor::make(rest, lame));
  tell("mass_tensor", "linear", LinearMassTensor{}, LinearMassTensor::make(rest, lame));
  tell("elastic", "corotational",
       Elastic<LinearTetrahedron, Corotational>{Corotational::from_young_poisson(E, nu)}, rest);
  const Count spring = count(Spring{}, SpringLink::make(X[0], X[1], 10), {X[0], X[1]}, {u[0], u[1]});
  worst = std::max(worst, spring.error);
  report.line("spring", "hooke (per edge)", spring, edges, 0);

  const NodalTerms term = nodal_terms();
  const NodalSums sum = nodal_sums(cube);
  const long full = term.B * sum.pairs + term.C * sum.triples + term.D * sum.quadruples;
  const long sparse = term.B * sum.pairs + term.C * sum.nonzero_triples + term.D * sum.nonzero_quadruples;
  report.cited("mass_tensor_at_nodes", "svk", "tetrahedron", full / tetrahedra,
               to_text(static_cast<double>(full) / 1000));
  report.cited("mass_tensor_at_nodes_without_zeros", "svk", "tetrahedron", sparse / tetrahedra,
               to_text(static_cast<double>(sparse) / 1000));
  report.cited("table5_mass_tensor", "svk", "tetrahedron",
               std::lround(table5_mass_tensor / table5_tetrahedra), "2999");
  report.cited("table5_heml", "svk", "tetrahedron", std::lround(table5_heml / table5_tetrahedra), "70");
  report.cited("daulignac_tetrahedron", "svk", "tetrahedron", daulignac_tetrahedron, "");
  report.cited("daulignac_spring", "hooke with damper", "edge", daulignac_spring, "");

  const auto thousand = [](long n) { return static_cast<double>(n) / 1000; };
  const auto gain = [&](const Count& c) {
    return table5_mass_tensor / static_cast<double>(c.everything * tetrahedra + 3 * nodes);
  };
  std::printf(
      "\nCounted are the distinct operations that the forces depend on (IEEE, a fused multiply-add is two).\n"
      "Gather: points less point 0; scatter: the force on point 0 as minus the sum of the others, and the\n"
      "additions to the nodes. A logarithm or an inverse cube root is one function, whatever it costs.\n"
      "Cube: %ld nodes, %ld tetrahedra, %ld edges; 3 additions a node where positions are needed.\n\n",
      nodes, tetrahedra, edges);
  std::printf(
      "Goulette & Chen 2015, Table 5: mass tensor 2999 thousand, HEML 70 thousand (%.0f a tetrahedron);\n"
      "  their ratio is %.1f (43.0 printed).\n",
      table5_heml / table5_tetrahedra, table5_mass_tensor / table5_heml);
  std::printf(
      "Their Eq. 42 term by term (%ld, %ld, %ld operations) over all of {p, N(p)}: %.1f thousand;\n"
      "  %.0f %% of its tensors D are zero: without them %.1f thousand; element by element %.1f thousand.\n",
      term.B, term.C, term.D, thousand(full),
      100 * (1 - static_cast<double>(sum.nonzero_quadruples) / static_cast<double>(sum.quadruples)),
      thousand(sparse), thousand(tensor.everything * tetrahedra));
  std::printf(
      "Here, SVK: six lengths %ld, edge metric %ld operations a tetrahedron with gather and scatter: "
      "against\n"
      "  2999 thousand a gain of %.1f and %.1f, against the same mass tensor without its zeros %.1f and "
      "%.1f.\n",
      svk[1].everything, svk[0].everything, gain(svk[1]), gain(svk[0]),
      gain(svk[1]) * static_cast<double>(sparse) / table5_mass_tensor,
      gain(svk[0]) * static_cast<double>(sparse) / table5_mass_tensor);
  std::printf(
      "d'Aulignac 2001 counts additions, multiplications, divisions and roots up to the internal forces,\n"
      "  each stage reusing the ones before: %ld a tetrahedron (Table 2.3; here by F: %ld), %ld a spring "
      "with\n"
      "  damper, 25 without (Table 2.1; here %ld).\n\n",
      daulignac_tetrahedron, svk[2].everything, daulignac_spring, spring.everything);

  claim(nodes == 125 && tetrahedra == table5_tetrahedra, "the cube has 125 nodes and 320 tetrahedra");
  claim(worst < 1e-13, "the counted kernels give the forces of the plain ones");
  claim(std::abs(static_cast<double>(full) - table5_mass_tensor) < 500,
        "Table 5's 2999 thousand are Eq. 42 with all its zeros");
  bool metric_least = true, alike = true;
  for (const auto& routes : {svk, nh, snh, mr}) {
    metric_least = metric_least && routes[0].kernel.total() < routes[1].kernel.total() &&
                   routes[0].kernel.total() < routes[2].kernel.total();
    alike = alike && gain(routes[0]) > 30 && gain(routes[0]) < 70;
  }
  claim(metric_least, "the edge metric needs fewer operations than six lengths and than F, for every law");
  claim(alike, "the laws are alike, 30 to 70 times fewer operations than Table 5's mass tensor");
  claim(gain(svk[0]) > table5_mass_tensor / table5_heml,
        "the edge metric (SVK) stays below Table 5's 70 thousand");
  claim(std::abs(table5_mass_tensor / table5_heml / gain(svk[1]) - 1) < 0.1,
        "six lengths (SVK) are within 10 % of Table 5's 70 thousand");
  claim(svk[0].everything < daulignac_tetrahedron && svk[2].everything < daulignac_tetrahedron,
        "both routes stay below Table 2.3");
  return failures == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc > 2) throw std::invalid_argument("usage: study_operation_counts [FOLDER]");
    return run(argc > 1 ? argv[1] : "out/studies");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "operation_counts: %s\n", error.what());
    return 2;
  }
}
