// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <getfem/getfem_mesh.h>
#include <getfem/getfem_model_solvers.h>
#include <getfem/getfem_models.h>
#include <getfem/getfem_nonlinear_elasticity.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <utility>

#include "problem.hpp"

// GetFEM, in process: its finite elements, its Newton's method, MUMPS for symmetric matrices (of its solvers
// the fastest on these meshes by ten times). Rules of integration are ours: one point, four, 2 x 2 x 2.
// Forces of weight and tractions are ours, node by node.
//
// Laws: "Saint_Venant_Kirchhoff" and "Compressible_Neo_Hookean_Bonet" are the energies of ours.
//
// Times: the solve is all of Newton's method; mesh, elements and the model with its assembly expressions are
// set up once. MUMPS orders the unknowns anew in each iteration, so that it is in the solve.

namespace chart {
namespace {

using Vector = getfem::model_real_plain_vector;

// Components that are held at rest, by elimination: the model asks its bricks for them.
class HeldBrick : public getfem::virtual_brick {
 public:
  explicit HeldBrick(std::vector<getfem::size_type> held) : held_(std::move(held)) {
    set_flags("Held components", true, true, true, true, false, true);
  }
  void real_pre_assembly_in_serial(const getfem::model& model, getfem::size_type,
                                   const getfem::model::varnamelist& names, const getfem::model::varnamelist&,
                                   const getfem::model::mimlist&, getfem::model::real_matlist&,
                                   getfem::model::real_veclist&, getfem::model::real_veclist&,
                                   getfem::size_type, build_version) const override {
    for (const getfem::size_type d : held_) model.add_real_dof_constraint(names[0], d, 0);
  }
  std::string declare_volume_assembly_string(const getfem::model&, getfem::size_type,
                                             const getfem::model::varnamelist&,
                                             const getfem::model::varnamelist&) const override {
    return "";
  }

 private:
  std::vector<getfem::size_type> held_;
};

// One kind of element: how GetFEM names it, and where its corners are among ours.
struct Element {
  std::string transformation, fem, integration;
  std::vector<std::size_t> corners;
};
// Lexicographic, first coordinate fastest.
const Element tet4{"GT_PK(3,1)", "FEM_PK(3,1)", "IM_TETRAHEDRON(1)", {0, 1, 2, 3}},
    tet10{"GT_PK(3,1)", "FEM_PK(3,2)", "IM_TETRAHEDRON(2)", {0, 1, 2, 3}},
    hex8{"GT_QK(3,1)", "FEM_QK(3,1)", "IM_GAUSS_PARALLELEPIPED(3,3)", {0, 1, 3, 2, 4, 5, 7, 6}};

// The law by GetFEM's name; both take lambda and mu.
std::string law_of(const Scene& scene) {
  if (has_law<softsim::StVenantKirchhoff>(scene)) return "Saint_Venant_Kirchhoff";
  if (has_law<softsim::NeoHookean>(scene)) return "Compressible_Neo_Hookean_Bonet";
  throw NotApplicable("GetFEM has no such law");
}

template <class Mesh>
class Body {
 public:
  Body(const Scene& scene, const Problem<Mesh>& problem, const Element& element)
      : problem_(problem), fem_(mesh_, 3), integration_(mesh_), steps_(scene.load_steps) {
    build_mesh(element);
    fem_.set_finite_element(mesh_.convex_index(), getfem::fem_descriptor(element.fem));
    integration_.set_integration_method(mesh_.convex_index(),
                                        getfem::int_method_descriptor(element.integration));
    find_nodes();
    model_.add_fem_variable("u", fem_);
    const softsim::Lame lame = lame_of(scene);
    model_.add_initialized_fixed_size_data("lame", Vector{lame.lambda, lame.mu});
    getfem::add_finite_strain_elasticity_brick(model_, integration_, law_of(scene), "u", "lame");
    std::vector<getfem::size_type> at_rest, moved;
    for (const auto& h : problem.held) {
      (h.u == 0 ? at_rest : moved).push_back(dof(h.node, h.axis));
      if (h.u != 0) moved_to_.push_back(h.u);
    }
    model_.add_brick(std::make_shared<HeldBrick>(at_rest), {"u"}, {}, {}, {}, getfem::size_type(-1));
    // with multipliers, so that the inside moves along in Newton's first iteration
    if (!moved.empty()) {
      getfem::model_real_sparse_matrix picked(moved.size(), fem_.nb_dof());
      for (std::size_t k = 0; k < moved.size(); ++k) picked(k, moved[k]) = 1;
      model_.add_fixed_size_variable("reactions", moved.size());
      support_ = getfem::add_constraint_with_multipliers(model_, "u", "reactions", picked, moved_to_);
    }
    force_.assign(fem_.nb_dof(), 0);
    for (std::size_t i = 0; i < problem.forces.size(); ++i)
      for (int a = 0; a < 3; ++a) force_[dof(i, a)] = problem.forces[i][a];
    load_ = getfem::add_explicit_rhs(model_, "u", force_);
  }

