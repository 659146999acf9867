// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
// Other people's solvers against ours: with the same mesh, elements, law and forces the discrete problem is
// the same, and so is its answer, up to what each iterates to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "../chart/command_line.hpp"
#include "../chart/discretise.hpp"
#include "../chart/measure.hpp"
#include "peer.hpp"
#include "problem.hpp"
#include "softsim/material/corotational.hpp"
#include "softsim/material/isochoric_neo_hookean.hpp"
#include "softsim/material/isotropic.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/quadrature.hpp"

namespace peers_test {

using namespace chart;

Scene scene_of(const std::string& name) { return scenes_named({name}).front(); }

const Peer* peer(const std::string& name) {
  static const std::vector<Peer> all = peers();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Peer& p) { return p.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// What we make of a scene with a law on a mesh, with the direct solver.
template <class Mesh, class Law>
std::vector<Vec> ours(const Scene& scene, const Mesh& mesh, const Law& law) {
  const Discrete<double> d = discrete<double>(scene, mesh, softsim::elastic<double>(mesh, law));
  softsim::State<double> q = d.system.rest_state();
  const auto report = solvers().front().make<double>(scene.load_steps)(d, q);
  EXPECT_EQ(report.status, softsim::Status::converged);
  return d.at_probes(q);
}
/// The same with the elements that the name of a peer ends with.
template <class Law>
std::vector<Vec> ours(const Scene& scene, int resolution, const std::string& name, const Law& law) {
  if (name.ends_with("tet10"))
    return ours(scene, softsim::QuadraticTetrahedralMesh(scene.tetrahedra(resolution)), law);
  if (name.ends_with("hex8")) return ours(scene, hexahedra_of(scene, resolution), law);
  return ours(scene, scene.tetrahedra(resolution), law);
}

/// The peer's answer is ours with this law.
template <class Law>
void expect_same(const std::string& name, const std::string& of, int resolution, const Law& law,
                 double tolerance) {
  const Scene scene = scene_of(of);
  const std::string what = name + " on " + of + " " + std::to_string(resolution);
  const PeerRun run = peer(name)->run(scene, resolution);
  ASSERT_EQ(run.status, "converged") << what;
  ASSERT_EQ(run.u.size(), scene.probes.size()) << what;
  const double distance = relative_distance(run.u, ours(scene, resolution, name, law));
  EXPECT_LT(distance, tolerance) << what;
  EXPECT_GT(run.seconds, 0) << what;
  EXPECT_GT(run.setup_seconds, 0) << what;
  if (::testing::GTEST_FLAG(print_time))
    std::cout << what << ": " << distance << " from ours, " << run.seconds << " s after " << run.setup_seconds
              << " s\n";
}
void expect_same(const std::string& name, const std::string& of, int resolution, double tolerance) {
  std::visit([&](const auto& law) { expect_same(name, of, resolution, law, tolerance); }, scene_of(of).law);
}

const std::vector<std::string> elements{"tet4", "tet10", "hex8"};

// It prints seven digits, and its forces balance to 1e-7.
constexpr double of_calculix = 2e-6;
// It and we end after a correction or a residual of 1e-7 at quadratic convergence.
constexpr double of_getfem = 1e-6;

TEST(CalculiX, IsOursWithStVenantKirchhoff) {
  if (!peer("calculix_tet4")) GTEST_SKIP() << "ccx was not found";
  for (const std::string& e : elements)
    for (const char* of : {"steel_cantilever", "soft_cantilever"})
      for (const int r : {1, 2}) expect_same("calculix_" + e, of, r, of_calculix);
}
// Its law is Neo-Hookean in distortion, and apart from it in volume; dead tractions with Cook.
TEST(CalculiX, IsOursWithItsNeoHookeanLaw) {
  if (!peer("calculix_tet4")) GTEST_SKIP() << "ccx was not found";
  for (const std::string& e : elements)
    for (const char* of : {"compressed_block", "twisted_bar", "cook_30"}) {
      const Scene scene = scene_of(of);
      expect_same("calculix_" + e, of, 2,
                  softsim::IsochoricNeoHookean::from_young_poisson(scene.young, scene.poisson), of_calculix);
    }
  // which hardly matters where volumes cannot change
  expect_same("calculix_tet4", "cook_4999", 4, 1e-4);
}

TEST(GetFEM, IsOursWithStVenantKirchhoff) {
  if (!peer("getfem_tet4")) GTEST_SKIP() << "GetFEM was not found";
  for (const std::string& e : elements)
    for (const char* of : {"steel_cantilever", "soft_cantilever"})
      for (const int r : {1, 2}) expect_same("getfem_" + e, of, r, of_getfem);
}
TEST(GetFEM, IsOursWithNeoHookean) {
  if (!peer("getfem_tet4")) GTEST_SKIP() << "GetFEM was not found";
  for (const std::string& e : elements)
    for (const char* of : {"compressed_block", "twisted_bar", "cook_30"})
      expect_same("getfem_" + e, of, 2, of_getfem);
}

/// Smith, de Goes, Kim 2018 with the logarithm: mu/2 (I1 - 3 - ln((I1 + 1) / 4)) + lambda/2 (J - 1)^2 - 3/4
/// mu (J - 1), here with Lame's parameters of small strain.
class WithLogarithm : public softsim::Isotropic<WithLogarithm> {
 public:
  static constexpr bool depends_on_i2 = false, linear_in_i1 = false;
  explicit WithLogarithm(softsim::Lame lame) : mu_(4 * lame.mu / 3), lambda_(lame.lambda + 5 * lame.mu / 6) {}
  template <class T>
  [[nodiscard]] T density(const softsim::Invariants<T>& i) const {
    using std::log1p;
    return T(mu_ / 2) * (i.k1 - log1p(i.k1 / T(4))) + (T(lambda_ / 2) * i.kj - T(0.75 * mu_)) * i.kj;
  }
  template <class T>
  [[nodiscard]] softsim::First<T> first(const softsim::Invariants<T>& i) const {
    return {T(mu_ / 2) * (T(1) - T(1) / (i.i1 + T(1))), T(0), T(lambda_) * i.kj - T(0.75 * mu_)};
  }
  template <class T>
  [[nodiscard]] softsim::Second<T> second(const softsim::Invariants<T>& i) const {
    return {T(mu_ / 2) / ((i.i1 + T(1)) * (i.i1 + T(1))), T(0), T(0), T(0), T(0), T(lambda_)};
  }

 private:
  double mu_, lambda_;
};

// Forces at free nodes are a hundred-thousandth of the loads, and take about that much off the displacement
// in the softest mode.
TEST(Bullet, IsOursWithItsNeoHookeanLaw) {
  if (!peer("bullet_tet4")) GTEST_SKIP() << "Bullet was not found";
  for (const char* of : {"soft_cantilever", "steel_cantilever", "twisted_bar"}) {
    const WithLogarithm law(lame_of(scene_of(of)));
    expect_same("bullet_tet4", of, 1, law, 1e-4);
    expect_same("bullet_tet4", of, 2, law, 1e-4);
  }
}
// It finds rotations to a hundredth of a radian.
TEST(Bullet, IsNearlyOursWithTheCorotationalLaw) {
  if (!peer("bullet_tet4")) GTEST_SKIP() << "Bullet was not found";
  for (const char* of : {"soft_cantilever", "twisted_bar"}) {
    const Scene scene = scene_of(of);
    expect_same("bullet_tet4_corotational", of, 1,
                softsim::Corotational::from_young_poisson(scene.young, scene.poisson), 1e-2);
  }
}

TEST(Peers, SayWhatDoesNotFit) {
  std::set<std::string> names;
  for (const Peer& p : peers()) {
    EXPECT_TRUE(names.insert(p.name).second) << p.name;
    EXPECT_EQ(p.family, "peer");
    EXPECT_EQ(p.integrator, "static");
    try {
      (void)p.run(scene_of("vibrating_bar"), 4);
      ADD_FAILURE() << p.name;
    } catch (const NotApplicable& why) {
      EXPECT_STREQ(why.what(), "equilibria only");
    }
  }
  if (!peer("bullet_tet4")) return;
  try {
    (void)peer("bullet_tet4")->run(scene_of("compressed_block"), 1);
    FAIL();
  } catch (const NotApplicable& why) {
    EXPECT_STREQ(why.what(), "Bullet holds nodes in all directions or in none");
  }
}

// A body that falls has no equilibrium: a status, and no exception.
TEST(Peers, SayWhereThereIsNoEquilibrium) {
  Scene scene = scene_of("soft_cantilever");
  scene.support = [](const Vec&) { return all_free(); };
  for (const Peer& p : peers()) {
    if (p.name.starts_with("bullet")) continue;  // after 20 s
    EXPECT_NE(p.run(scene, 1).status, "converged") << p.name;
  }
}

}  // namespace peers_test
