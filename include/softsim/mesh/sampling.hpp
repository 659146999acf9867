// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/tensor.hpp"
#include "softsim/mesh/domain.hpp"
#include "softsim/mesh/point_grid.hpp"
#include "softsim/mesh/poisson_disk.hpp"
#include "softsim/mesh/samples.hpp"
#include "softsim/mesh/voxels.hpp"

namespace softsim {

/// How the volume of a domain is divided among samples. Where elements are at hand their Gauss points
/// (`gauss_samples`) beat both by far: bench/studies/frame_sampling.cpp.
enum class VolumeShares {
  equal,    ///< the same for each (Bosman 2015, Sec. 4.1)
  voronoi,  ///< the part of the domain that is nearer to it than to any other
};

/// Samples at these positions (m) with the volume of the voxels that are nearest to each, whose sum is that
/// of the domain. Positions that no voxel is nearest to are left out. "Nearest" is as the crow flies: through
/// a gap or a cavity too.
/// @throws std::invalid_argument if there are no positions, or one is not finite
[[nodiscard]] inline Samples voronoi_samples(const Voxels& voxels,
                                             const std::vector<Vec3<double>>& positions) {
  if (positions.empty()) invalid("samples: no positions");
  const PointGrid grid(positions);
  std::vector<double> volumes(positions.size(), 0);
  for (const Voxel& voxel : voxels.voxels())
    volumes[static_cast<std::size_t>(grid.nearest(voxel.centre, 1)[0])] += voxel.volume;
  Samples samples;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (volumes[i] > 0) {
      samples.positions.push_back(positions[i]);
      samples.volumes.push_back(volumes[i]);
    }
  return samples;
}

/// Samples at these positions (m), each with the same share of the volume of the domain.
/// @throws std::invalid_argument if there are no positions, or the volume is not positive
template <Domain D>
[[nodiscard]] Samples equal_samples(const D& domain, std::vector<Vec3<double>> positions) {
  if (positions.empty()) invalid("samples: no positions");
  const double share = detail::checked_volume(domain.volume()) / static_cast<double>(positions.size());
  std::vector<double> volumes(positions.size(), share);
  return {std::move(positions), std::move(volumes)};
}

/// Options of `sample`.
struct SamplingOptions {
  VolumeShares shares = VolumeShares::voronoi;  ///< how the volume is divided
  /// Voxels per spacing that divide the volume into Voronoi shares.
  double voxels_per_spacing = 4;
  PoissonDiskOptions poisson_disk = {};
};

/// Fills a domain with samples, no two nearer than `spacing` (m): a Poisson-disk set and a share of the
/// volume for each; the shares sum to the volume of the domain (Bosman 2015, Sec. 4.1 "Domain sampling").
/// Voronoi shares integrate more accurately than equal ones and cost about 100 look-ups per sample.
/// @throws std::invalid_argument as `poisson_disk` and `Voxels`, and for voxels_per_spacing that is not
///   positive
template <Domain D>
[[nodiscard]] Samples sample(const D& domain, double spacing, const SamplingOptions& options = {}) {
  if (!(options.voxels_per_spacing > 0))
    invalid(std::string("voxels_per_spacing ") + to_text(options.voxels_per_spacing) + ": must be positive");
  std::vector<Vec3<double>> positions = poisson_disk(domain, spacing, options.poisson_disk);
  if (options.shares == VolumeShares::equal) return equal_samples(domain, std::move(positions));
  return voronoi_samples(Voxels(domain, spacing / options.voxels_per_spacing), positions);
}

}  // namespace softsim