  // Whether it converges from rest.
  bool solve() {
    for (int k = 1; k <= steps_; ++k) {
      const double part = static_cast<double>(k) / steps_;
      getfem::set_private_data_rhs(model_, load_, scaled(force_, part));
      if (!moved_to_.empty()) getfem::set_private_data_rhs(model_, support_, scaled(moved_to_, part));
      gmm::iteration iteration(1e-7, 0, 60);
      // whole steps, unless what they lead to is no number: bent bodies are stiff along their axis, and
      // searches for less residual then creep
      getfem::simplest_newton_line_search search(20, 1e10);
      getfem::standard_solve(model_, iteration, solver_, search);
      if (!iteration.converged()) return false;
    }
    return true;
  }
  [[nodiscard]] std::vector<Vec> displacements() const {
    const Vector& u = model_.real_variable("u");
    std::vector<Vec> nodes;
    for (std::size_t i = 0; i < first_dof_.size(); ++i)
      nodes.emplace_back(u[dof(i, 0)], u[dof(i, 1)], u[dof(i, 2)]);
    return nodes;
  }

 private:
  static Vector scaled(Vector v, double factor) {
    for (double& x : v) x *= factor;
    return v;
  }
  void build_mesh(const Element& element) {
    std::vector<getfem::size_type> number;
    for (const Vec& X : problem_.mesh.points()) {
      bgeot::base_node p(3);
      for (int a = 0; a < 3; ++a) p[static_cast<bgeot::size_type>(a)] = X[a];
      number.push_back(mesh_.add_point(p));
    }
    const auto transformation = bgeot::geometric_trans_descriptor(element.transformation);
    for (const auto& nodes : problem_.mesh.elements()) {
      std::vector<getfem::size_type> corners;
      for (const std::size_t c : element.corners)
        corners.push_back(number[static_cast<std::size_t>(nodes[c])]);
      mesh_.add_convex(transformation, corners.begin());
    }
  }
  // GetFEM numbers as it likes: its nodes are found by where they are.
  void find_nodes() {
    const auto& points = problem_.mesh.points();
    double size = 0;
    for (const Vec& X : points) size = std::max(size, X.cwiseAbs().maxCoeff());
    const auto key = [size](double x, double y, double z) {
      const auto round = [size](double c) { return std::llround(c / size * 1e9); };
      return std::array<long long, 3>{round(x), round(y), round(z)};
    };
    std::map<std::array<long long, 3>, getfem::size_type> dofs;
    for (getfem::size_type d = 0; d < fem_.nb_basic_dof(); d += 3) {
      const auto p = fem_.point_of_basic_dof(d);
      dofs[key(p[0], p[1], p[2])] = d;
    }
    for (const Vec& X : points) first_dof_.push_back(dofs.at(key(X[0], X[1], X[2])));
  }
  [[nodiscard]] getfem::size_type dof(std::size_t node, int axis) const {
    return first_dof_[node] + static_cast<getfem::size_type>(axis);
  }

  const Problem<Mesh>& problem_;
  getfem::mesh mesh_;
  getfem::mesh_fem fem_;
  getfem::mesh_im integration_;
  getfem::model model_;
  int steps_;
  std::vector<getfem::size_type> first_dof_;
  Vector force_, moved_to_;
  getfem::rmodel_plsolver_type solver_ = getfem::rselect_linear_solver(model_, "auto");
  getfem::size_type load_ = 0, support_ = 0;
};

template <class Make>
Peer getfem_peer(const std::string& name, const Element& element, Make make) {
  return {name, "peer", "static", "mumps", "-", "double", [=](const Scene& scene, int resolution) {
            const auto in_use = [] {
              const auto info = mallinfo2();
              return info.uordblks + info.hblkhd;
            };
            PeerRun run;
            const std::size_t before = in_use();
            const double start = process_seconds();
            const auto problem = make(scene, resolution);
            try {
              Body model(scene, problem, element);
              const double built = process_seconds();
              const bool converged = model.solve();
              run.seconds = process_seconds() - built;
              run.setup_seconds = built - start;
              run.memory = in_use() - before;
              run.status = converged ? "converged" : "not_converged";
              if (converged) run.u = problem.at_probes(model.displacements());
            } catch (const NotApplicable&) {
              throw;
            } catch (const std::exception& e) {
              run.status = "failed";
            }
            return run;
          }};
}

}  // namespace

std::vector<Peer> getfem_peers() {
  gmm::set_traces_level(0);
  gmm::set_warning_level(0);
  return {getfem_peer("getfem_tet4", tet4, tet4_problem), getfem_peer("getfem_tet10", tet10, tet10_problem),
          getfem_peer("getfem_hex8", hex8, hex8_problem)};
}

}  // namespace chart
