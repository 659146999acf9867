// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "io/temporary_folder.hpp"
#include "softsim/core/tensor.hpp"

extern char** environ;

namespace softsim::test {

using Words = std::vector<std::string>;

inline Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// "a b  c" cut at its spaces.
inline Words words(const std::string& text) {
  std::istringstream stream(text);
  Words result;
  for (std::string word; stream >> word;) result.push_back(word);
  return result;
}

/// How a program ended and what it said.
struct Ended {
  int code = -1;  ///< -1: killed by a signal or not started
  std::string out, err;
};

/// Runs the program in a folder of its own, which goes with this object.
class Deform {
 public:
  Ended run(const Words& arguments) {
    Words line{DEFORM_PROGRAM};
    line = line + arguments;
    std::vector<char*> argv;
    for (std::string& word : line) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t streams;
    posix_spawn_file_actions_init(&streams);
    constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&streams, 1, said_.path("out").c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&streams, 2, said_.path("err").c_str(), flags, 0600);
    const auto here = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    pid_t child = 0;
    const int error = posix_spawn(&child, DEFORM_PROGRAM, &streams, nullptr, argv.data(), environ);
    std::filesystem::current_path(here);
    posix_spawn_file_actions_destroy(&streams);
    int status = 0;
    if (error != 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return {};
    return {WEXITSTATUS(status), slurp(said_.path("out")), slurp(said_.path("err"))};
  }

  TemporaryFolder folder;  ///< the program's working folder

 private:
  TemporaryFolder said_;
};

/// The entries of a flat JSON object as they are written, strings with their quotation marks. Fails the test
/// if the text is no such object or a key is repeated.
inline std::map<std::string, std::string> flat_json(const std::string& text) {
  static const std::regex entry(
      R"re(\s*"([^"\\]*)"\s*:\s*)re"
      R"re(("([^"\\]|\\["\\/bfnrt])*"|null|-?(0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?)\s*([,}]))re");
  std::map<std::string, std::string> entries;
  std::smatch found;
  auto at = text.cbegin();
  if (at == text.cend() || *at++ != '{') ADD_FAILURE() << "no JSON object: '" << text << "'";
  for (bool more = at != text.cend(); more; more = found[7] == ",") {
    if (!std::regex_search(at, text.cend(), found, entry, std::regex_constants::match_continuous)) {
      ADD_FAILURE() << "no JSON from here on: " << std::string(at, text.cend());
      return entries;
    }
    EXPECT_TRUE(entries.emplace(found[1], found[2]).second) << found[1] << " is repeated";
    at = found[0].second;
  }
  EXPECT_EQ(std::string(at, text.cend()), "\n");
  return entries;
}

/// What summary.json says.
class Summary {
 public:
  explicit Summary(const std::string& folder) : entries_(flat_json(slurp(folder + "/summary.json"))) {}

  bool has(const std::string& key) const { return entries_.count(key) > 0; }
  /// As it is written.
  std::string text(const std::string& key) const {
    const auto found = entries_.find(key);
    if (found == entries_.end()) ADD_FAILURE() << "summary.json has no " << key;
    return found == entries_.end() ? "" : found->second;
  }
  /// NaN if it is not a number.
  double operator[](const std::string& key) const {
    const std::string value = text(key);
    return value.empty() || value == "null" || value[0] == '"' ? std::nan("")
                                                               : std::strtod(value.c_str(), nullptr);
  }

 private:
  std::map<std::string, std::string> entries_;
};

/// One state of a series: the arrays of 8-byte numbers that its .vtu file holds, each found by its name.
class State {
 public:
  explicit State(const std::string& path)
      : text_(slurp(path)), data_(text_.find("<AppendedData encoding=\"raw\">")) {
    data_ = data_ == std::string::npos ? data_ : text_.find('_', data_) + 1;
    EXPECT_NE(data_, std::string::npos) << path << " holds no data";
    const std::string end = "\n  </AppendedData>\n</VTKFile>\n";
    EXPECT_TRUE(text_.ends_with(end)) << path << " is cut off";
  }

  std::vector<double> scalars(const std::string& name) const {
    const std::regex tag("<DataArray type=\"Float64\" Name=\"" + name + "\"[^>]* offset=\"(\\d+)\"/>");
    std::smatch found;
    const std::string head = text_.substr(0, data_);
    if (!std::regex_search(head, found, tag)) {
      ADD_FAILURE() << "no array " << name;
      return {};
    }
    const std::size_t at = data_ + std::stoul(found[1]);
    std::uint64_t bytes = 0;
    if (at + sizeof bytes <= text_.size()) std::memcpy(&bytes, text_.data() + at, sizeof bytes);
    if (bytes == 0 || at + sizeof bytes + bytes > text_.size()) {
      ADD_FAILURE() << "array " << name << " is cut off";
      return {};
    }
    std::vector<double> values(bytes / sizeof(double));
    std::memcpy(values.data(), text_.data() + at + sizeof bytes, bytes);
    return values;
  }
  std::vector<Vec3<double>> vectors(const std::string& name) const {
    const std::vector<double> v = scalars(name);
    std::vector<Vec3<double>> result(v.size() / 3);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    return result;
  }

 private:
  std::string text_;
  std::size_t data_;
};

/// A .pvd with its states, all of which must be there.
struct Series {
  explicit Series(const std::string& folder) {
    const std::string pvd = slurp(folder + "/deform.pvd");
    EXPECT_NE(pvd.find("</VTKFile>"), std::string::npos) << folder << "/deform.pvd is missing or cut off";
    const std::regex entry("<DataSet timestep=\"([^\"]*)\"[^>]* file=\"([^\"]*)\"/>");
    for (std::sregex_iterator e(pvd.begin(), pvd.end(), entry), end; e != end; ++e) {
      times.push_back(std::stod((*e)[1]));
      states.emplace_back(folder + "/" + (*e)[2].str());
    }
    EXPECT_FALSE(states.empty());
  }

  std::vector<double> times;
  std::vector<State> states;
};

}  // namespace softsim::test
