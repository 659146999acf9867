// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <spawn.h>
#include <sys/wait.h>

#include <string>
#include <vector>

extern char** environ;

// How the examples draw: by a Python script beside their source.

namespace picture {

/// Runs a program and says whether it ended well.
inline bool runs(std::vector<std::string> words, bool quiet = false) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  if (quiet) posix_spawn_file_actions_addopen(&streams, 2, "/dev/null", 1, 0);
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], &streams, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  int status = 0;
  return error == 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// The first Python that has numpy and matplotlib; empty if there is none.
inline std::string drawing_python() {
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (runs({python, "-c", "import matplotlib, numpy"}, true)) return python;
  return {};
}

}  // namespace picture
