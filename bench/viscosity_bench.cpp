// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include "common.hpp"
#include "reference.hpp"

// One explicit step of a viscoelastic mesh: the force at its start and the update of the histories. To be
// compared with force/neo_hookean/f.

namespace bench {
namespace {

constexpr double dt = 0.01;  // s
const std::vector<PronyTerm> prony_terms{{0.3, 0.02}, {0.2, 0.3}};

struct InNodes {
  static constexpr const char* name = "nodes";
  template <class T>
  static auto make(int n) {
    return prony_nodes(elastic<T>(cube(n), Kind<NeoHookean, T>::law()), cube(n).points().size(),
                       PronySeries(prony_terms));
  }
};
struct InNodesByEdges {
  static constexpr const char* name = "nodes_heml";
  template <class T>
  static auto make(int n) {
    return prony_nodes(heml<T>(cube(n), Kind<NeoHookean, T>::law()), cube(n).points().size(),
                       PronySeries(prony_terms));
  }
};
struct InElements {
  static constexpr const char* name = "elements";
  template <class T>
  static auto make(int n) {
    return prony_elements<T>(cube(n), Kind<NeoHookean, T>::law(), PronySeries(prony_terms));
  }
};

// Steps to and fro between the deformed state and half of it, so that every step has a new stress.
template <class T, class Where>
struct ViscousCase {
  decltype(Where::template make<T>(1)) term;
  std::array<State<T>, 2> q;
  Vector<T> v, y;
  std::size_t at = 0;
  double error = 0;

  explicit ViscousCase(int n) : term(Where::template make<T>(n)) {
    q[0].displacement = field<T>(cube(n), deformation);
    q[1].displacement = T(0.5) * q[0].displacement;
    v = y = Vector<T>::Zero(q[0].size());
    for (int k = 0; k < 3; ++k) step();
    const ReferenceSteps reference(n);
    error =
        relative_error(packed(y), Where::name == InElements::name ? reference.force() : reference.nodal());
  }
  void step() {
    term.begin_step(q[at], v, 0);
    y.setZero();
    term.add_gradient(q[at], y);
    at = 1 - at;
    term.end_step(q[at], v, dt);
  }

  // The force at the third step by the recursion of the reference: exact exponentials, no tricks.
  struct ReferenceSteps {
    int n;
    explicit ReferenceSteps(int n_) : n(n_) {}
    // Weights of f(q_0), f(q_1) and f(q_2) in the response after two steps.
    static std::array<double, 3> weights() {
      std::array<double, 3> w{0, 0, 1};
      for (const auto& [weight, time] : prony_terms) {
        const double x = dt / time, d = std::exp(-x), mean = (1 - d) / x, s = weight * (mean - d),
                     e = weight * (1 - mean);
        w[0] -= d * s;
        w[1] -= d * e + s;
        w[2] -= e;
      }
      return w;
    }
    [[nodiscard]] static Vec3<double> whole(const Vec3<double>& X) { return X + deformation(X); }
    [[nodiscard]] static Vec3<double> half(const Vec3<double>& X) { return X + 0.5 * deformation(X); }
    [[nodiscard]] Vector<double> nodal() const {
      const ReferenceBody<NeoHookean, double> body(cube(n), Kind<NeoHookean, double>::law());
      const Vector<double> x = packed(field<double>(cube(n), whole)),
                           x_1 = packed(field<double>(cube(n), half));
      Vector<double> f(x.size()), f_1(x.size());
      body.force(x, f);
      body.force(x_1, f_1);
      const auto w = weights();
      return (w[0] + w[2]) * f + w[1] * f_1;
    }
    // Per element: S = F^-1 P of both states, and the force of F (w S).
    [[nodiscard]] Vector<double> force() const {
      const auto w = weights();
      const NeoHookean law = Kind<NeoHookean, double>::law();
      Vector<double> y = Vector<double>::Zero(3 * static_cast<std::ptrdiff_t>(cube(n).points().size()));
      for (const Tetrahedron& t : cube(n).tetrahedra()) {
        const auto edges = [&](auto position) {
          Mat3<double> m;
          const auto x = [&](std::size_t i) {
            return position(cube(n).points()[static_cast<std::size_t>(t[i])]);
          };
          for (std::size_t i = 0; i < 3; ++i) m.col(static_cast<int>(i)) = x(i + 1) - x(0);
          return m;
        };
        const Mat3<double> rest = edges([](const Vec3<double>&X) { return X; }), inverse = rest.inverse(),
                           F = edges(whole) * inverse, F_1 = edges(half) * inverse;
        const auto stress = [&](const Mat3<double>& G) -> Mat3<double> {
          return G.inverse() * ReferenceLaw<NeoHookean>::stress<double>(G, law.lambda(), law.mu());
        };
        const Mat3<double> P = F * ((w[0] + w[2]) * stress(F) + w[1] * stress(F_1)),
                           H = rest.determinant() / 6 * P * inverse.transpose();
        for (std::size_t i = 0; i < 3; ++i) {
          y.segment<3>(3 * t[i + 1]) += H.col(static_cast<int>(i));
          y.segment<3>(3 * t[0]) -= H.col(static_cast<int>(i));
        }
      }
      return y;
    }
  };
};

template <class T, class Where>
void add_viscous(int n) {
  add_named<T>("force", "neo_hookean_prony2", Where::name, n, [n](benchmark::State& state) {
    auto& c = cached<ViscousCase<T, Where>>(n);
    measure(state, tetrahedra(n), c.error, rounding<T>, [&] { c.step(); });
  });
}

[[maybe_unused]] const bool registered = [] {
  for (const int n : cube_cells) {
    add_viscous<double, InNodes>(n);
    add_viscous<double, InNodesByEdges>(n);
    add_viscous<double, InElements>(n);
    add_viscous<float, InNodes>(n);
    add_viscous<float, InElements>(n);
  }
  return true;
}();

}  // namespace
}  // namespace bench
