// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../peers/peer.hpp"
#include "measure.hpp"

namespace chart {

/// The point of a peer's run.
inline Point point_of(const Scene& scene, const Reference& reference, const Peer& peer, const PeerRun& run,
                      int resolution) {
  Point p{.model = peer.name + (run.other_law ? "_own_law" : ""),
          .integrator = peer.integrator,
          .solver = peer.solver,
          .preconditioner = peer.preconditioner,
          .resolution = resolution,
          .scalar = peer.scalar,
          .status = run.status,
          .seconds = run.seconds,
          .memory = run.memory,
          .setup_seconds = run.setup_seconds,
          .off_front = run.other_law};
  if (run.status != "converged") return p;
  for (const Quantity& q : scene.quantities) p.errors.push_back(q.error(scene, {run.u}, reference.answer));
  return p;
}

/// All methods on a scene within a budget, coarse to fine: every model, in double precision with every solver
/// (or integrator and step), and in single precision where double was no waste.
///
/// A method ends where another solver or step of its model is as good in a quarter of the time, since finer
/// meshes do not change that (but for those that factorise, which only beat their likes), and where the next
/// resolution would take more than its share of what is left of the budget: much for those that nothing else
/// with their model is better than, and nothing at all ten times better, which go first; little for the
/// others. Peers run beside it, as far as one of our best might.
class Sweep {
 public:
  /// @param budget s of CPU time
  /// @param levels how many of the scene's resolutions
  Sweep(const Scene& scene, const Reference& reference, double budget, std::size_t levels)
      : scene_(scene),
        reference_(reference),
        end_(cpu_seconds() + budget),
        budget_(budget),
        levels_(std::min(levels, scene.resolutions.size())) {
    for (const Peer& p : peers()) peers_.push_back({p});
  }

  /// @param on_point called with every point as it comes
  void run(const Toolbox& tools, const std::function<void(const Point&)>& on_point) {
    std::vector<Candidate> candidates;
    for (const Model& m : tools.models) {
      std::size_t turn = 0;
      for (const Method& method : tools.methods(scene_, m, false)) {
        candidates.push_back({method, turn++});
        if (direct(candidates.back())) candidates.back().turn += 1000;
        if (scene_.duration > 0)  // long steps, which take less, before short ones
          candidates.back().turn += 1000 * ((turn - 1) % scene_.steps.size());
      }
    }
    for (std::size_t level = 0; level < levels_; ++level) {
      // Of the time that is left an equal part for each level, half of it for the first runs; half of all for
      // the coarsest, which every method should see.
      const double left = end_ - cpu_seconds(), part = left / static_cast<double>(levels_ - level);
      level_end_ = cpu_seconds() + (level == 0 ? left / 2 : part);
      const std::vector<Candidate*> order = by_promise(candidates, level);
      const double share = part / 2 / static_cast<double>(std::max<std::size_t>(order.size(), 1));
      for (Candidate* c : order)
        advance(*c, level, c->leads ? part / 3 : std::max(10 * share, 0.02), share, on_point);
      ask_peers(level, part / 3, on_point);
      drop_wasteful(candidates);
      for (Candidate& c : candidates)
        if (!c.out && c.point >= 0) in_single_precision(c, scene_.resolutions[level], share, on_point);
    }
  }

  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// What does not fit the scene, and why: a sentence each.
  [[nodiscard]] std::vector<std::string> reasons() const {
    std::vector<std::string> sentences;
    for (const auto& [part_and_why, models] : reasons_) {
      const auto& [part, why] = part_and_why;
      std::string names;
      for (const std::string& m : models) names += (names.empty() ? "" : ", ") + m;
      if (models.size() > 6) names = std::to_string(models.size()) + " of the models";
      sentences.push_back("no " + (part.empty() ? "" : part + " on ") + names + ": " + why);
    }
    return sentences;
  }
  /// Methods that ended for want of time, and those of them that never began.
  [[nodiscard]] int ended_early() const { return ended_early_; }
  [[nodiscard]] int never_began() const { return never_began_; }

 private:
  struct Candidate {
    Method method;
    std::size_t turn = 0;  // its place among those of its model; those that factorise come last
    double last = 0;       // s that its last resolution took, set-up included
    bool leads = false;    // nothing else does as well with its model
    bool out = false, no_single = false;
    int failures = 0;
    std::ptrdiff_t point = -1;  // its last
  };

  struct PeerCandidate {
    Peer peer;
    double last = 0;
  };

