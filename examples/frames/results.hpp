// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "softsim/io/write_vtu.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/mesh/frame_nodes.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/element_fields.hpp"

namespace frames {

using softsim::Field;
using softsim::FrameBody;
using softsim::FrameNodes;
using softsim::Mat3;
using softsim::State;
using softsim::Vec3;

/// F at sample s of a body.
template <int N>
[[nodiscard]] Mat3<double> deformation_gradient(const FrameBody<N>& body, const State<double>& q,
                                                std::size_t s) {
  softsim::Local<double, 0, N> u;
  for (std::size_t i = 0; i < u.frames.size(); ++i) {
    const std::ptrdiff_t j = body.blends()[s].frames[i];
    u.frames[i] = {q.translation(j), softsim::rotation_less_identity<double>(q.quaternion(j))};
  }
  return softsim::FrameSample<N>::deformation_gradient(body.data()[s], u);
}

/// The least det F of all samples.
template <int N>
[[nodiscard]] double least_volume_ratio(const FrameBody<N>& body, const State<double>& q) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < body.size(); ++s)
    least = std::min(least, softsim::determinant(deformation_gradient(body, q, s)));
  return least;
}

/// Two series of points for ParaView: BODY_samples.pvd, with J, von Mises stress (Pa), energy density (J/m^3)
/// and displacement (m), and BODY_frames.pvd, with the frames' axes as unit vectors and displacement.
class FrameSeries {
 public:
  FrameSeries(const std::string& folder, const std::string& body)
      : samples_(folder, body + "_samples"), frames_(folder, body + "_frames") {}

  /// Writes the state that belongs to `part` of the load.
  template <int N, class Law>
  void add(double part, const FrameNodes& nodes, const FrameBody<N>& body, const Law& law,
           const State<double>& q) {
    std::vector<Vec3<double>> points;
    Field j{"J", 1, {}}, von_mises{"von_mises", 1, {}}, energy{"energy_density", 1, {}},
        displacement{"displacement", 3, {}};
    for (std::size_t s = 0; s < body.size(); ++s) {
      const Mat3<double> F = deformation_gradient(body, q, s);
      points.push_back(body.position(q, s));
      j.values.push_back(softsim::determinant(F));
      von_mises.values.push_back(softsim::von_mises(softsim::cauchy_stress(F, law.first_piola(F))));
      energy.values.push_back(law.energy_density(F));
      append(displacement, points.back() - body.positions()[s]);
    }
    add_points(samples_, part, points, {j, von_mises, energy, displacement});

    points.clear();
    displacement.values.clear();
    std::array<Field, 3> axes{{{"axis_x", 3, {}}, {"axis_y", 3, {}}, {"axis_z", 3, {}}}};
    for (std::size_t f = 0; f < nodes.frames().size(); ++f) {
      const Vec3<double> u = q.translation(static_cast<std::ptrdiff_t>(f));
      points.push_back(nodes.frames()[f] + u);
      append(displacement, u);
      const Mat3<double> turned = nodes.axes(q, f);
      for (std::size_t a = 0; a < axes.size(); ++a) append(axes[a], turned.col(static_cast<int>(a)));
    }
    add_points(frames_, part, points, {axes[0], axes[1], axes[2], displacement});
  }

 private:
  static void append(Field& field, const Vec3<double>& v) {
    field.values.insert(field.values.end(), v.data(), v.data() + 3);
  }
  static void add_points(softsim::VtuSeries& series, double part, const std::vector<Vec3<double>>& points,
                         const std::vector<Field>& fields) {
    std::vector<std::array<std::int32_t, 1>> vertices;
    for (std::size_t i = 0; i < points.size(); ++i) vertices.push_back({static_cast<std::int32_t>(i)});
    series.add(part, points, vertices, fields);
  }

  softsim::VtuSeries samples_, frames_;
};

/// What BODY.json holds.
struct Summary {
  std::string body = {};
  double young = 0, poisson = 0, volume = 0;  ///< Pa, -, m^3
  std::size_t frames = 0, samples = 0;
  int load_steps = 0, newton_iterations = 0;
  softsim::Status status = softsim::Status::converged;
  std::string reason = {};
  double load_reached = 0, residual = 0;                 ///< part of the load; relative
  double max_displacement = 0, least_j = 1;              ///< m, of frames; of samples
  std::vector<std::pair<std::string, double>> own = {};  ///< what only this example has
};

/// Writes DIR/BODY.json, complete or not at all.
inline void write_summary(const std::string& folder, const Summary& s) {
  std::string text = "{\n  \"body\": \"" + s.body + "\"";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += ",\n  \"" + key + "\": " + value;
  };
  const auto add_number = [&](const std::string& key, double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", value);
    add(key, std::isfinite(value) ? digits : "null");
  };
  add_number("young", s.young);
  add_number("poisson", s.poisson);
  add_number("volume", s.volume);
  add("frames", std::to_string(s.frames));
  add("samples", std::to_string(s.samples));
  add("load_steps", std::to_string(s.load_steps));
  add("status", '"' + std::string(to_string(s.status)) + '"');
  add("reason", '"' + s.reason + '"');  // the library's sentences need no escapes
  add_number("load_reached", s.load_reached);
  add("newton_iterations", std::to_string(s.newton_iterations));
  add_number("residual", s.residual);
  add_number("max_displacement", s.max_displacement);
  add_number("least_J", s.least_j);
  for (const auto& [key, value] : s.own) add_number(key, value);
  softsim::detail::AtomicFile file(folder + "/" + s.body + ".json");
  file.write(text + "\n}\n");
  file.commit();
}

/// Makes the folder of the results, without those of an earlier run of the same example.
inline void prepare_folder(const std::string& folder, const std::string& example) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) invalid(std::string("--out ") + folder + ": cannot be made (" + error.message() + ")");
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string(), ending = entry.path().extension().string();
    const bool ours = name.starts_with(example + "_") || name.starts_with(example + ".");
    if (ours && (ending == ".vtu" || ending == ".pvd" || ending == ".json" || ending == ".png"))
      old.push_back(entry.path());
  }
  for (const fs::path& path : old) {
    if (fs::is_directory(path))
      invalid(std::string("--out ") + folder + ": " + path.filename().string() + " is a folder there");
    fs::remove(path, error);
  }
  if (error) invalid(std::string("--out ") + folder + ": " + error.message());
}

}  // namespace frames
