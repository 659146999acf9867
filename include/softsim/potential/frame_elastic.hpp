// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "softsim/kinematics/frame_body.hpp"
#include "softsim/potential/elastic.hpp"

namespace softsim {

/// Elastic energy of samples between frames, N a sample.
template <int N, class M, class T = double, int lanes = default_lanes<T>>
using ElasticFrames = Elements<Elastic<FrameSample<N>, M>, T, lanes>;

/// Elastic energy of `body` with one of `materials` per sample; `material_index` chooses it and may be empty
/// if there is one material only.
/// @throws std::invalid_argument for an index out of range or a list of the wrong length
template <class T = double, int lanes = default_lanes<T>, int N, class M>
[[nodiscard]] ElasticFrames<N, M, T, lanes> elastic(const FrameBody<N>& body, const std::vector<M>& materials,
                                                    const std::vector<std::int32_t>& material_index = {}) {
  if (materials.empty()) invalid("elastic: no material");
  if (material_index.empty() && materials.size() > 1)
    invalid(std::string("elastic: ") + std::to_string(materials.size()) +
            " materials need an index per sample");
  std::vector<Elastic<FrameSample<N>, M>> models;
  for (const M& material : materials) models.push_back({material});
  return {std::move(models), body.data(), body.stencils(), material_index};
}

/// Elastic energy of `body` made of one material.
template <class T = double, int lanes = default_lanes<T>, int N, class M>
requires Material<M>
[[nodiscard]] ElasticFrames<N, M, T, lanes> elastic(const FrameBody<N>& body, const M& material) {
  return elastic<T, lanes>(body, std::vector<M>{material});
}

/// Elastic energy of `body` made of a law that differs from sample to sample.
/// @param data what differs, per sample
/// @throws std::invalid_argument for a list of the wrong length
template <class T = double, int lanes = default_lanes<T>, int N, MaterialField M>
[[nodiscard]] ElasticFrames<N, M, T, lanes> elastic(
    const FrameBody<N>& body, const M& law, const std::vector<typename M::template Data<double>>& data) {
  using Local = Elastic<FrameSample<N>, M>;
  if (data.size() != body.size())
    invalid(std::string("elastic: ") + std::to_string(data.size()) + " material data for " +
            std::to_string(body.size()) + " samples");
  std::vector<typename Local::template Data<double>> all;
  all.reserve(data.size());
  for (std::size_t s = 0; s < data.size(); ++s) all.push_back({body.data()[s], data[s]});
  return {std::vector<Local>{{law}}, all, body.stencils()};
}

}  // namespace softsim
