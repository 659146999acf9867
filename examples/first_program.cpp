#include <cstdio>
#include <softsim/io/read_mesh.hpp>
#include <softsim/softsim.hpp>

int main(int argc, char** argv) {
  using namespace softsim;
  const TetrahedralMesh mesh = argc > 1 ? read_mesh(argv[1]) : box_mesh({8, 4, 4}, {0.2, 0.1, 0.1});
  const auto law = NeoHookean::from_young_poisson(50e3, 0.4);                     // Pa, -
  System system(mesh, elastic(mesh, law), gravity(mesh, 1000.0, {0, 0, -9.81}));  // kg/m^3, m/s^2
  system.prescribed.fix(nodes_near(mesh, Side::xmin, 0.02));
  State<double> q(mesh.points().size());
  StaticSolver<decltype(system)> solver({.tolerance = 1e-8});
  const StepReport report = solver.solve(system, q);
  std::printf("%s after %d Newton iterations, largest component %g m\n", to_string(report.status).data(),
              report.newton_iterations, q.displacement.cwiseAbs().maxCoeff());
  return report.status == Status::converged ? 0 : 3;
}