  // Statics that factorise the whole: on coarse meshes the fastest, and not on fine ones.
  static bool direct(const Candidate& c) {
    return c.method.solver != nullptr && c.method.solver->preconditioner == "-" && !c.method.reduced();
  }
  [[nodiscard]] const Point& point(const Candidate& c) const {
    return points_[static_cast<std::size_t>(c.point)];
  }
  [[nodiscard]] double growth(std::size_t level) const {
    return level == 0
               ? 1
               : std::pow(static_cast<double>(scene_.resolutions[level]) / scene_.resolutions[level - 1],
                          3.5);
  }
  // Those that are still in: first those on the front of their own model, and the quick ones before the slow;
  // without experience all models in turn.
  [[nodiscard]] std::vector<Candidate*> by_promise(std::vector<Candidate>& candidates,
                                                   std::size_t level) const {
    std::vector<Candidate*> order;
    for (Candidate& c : candidates) {
      if (c.out) continue;
      order.push_back(&c);
      const auto better = [&](const Candidate& other) { return beats(other, c); };
      c.leads = level == 0 || (c.point >= 0 && std::isfinite(point(c).error()) &&
                               std::none_of(candidates.begin(), candidates.end(), better));
    }
    std::stable_sort(order.begin(), order.end(), [level](const Candidate* a, const Candidate* b) {
      return level == 0 ? a->turn < b->turn : std::pair(!a->leads, a->last) < std::pair(!b->leads, b->last);
    });
    return order;
  }
  // a does as well as b and is faster: a little with the same model, ten times with another.
  [[nodiscard]] bool beats(const Candidate& a, const Candidate& b) const {
    const double than = a.method.model == b.method.model ? 1 : 0.1;
    return !a.out && a.point >= 0 && a.method.reduced() == b.method.reduced() && !(direct(a) && !direct(b)) &&
           point(a).error() <= 1.01 * point(b).error() && point(a).seconds < than * point(b).seconds;
  }

  // s that a model has taken at least, by any method
  [[nodiscard]] double quickest(const Model* model) const {
    const auto found = quickest_.find(model);
    return found == quickest_.end() ? 0 : found->second;
  }

  void advance(Candidate& c, std::size_t level, double limit, double patience,
               const std::function<void(const Point&)>& on_point) {
    c.point = -1;
    const double expected = level == 0 ? quickest(c.method.model) : c.last * growth(level);
    if (cpu_seconds() > level_end_ || expected > limit) {
      c.out = true;
      ++ended_early_;
      never_began_ += level == 0 ? 1 : 0;
      return;
    }
    const Point* p = ask(c.method, scene_.resolutions[level], patience);
    if (p == nullptr) {
      c.out = true;
      return;
    }
    c.point = static_cast<std::ptrdiff_t>(points_.size()) - 1;
    c.last = p->seconds + p->setup_seconds;
    const auto [quickest, is_first] = quickest_.try_emplace(c.method.model, c.last);
    if (!is_first) quickest->second = std::min(quickest->second, c.last);
    if (!std::isfinite(p->error())) ++c.failures;
    if (c.last > budget_ / 3 || c.failures == 2) c.out = true;
    on_point(*p);
  }
  // Where double precision was no waste, and there is time for it.
  void in_single_precision(Candidate& c, int resolution, double patience,
                           const std::function<void(const Point&)>& on_point) {
    if (c.no_single || !std::isfinite(point(c).error()) || cpu_seconds() + c.last > level_end_) return;
    Method single = c.method;
    single.single = true;
    const Point* p = ask(single, resolution, patience);
    c.no_single = p == nullptr || !std::isfinite(p->error()) || p->seconds > 2 * c.last;
    if (p != nullptr) on_point(*p);
  }
  // Of motions, errors that are large tell nothing of finer meshes.
  void drop_wasteful(std::vector<Candidate>& candidates) const {
    const bool moves = scene_.duration > 0;
    for (Candidate& c : candidates)
      for (const Candidate& other : candidates)
        if (!c.out && c.point >= 0 && other.point >= 0 && c.method.model == other.method.model &&
            c.method.reduced() == other.method.reduced() && !(direct(other) && !direct(c)) &&
            point(other).error() <= 1.05 * point(c).error() &&
            (!moves || c.method.step == other.method.step || point(c).error() < 0.1) &&
            point(other).seconds < point(c).seconds / 4)
          c.out = true;
  }
  // nullptr if the model does not fit
  const Point* ask(const Method& m, int resolution, double patience) {
    try {
      points_.push_back(measure(scene_, reference_, m, resolution, patience));
      return &points_.back();
    } catch (const NotApplicable& why) {
      reasons_[{why.of, why.what()}].insert(m.model->name);
    } catch (const std::invalid_argument& why) {
      reasons_[{"", why.what()}].insert(m.model->name);
    }
    return nullptr;
  }

  // Every peer on one resolution, unless it is likely to take too long.
  void ask_peers(std::size_t level, double patience, const std::function<void(const Point&)>& on_point) {
    for (PeerCandidate& c : peers_) {
      const int resolution = scene_.resolutions[level];
      c.last *= growth(level);
      if (c.last > patience) continue;
      const double begin = cpu_seconds();
      try {
        const PeerRun run = c.peer.run(scene_, resolution);
        c.last = run.seconds + run.setup_seconds;
        points_.push_back(point_of(scene_, reference_, c.peer, run, resolution));
        on_point(points_.back());
      } catch (const NotApplicable& why) {
        reasons_[{why.of, why.what()}].insert(c.peer.name);
        c.last = std::numeric_limits<double>::infinity();
      }
      // theirs is not our budget, and those that run in this process count
      end_ += cpu_seconds() - begin;
      level_end_ += cpu_seconds() - begin;
    }
  }

  const Scene& scene_;
  const Reference& reference_;
  double end_, budget_, level_end_ = 0;
  std::size_t levels_;
  std::vector<Point> points_;
  std::vector<PeerCandidate> peers_;
  std::map<const Model*, double> quickest_;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> reasons_;  // models, by part and why
  int ended_early_ = 0, never_began_ = 0;
};

}  // namespace chart
