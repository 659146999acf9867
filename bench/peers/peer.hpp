// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "../chart/scene.hpp"

namespace chart {

/// What came of a scene in somebody else's solver.
struct PeerRun {
  std::string status;  ///< "converged", "not_converged", or what went wrong, in one word
  /// Displacements at the probes of the scene, of the equilibrium, or time after time.
  std::vector<Vec> u = {};
  double seconds = std::numeric_limits<double>::quiet_NaN();  ///< CPU time from rest to equilibrium
  double setup_seconds = 0;                                   ///< CPU time of what is done once a scene
  std::size_t memory = 0;                                     ///< bytes
  bool other_law = false;  ///< not that of the scene, but its own with the same moduli in small strains
};

/// Somebody else's solver with one kind of element.
struct Peer {
  std::string name;        ///< as a model, calculix_tet4 say
  std::string family;      ///< "peer"
  std::string integrator;  ///< "static", or how it moves in time
  std::string solver, preconditioner, scalar;
  /// @throws NotApplicable if the scene does not fit; what goes wrong in the solver becomes a status
  std::function<PeerRun(const Scene&, int resolution)> run;
};

/// Those that were found at configure time; none without SOFTSIM_PEERS.
std::vector<Peer> peers();

/// The peers, a file each.
std::vector<Peer> calculix_peers(), getfem_peers(), bullet_peers();

}  // namespace chart
