// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "softsim/core/error.hpp"

namespace softsim::detail {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A word of a file in quotation marks, made fit for a one-line message.
[[nodiscard]] inline std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 60;
  std::string text = "'";
  for (const char c : word.substr(0, longest)) text += c >= 0 && c < ' ' ? '?' : c;
  return text + (word.size() > longest ? "...'" : "'");
}

/// The whole of a text file, without a byte order mark.
/// @throws std::invalid_argument if it cannot be read, is empty or holds a zero byte (binary data)
[[nodiscard]] inline std::string read_text(const std::string& path) {
  const auto refuse = [&](const std::string& why) { invalid(path + ": " + why); };
  const auto reason = [] { return std::string(" (") + std::generic_category().message(errno) + ")"; };
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) refuse(std::string("cannot be opened") + reason());
  std::string text;
  char block[1 << 16];
  while (const std::size_t n = std::fread(block, 1, sizeof block, file.get())) text.append(block, n);
  if (std::ferror(file.get()) != 0) refuse(std::string("cannot be read") + reason());
  if (text.empty()) refuse("the file is empty");
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos) {
    const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n') + 1;
    invalid(
        path + ", line " + std::to_string(line) +
        ": binary data stands where text was expected; write the file as ASCII or convert it with meshio");
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

/// Reads words and numbers from a stretch of a file and knows the line it stands on. Numbers are read
/// independently of the locale. Every refusal is a `std::invalid_argument` "path, line n: ...". It refers to
/// the path and the text that it was made from, which must outlive it; copies are cheap and read on from the
/// same place.
class Scanner {
 public:
  Scanner(const std::string& path, std::string_view text, std::size_t line = 1)
      : path_(&path), text_(text), line_(line) {}

  [[nodiscard]] std::size_t line_number() const { return line_; }

  [[noreturn]] void fail(const std::string& message) const {
    invalid(*path_ + ", line " + std::to_string(line_) + ": " + message);
  }

  /// Whether nothing but white space follows; steps over it.
  [[nodiscard]] bool at_end() {
    skip_space();
    return text_.empty();
  }
  /// Whether the text stops right here, without so much as a line end.
  [[nodiscard]] bool exhausted() const { return text_.empty(); }

  /// How many entries of `words` words each the rest of the text can hold at most.
  [[nodiscard]] std::size_t room(std::size_t words) const { return text_.size() / (2 * words) + 1; }

  /// Line of the next word, or the last line.
  [[nodiscard]] std::size_t next_line_number() {
    skip_space();
    return line_;
  }
  /// The next word, which stays unread; empty at the end.
  [[nodiscard]] std::string_view peek() {
    skip_space();
    std::size_t n = 0;
    while (n < text_.size() && !is_space(text_[n])) ++n;
    return text_.substr(0, n);
  }
  /// The next word; `what` names it in the refusal if there is none.
  std::string_view word(std::string_view what) {
    const std::string_view w = peek();
    if (w.empty()) fail(std::string(what) + " is missing");
    text_.remove_prefix(w.size());
    return w;
  }

  /// What is left of the current line, possibly nothing.
  Scanner rest_of_line() {
    const std::size_t n = text_.find('\n');
    const Scanner rest(*path_, text_.substr(0, n), line_);
    if (n == std::string_view::npos) {
      text_ = {};
    } else {
      text_.remove_prefix(n + 1);
      ++line_;
    }
    return rest;
  }
  /// The next line that is not blank.
  Scanner line(std::string_view what) {
    if (at_end()) fail(std::string("the file ends where ") + std::string(what) + " was expected");
    return rest_of_line();
  }
  /// Refuses anything that is left over.
  void finish() {
    if (!at_end()) fail(in_quotes(peek()) + " is one entry too many in this line");
  }

  /// A whole number in [lowest, highest].
  long long integer(std::string_view what, long long lowest, long long highest) {
    const std::string_view w = word(what);
    long long value = 0;
    const std::errc error = parse(w, value);
    if (error == std::errc::invalid_argument)
      fail(std::string(what) + " " + in_quotes(w) + " is not an integer");
    if (error != std::errc() || value < lowest || value > highest)
      fail(std::string(what) + " " + in_quotes(w) + " is out of range (" + std::to_string(lowest) + " to " +
           std::to_string(highest) + ")");
    return value;
  }

  /// A number of entries that a file announces, at most `most`, which follows from the size of the file.
  std::size_t count(std::string_view what, std::size_t most) {
    const std::string_view w = word(what);
    long long value = 0;
    const std::errc error = parse(w, value);
    if (error == std::errc::invalid_argument)
      fail(std::string(what) + " " + in_quotes(w) + " is not an integer");
    if (w.front() == '-' && (value < 0 || error != std::errc()))
      fail(std::string(what) + " " + in_quotes(w) + " is negative");
    constexpr std::size_t highest_index = 2147483647;
    if (error != std::errc() || static_cast<std::size_t>(value) > std::min(most, highest_index))
      fail(std::string(what) + " " + in_quotes(w) + " is more than the file can hold");
    return static_cast<std::size_t>(value);
  }

  /// A finite number.
  double real(std::string_view what) {
    const std::string_view w = word(what);
    double value = 0;
    const std::errc error = parse(w, value);
    if (error == std::errc::invalid_argument)
      fail(std::string(what) + " " + in_quotes(w) + " is not a number");
    if (error != std::errc()) fail(std::string(what) + " " + in_quotes(w) + " is out of range");
    if (!std::isfinite(value)) fail(std::string(what) + " " + in_quotes(w) + " is not a finite number");
    return value;
  }

  /// A number without a fractional part that fits an int, in whatever notation.
  int integer_valued(std::string_view what) {
    Scanner before = *this;
    const double value = real(what);
    if (std::abs(value) > 2147483647.0 || value != std::floor(value)) {
      const std::string_view w = before.word(what);
      fail(std::string(what) + " " + in_quotes(w) + " is not an integer of 32 bits");
    }
    return static_cast<int>(value);
  }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  void skip_space() {
    std::size_t n = 0;
    for (; n < text_.size() && is_space(text_[n]); ++n)
      if (text_[n] == '\n') ++line_;
    text_.remove_prefix(n);
  }

  template <class Number>
  static std::errc parse(std::string_view w, Number& value) {
    // std::from_chars takes no plus sign, which is legal in all the formats.
    if (w.size() > 1 && w[0] == '+' && w[1] != '-') w.remove_prefix(1);
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    return end == w.data() + w.size() ? error : std::errc::invalid_argument;
  }

  const std::string* path_;
  std::string_view text_;
  std::size_t line_;
};

}  // namespace softsim::detail
