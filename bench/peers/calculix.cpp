// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "problem.hpp"

// CalculiX, as the program ccx: a deck is written, solved by Newton's method with SPOOLES (its sparse direct
// solver; Debian's has no other), and displacements are read in the seven digits that it prints. Forces of
// weight and tractions are ours, node by node.
//
// Laws: *ELASTIC with NLGEOM is Green's strain with the second Piola-Kirchhoff stress, St. Venant-Kirchhoff
// to the letter. *HYPERELASTIC, NEO HOOKE is another one than ours where volumes change: mu/2 (J^(-2/3) I1 -
// 3) + K/2 (J - 1)^2 with the same moduli in small strains.
//
// Times: a run of the same deck with *NO ANALYSIS reads and checks it and is what is set up, with our writing
// of it; the solve is what the whole run takes more than that: patterns, orders of elimination and
// factorisations, which ccx does anew in each iteration.

namespace chart {
namespace {

namespace fs = std::filesystem;

// A folder of its own, gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "softsim_calculix_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Ended {
  bool started = false, in_time = true;
  int code = 0;  // as the shell gives it
  double seconds = 0;
  std::size_t memory = 0;  // highest, as far as seen
};

// Most memory that a running program had, bytes. Its own record ends with it, and that of the system begins
// with what its parent had.
std::size_t peak_memory(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtoull(line.c_str() + 6, nullptr, 10) * 1024;
  return 0;
}

// Runs ccx on a deck in a folder, on one thread, for ten minutes at most.
Ended run_ccx(const fs::path& folder, const std::string& deck) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  std::array<std::string, 4> words{"env", "OMP_NUM_THREADS=1", SOFTSIM_PEER_CALCULIX, deck};
  std::array<char*, 5> arguments{};
  std::transform(words.begin(), words.end(), arguments.begin(), [](std::string& w) { return w.data(); });
  pid_t pid = 0;
  Ended ended;
  ended.started = posix_spawnp(&pid, "env", &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  if (!ended.started) return ended;
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  int status = 0;
  rusage used{};
  for (pid_t done = 0; (done = wait4(pid, &status, WNOHANG, &used)) != pid;) {
    if (done < 0 && errno != EINTR) return {};
    ended.memory = std::max(ended.memory, peak_memory(pid));
    if (std::chrono::steady_clock::now() > end) {
      ended.in_time = false;
      kill(pid, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ended.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  ended.seconds = seconds(used.ru_utime) + seconds(used.ru_stime);
  return ended;
}

// The unit of force, N: ccx takes forces under 1e-8 for none, whatever the others are.
double unit_of(const Scene& scene) { return scene.young * 1e-6; }

std::string material(const Scene& scene) {
  const double unit = unit_of(scene);
  std::ostringstream deck;
  deck.precision(12);
  if (has_law<softsim::StVenantKirchhoff>(scene)) {
    deck << "*ELASTIC\n" << scene.young / unit << ',' << scene.poisson << '\n';
  } else if (has_law<softsim::NeoHookean>(scene)) {
    const softsim::Lame lame = lame_of(scene);
    deck << "*HYPERELASTIC, NEO HOOKE\n"
         << lame.mu / (2 * unit) << ',' << 2 * unit / (lame.lambda + 2 * lame.mu / 3) << '\n';
  } else {
    throw NotApplicable("CalculiX has no such law");
  }
  return deck.str();
}

// Elements in our order of nodes, which is ccx's: VTK's order of edge nodes is also Abaqus's.
template <class Mesh>
std::string deck_of(const Scene& scene, const Problem<Mesh>& problem, const std::string& element,
                    bool solve) {
  std::ostringstream deck;
  deck.precision(12);  // numbers of 20 characters at most
  deck << "*NODE, NSET=N\n";
  for (std::size_t i = 0; i < problem.mesh.points().size(); ++i) {
    const Vec& X = problem.mesh.points()[i];
    deck << i + 1 << ',' << X[0] << ',' << X[1] << ',' << X[2] << '\n';
  }
  deck << "*ELEMENT, TYPE=" << element << ", ELSET=E\n";
  for (std::size_t e = 0; e < problem.mesh.elements().size(); ++e) {
    deck << e + 1;
    for (const std::int32_t i : problem.mesh.elements()[e]) deck << ',' << i + 1;
    deck << '\n';
  }
  deck << "*MATERIAL, NAME=M\n" << material(scene) << "*SOLID SECTION, ELSET=E, MATERIAL=M\n";
  // Forces to 1e-7 of their mean, as our own methods do, and what it expects to be left of the correction to
  // 1e-7 of the increment, where half a percent and one percent are usual: quadratic convergence makes an
  // iteration or two of it. The last number: no exception after many iterations.
  deck << "*STEP, NLGEOM, INC=1000\n*CONTROLS, PARAMETERS=FIELD, "
          "FIELD=DISPLACEMENT\n1.E-7,1.E-7,,,1.E-7\n"
       << (solve ? "*STATIC, SOLVER=SPOOLES\n" : "*NO ANALYSIS\n");
  if (solve) deck << 1.0 / scene.load_steps << ",1.,1.E-6,1.\n";
  deck << "*BOUNDARY\n";
  for (const auto& h : problem.held)
    deck << h.node + 1 << ',' << h.axis + 1 << ',' << h.axis + 1 << ',' << h.u << '\n';
  std::ostringstream forces;
  forces.precision(12);
  for (std::size_t i = 0; i < problem.forces.size(); ++i)
    for (int a = 0; a < 3; ++a)
      if (problem.forces[i][a] != 0)
        forces << i + 1 << ',' << a + 1 << ',' << problem.forces[i][a] / unit_of(scene) << '\n';
  if (!forces.str().empty()) deck << "*CLOAD\n" << forces.str();
  deck << "*NODE PRINT, NSET=N, FREQUENCY=100000\nU\n*END STEP\n";
  return deck.str();
}

// Displacements of all nodes at the end of the step; empty if it was not reached.
std::vector<Vec> read_displacements(const fs::path& file, std::size_t nodes) {
  std::ifstream in(file);
  std::vector<Vec> u(nodes, Vec::Constant(is_free));
  bool at_end = false;
  for (std::string line; std::getline(in, line);) {
    if (const auto time = line.find("time"); time != std::string::npos) {
      at_end = std::abs(std::strtod(line.c_str() + time + 4, nullptr) - 1) < 1e-6;
      continue;
    }
    std::istringstream words(line);
    std::size_t node = 0;
    Vec value;
    if (at_end && words >> node >> value[0] >> value[1] >> value[2] && node >= 1 && node <= nodes)
      u[node - 1] = value;
  }
  const bool all = std::all_of(u.begin(), u.end(), [](const Vec& v) { return v.allFinite(); });
  return all ? u : std::vector<Vec>();
}

template <class Mesh>
PeerRun run_deck(const Scene& scene, const Problem<Mesh>& problem, const std::string& element, double start) {
  const TemporaryFolder folder;
  for (const bool solve : {false, true})
    std::ofstream(folder.path() / (solve ? "solve.inp" : "check.inp"))
        << deck_of(scene, problem, element, solve);
  PeerRun run;
  run.other_law = has_law<softsim::NeoHookean>(scene);
  const double written = process_seconds() - start;
  // of what is quick, the quicker of two
  Ended check = run_ccx(folder.path(), "check");
  if (check.seconds < 0.2) check.seconds = std::min(check.seconds, run_ccx(folder.path(), "check").seconds);
  const Ended solve = run_ccx(folder.path(), "solve");
  run.setup_seconds = written + check.seconds;
  run.seconds = std::max(solve.seconds - check.seconds, 1e-4);  // one may be as quick as the other
  run.memory = solve.memory;
  const std::vector<Vec> u = read_displacements(folder.path() / "solve.dat", problem.mesh.points().size());
  if (!solve.started || solve.code == 127)
    run.status = "not_started";
  else if (!solve.in_time)
    run.status = "out_of_time";
  else if (solve.code > 128 && solve.code != 201)  // 201: it gave up itself
    run.status = "crashed";
  else
    run.status = solve.code == 0 && !u.empty() ? "converged" : "not_converged";
  if (run.status == "converged") run.u = problem.at_probes(u);
  return run;
}

template <class Make>
Peer calculix(const std::string& name, const std::string& element, Make make) {
  return {name, "peer", "static", "spooles", "-", "double", [=](const Scene& scene, int resolution) {
            const double start = process_seconds();
            return run_deck(scene, make(scene, resolution), element, start);
          }};
}

}  // namespace

std::vector<Peer> calculix_peers() {
  return {calculix("calculix_tet4", "C3D4", tet4_problem), calculix("calculix_tet10", "C3D10", tet10_problem),
          calculix("calculix_hex8", "C3D8", hex8_problem)};
}

}  // namespace chart
