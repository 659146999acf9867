// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "softsim/io/text.hpp"

namespace softsim::detail {

/// An element of an XML file with what stands in it.
struct XmlElement {
  std::string name;
  Scanner at;  ///< stands on the element's first line and holds no text
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;
  std::vector<Scanner> text;  ///< the stretches of text between the tags and comments, without blank ones

  /// Value of an attribute, or nullptr.
  [[nodiscard]] const std::string* attribute(std::string_view key) const {
    for (const auto& [name_, value] : attributes)
      if (name_ == key) return &value;
    return nullptr;
  }
  /// Value of an attribute that must be there.
  [[nodiscard]] const std::string& required(std::string_view key) const {
    const std::string* value = attribute(key);
    if (value == nullptr) at.fail(std::string("<") + name + "> has no attribute " + std::string(key));
    return *value;
  }
  /// The only child of that name, or nullptr.
  [[nodiscard]] const XmlElement* child(std::string_view wanted) const {
    const XmlElement* found = nullptr;
    for (const XmlElement& c : children) {
      if (c.name != wanted) continue;
      if (found != nullptr) c.at.fail(std::string("a second <") + c.name + "> in <" + name + ">");
      found = &c;
    }
    return found;
  }
  /// The only child of that name, which must be there.
  [[nodiscard]] const XmlElement& required_child(std::string_view wanted) const {
    const XmlElement* found = child(wanted);
    if (found == nullptr) at.fail(std::string("<") + name + "> holds no <" + std::string(wanted) + ">");
    return *found;
  }
};

/// Parses the part of XML that data files use: elements, attributes, comments, processing instructions, the
/// five named entities. No document types, no CDATA.
class XmlParser {
 public:
  XmlParser(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  /// The file's one outermost element.
  [[nodiscard]] XmlElement parse() {
    XmlElement document{"document", here(0), {}, {}, {}};
    // An explicit stack, bounded in depth: a hostile file must not exhaust the call stack.
    std::vector<XmlElement> open;
    open.push_back(std::move(document));
    while (position_ < text_.size()) {
      text_until_tag(open);
      if (position_ == text_.size()) break;
      if (starts("<!--"))
        pass("-->", "comment");
      else if (starts("<?"))
        pass("?>", "processing instruction");
      else if (starts("<!"))
        here(0).fail("document types and CDATA sections are not read");
      else if (starts("</"))
        close(open);
      else if (start(open))
        close_top(open);
      if (open.size() > deepest) here(0).fail("elements are nested too deeply");
    }
    if (open.size() > 1)
      open.back().at.fail(std::string("<") + open.back().name + "> is not closed; the file may be truncated");
    if (open[0].children.size() != 1) here(0).fail("the file holds no XML element");
    return std::move(open[0].children[0]);
  }

 private:
  static constexpr std::size_t deepest = 32;

  [[nodiscard]] Scanner here(std::size_t length) const {
    return Scanner(path_, text_.substr(position_, length), line_);
  }
  [[nodiscard]] bool starts(std::string_view mark) const { return text_.substr(position_).starts_with(mark); }
  [[nodiscard]] char now() const { return position_ < text_.size() ? text_[position_] : '\0'; }

  std::string_view advance(std::size_t length) {
    const std::string_view passed = text_.substr(position_, length);
    line_ += static_cast<std::size_t>(std::count(passed.begin(), passed.end(), '\n'));
    position_ += passed.size();
    return passed;
  }
  void pass(std::string_view mark, const char* what) {
    const std::size_t end = text_.find(mark, position_);
    if (end == std::string_view::npos) here(0).fail(std::string("a ") + what + " is not closed");
    advance(end + mark.size() - position_);
  }
  void skip_space() {
    advance(std::min(text_.find_first_not_of(" \t\r\n", position_), text_.size()) - position_);
  }

  void text_until_tag(std::vector<XmlElement>& open) {
    const std::size_t end = std::min(text_.find('<', position_), text_.size());
    Scanner stretch = here(end - position_);
    advance(end - position_);
    if (stretch.at_end()) return;
    if (open.size() == 1) stretch.fail(in_quotes(stretch.peek()) + " stands where an XML tag was expected");
    open.back().text.push_back(stretch);
  }

  void close_top(std::vector<XmlElement>& open) {
    XmlElement done = std::move(open.back());
    open.pop_back();
    open.back().children.push_back(std::move(done));
  }

  void close(std::vector<XmlElement>& open) {
    advance(2);
    const std::string found = name();
    if (open.size() == 1 || found != open.back().name)
      here(0).fail(std::string("</") + found + "> closes nothing" +
                   (open.size() == 1 ? "" : std::string("; <") + open.back().name + "> was opened last"));
    skip_space();
    expect('>');
    close_top(open);
  }

  /// Opens an element; true if it is closed in the same tag.
  bool start(std::vector<XmlElement>& open) {
    if (open.size() == 1 && !open[0].children.empty()) here(0).fail("a second outermost element");
    const Scanner at = here(0);
    advance(1);
    XmlElement element{name(), at, {}, {}, {}};
    for (;;) {
      skip_space();
      if (now() == '>' || now() == '/') break;
      std::string key = name();
      skip_space();
      expect('=');
      skip_space();
      if (element.attribute(key) != nullptr) here(0).fail(std::string("attribute ") + key + " is repeated");
      element.attributes.emplace_back(std::move(key), value());
    }
    const bool empty = now() == '/';
    if (empty) advance(1);
    expect('>');
    open.push_back(std::move(element));
    return empty;
  }

  std::string name() {
    const std::size_t n =
        std::min(text_.find_first_of(" \t\r\n<>/='\"&", position_), text_.size()) - position_;
    if (n == 0)
      here(0).fail(in_quotes(text_.substr(position_, 1)) + " stands where an XML name was expected");
    return std::string(advance(n));
  }

  void expect(char c) {
    if (now() != c)
      here(0).fail(in_quotes(text_.substr(position_, 1)) + " stands where " + in_quotes({&c, 1}) +
                   " was expected in a tag");
    advance(1);
  }

  std::string value() {
    const char quote = now();
    if (quote != '"' && quote != '\'') here(0).fail("an attribute's value is not in quotation marks");
    const std::size_t end = text_.find(quote, position_ + 1);
    if (end == std::string_view::npos) here(0).fail("an attribute's value is not closed");
    advance(1);
    std::string_view raw = advance(end - position_);
    advance(1);
    std::string plain;
    while (!raw.empty()) {
      std::size_t length = 1;
      char c = raw[0];
      for (const auto& [entity, meaning] : entities)
        if (raw.starts_with(entity)) {
          c = meaning;
          length = entity.size();
        }
      if (c == '&' && length == 1)
        here(0).fail(std::string("attribute value ") + in_quotes(raw) + " holds an unknown entity");
      plain += c;
      raw.remove_prefix(length);
    }
    return plain;
  }

  static constexpr std::pair<std::string_view, char> entities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};

  const std::string& path_;
  std::string_view text_;
  std::size_t position_ = 0, line_ = 1;
};

}  // namespace softsim::detail
