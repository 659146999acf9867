// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "peer.hpp"

namespace chart {

std::vector<Peer> peers() {
  std::vector<Peer> all;
  [[maybe_unused]] const auto add = [&all](const std::vector<Peer>& some) {
    all.insert(all.end(), some.begin(), some.end());
  };
#ifdef SOFTSIM_PEER_CALCULIX
  add(calculix_peers());
#endif
#ifdef SOFTSIM_PEER_GETFEM
  add(getfem_peers());
#endif
#ifdef SOFTSIM_PEER_BULLET
  add(bullet_peers());
#endif
  return all;
}

}  // namespace chart
