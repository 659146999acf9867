// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#define BT_USE_DOUBLE_PRECISION
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>
#include <malloc.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "problem.hpp"

// Bullet, in process: its deformable bodies in double precision, implicit in time, Newton's method with
// conjugate gradients on products of tetrahedra. It holds nodes in all directions or in none.
//
// Laws, neither of which is a scene's own: bullet_tet4 has btDeformableNeoHookeanForce, the energy of Smith,
// de Goes and Kim 2018 with the scene's moduli in small strains; bullet_tet4_corotational has
// btDeformableLinearElasticityForce, Hooke's law after a rotation that Bullet finds to 0.01 radian.
//
// An equilibrium is reached in time, the load and the supports' displacements growing over the scene's load
// steps: steps of backward Euler as long as twenty times that of a wave through the body, which damp what is
// quicker, and kinetic damping, which stops all nodes whenever forces do negative work. It is settled where
// the forces that are left at free nodes are a hundred-thousandth of the loads, or of those at held ones
// without. Of what was tried (steps from 5 to 1000 times that long, all nodes stopped after each step or
// never, search along lines with conjugate gradients or residuals) this was quickest. The solve is all of
// that time, with the looks at forces; nodes, tetrahedra and the world are set up once.

namespace chart {
namespace {

btVector3 to_bullet(const Vec& v) { return {v[0], v[1], v[2]}; }

// Forces on nodes that do not depend on where they are.
class NodalForce : public btDeformableLagrangianForce {
 public:
  explicit NodalForce(const std::vector<Vec>& forces) : forces_(forces) {}
  void addScaledForces(btScalar scale, TVStack& force) override {
    for (std::size_t i = 0; i < forces_.size(); ++i)
      force[static_cast<int>(i)] += to_bullet(scale * part * forces_[i]);
  }
  void addScaledExplicitForce(btScalar scale, TVStack& force) override { addScaledForces(scale, force); }
  void addScaledDampingForce(btScalar, TVStack&) override {}
  void addScaledElasticForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}
  double totalEnergy(btScalar) override {
    double e = 0;
    for (std::size_t i = 0; i < forces_.size(); ++i)
      e -= part * to_bullet(forces_[i]).dot(m_softBodies[0]->m_nodes[static_cast<int>(i)].m_q);
    return e;
  }
  // one of those that come from outside; gravity is taken for Bullet's own class
  btDeformableLagrangianForceType getForceType() override { return BT_MOUSE_PICKING_FORCE; }

  double part = 1;

 private:
  const std::vector<Vec>& forces_;
};

using TetrahedralProblem = Problem<softsim::TetrahedralMesh>;

class World {
 public:
  World(const Scene& scene, const TetrahedralProblem& problem,
        std::unique_ptr<btDeformableLagrangianForce> law)
      : problem_(problem), law_(std::move(law)), dead_(problem.forces) {
    constraints_.setDeformableSolver(&solver_);
    world_.setImplicit(true);
    world_.setLineSearch(false);
    world_.setUseProjection(true);  // conjugate gradients and not residuals
    world_.setGravity(btVector3(0, 0, 0));
    const auto& mesh = problem.mesh;
    std::vector<double> mass(mesh.points().size(), 0);
    for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t)
      for (const std::int32_t i : mesh.tetrahedra()[t])
        mass[static_cast<std::size_t>(i)] += scene.density * mesh.volume(t) / 4;
    std::vector<int> held(mass.size(), 0);
    for (const auto& h : problem.held) ++held[h.node];
    for (std::size_t i = 0; i < mass.size(); ++i) {
      if (held[i] != 0 && held[i] != 3)
        throw NotApplicable("Bullet holds nodes in all directions or in none");
      if (held[i] != 0) mass[i] = 0;
    }
    info_.m_broadphase = &broadphase_;
    info_.m_dispatcher = &dispatcher_;
    std::vector<btVector3> points;
    for (const Vec& X : mesh.points()) points.push_back(to_bullet(X));
    body_ = std::make_unique<btSoftBody>(&info_, static_cast<int>(points.size()), points.data(), mass.data());
    for (const auto& t : mesh.tetrahedra()) body_->appendTetra(t[0], t[1], t[2], t[3]);
    body_->initializeDmInverse();
    body_->m_tetraScratches.resize(body_->m_tetras.size());
    body_->m_tetraScratchesTn.resize(body_->m_tetras.size());
    body_->m_cfg.collisions = 0;
    body_->setSelfCollision(false);
    body_->setActivationState(DISABLE_DEACTIVATION);
    world_.addSoftBody(body_.get());
    world_.addForce(body_.get(), law_.get());
    world_.addForce(body_.get(), &dead_);
    Vec low = mesh.points()[0], high = low;
    for (const Vec& X : mesh.points()) {
      low = low.cwiseMin(X);
      high = high.cwiseMax(X);
    }
    step_ = 20 * (high - low).norm() * std::sqrt(scene.density / scene.young);
    load_steps_ = scene.load_steps;
  }
  ~World() { world_.removeSoftBody(body_.get()); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // Whether it comes to rest within 20 s.
  bool settle() {
    const double start = process_seconds();
    for (int k = 1; process_seconds() < start + 20; ++k) {
      const double part = std::min(1.0, static_cast<double>(k) / load_steps_);
      dead_.part = part;
      for (const auto& h : problem_.held) {
        btSoftBody::Node& node = body_->m_nodes[static_cast<int>(h.node)];
        node.m_x[h.axis] = problem_.mesh.points()[h.node][h.axis] + part * h.u;
        node.m_q = node.m_x;
      }
      world_.stepSimulation(step_, 0);
      const Forces f = forces();
      if (!std::isfinite(f.unbalanced)) return false;
      if (part == 1 && f.unbalanced < 1e-5) return true;
      if (part == 1 && f.power < 0)
        for (int i = 0; i < body_->m_nodes.size(); ++i)
          body_->m_nodes[i].m_v = body_->m_nodes[i].m_vn = btVector3(0, 0, 0);
    }
    return false;
  }

  [[nodiscard]] std::vector<Vec> displacements() const {
    std::vector<Vec> u;
    for (std::size_t i = 0; i < problem_.forces.size(); ++i) {
      const btVector3& x = body_->m_nodes[static_cast<int>(i)].m_x;
      u.push_back(Vec(x[0], x[1], x[2]) - problem_.mesh.points()[i]);
    }
    return u;
  }

 private:
  // What is left of forces at free nodes, over those at held ones.
  struct Forces {
    double unbalanced;  // at free nodes, over the loads, or those at held nodes if there are none
    double power;
  };
  Forces forces() {
    body_->updateDeformation();
    btAlignedObjectArray<btVector3> f;
    f.resize(body_->m_nodes.size(), btVector3(0, 0, 0));
    law_->addScaledForces(1, f);
    dead_.addScaledForces(1, f);
    double free = 0, held = 0, loads = 0, power = 0;
    for (const Vec& load : problem_.forces) loads += load.squaredNorm();
    for (int i = 0; i < f.size(); ++i) {
      const btSoftBody::Node& node = body_->m_nodes[i];
      (node.m_im > 0 ? free : held) += f[i].length2();
      if (node.m_im > 0) power += f[i].dot(node.m_v);
    }
    return {std::sqrt(free / (loads > 0 ? loads : held)), power};
  }

  const TetrahedralProblem& problem_;
  std::unique_ptr<btDeformableLagrangianForce> law_;
  NodalForce dead_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btDeformableBodySolver solver_;
  btDeformableMultiBodyConstraintSolver constraints_;
  btSoftBodyWorldInfo info_;
  std::unique_ptr<btSoftBody> body_;
  btDeformableMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &constraints_, &configuration_,
                                            &solver_};
  double step_ = 1;
  int load_steps_ = 1;
};

// Its mu and lambda are not Lame's.
std::unique_ptr<btDeformableLagrangianForce> neo_hookean(const Scene& scene) {
  const softsim::Lame lame = lame_of(scene);
  return std::make_unique<btDeformableNeoHookeanForce>(4 * lame.mu / 3, lame.lambda + 5 * lame.mu / 6, 0);
}
std::unique_ptr<btDeformableLagrangianForce> corotational(const Scene& scene) {
  const softsim::Lame lame = lame_of(scene);
  return std::make_unique<btDeformableLinearElasticityForce>(lame.mu, lame.lambda, 0, 0);
}

template <class Law>
Peer bullet(const std::string& name, Law law) {
  return {
      name, "peer", "static", "cg_matrix_free", "mass", "double", [=](const Scene& scene, int resolution) {
        const auto in_use = [] {
          const auto info = mallinfo2();
          return info.uordblks + info.hblkhd;
        };
        PeerRun run;
        run.other_law = true;
        const std::size_t before = in_use();
        const double start = process_seconds();
        const auto problem = tet4_problem(scene, resolution);
        World world(scene, problem, law(scene));
        const double built = process_seconds();
        run.status = world.settle() ? "converged" : "not_converged";
        run.seconds = process_seconds() - built;
        run.setup_seconds = built - start;
        run.memory = in_use() - before;
        if (run.status == "converged") run.u = problem.at_probes(world.displacements());
        return run;
      }};
}

}  // namespace

std::vector<Peer> bullet_peers() {
  return {bullet("bullet_tet4", neo_hookean), bullet("bullet_tet4_corotational", corotational)};
}

}  // namespace chart
