#include "pipeline/io/plist.h"

#include <fmt/format.h>

#include <stdexcept>

namespace periost {
namespace {

constexpr int kMostLevels = 32;

class Parser {
 public:
  explicit Parser(std::string_view xml) : xml_(xml) {}

  PlistNode document() {
    std::string_view tag = next_tag();
    if (name_of_tag(tag) == "plist") tag = next_tag();
    return value(tag, 0);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("{} at byte {}", what, at_));
  }

  static std::string_view name_of_tag(std::string_view tag) {
    return tag.substr(0, tag.find_first_of(" \t\r\n/"));
  }
  static bool is_empty_tag(std::string_view tag) { return tag.ends_with('/'); }

  // The inside of the next <...>, past text, comments, declarations and the document type.
  std::string_view next_tag() {
    for (;;) {
      const std::size_t open = xml_.find('<', at_);
      if (open == std::string_view::npos) fail("the property list ends early");
      const bool is_comment = xml_.substr(open, 4) == "<!--";
      const std::size_t close = is_comment ? xml_.find("-->", open) : xml_.find('>', open);
      if (close == std::string_view::npos) fail("a tag is not closed");
      at_ = close + (is_comment ? 3 : 1);
      const char first = open + 1 < close ? xml_[open + 1] : '>';
      if (first != '?' && first != '!') return xml_.substr(open + 1, close - open - 1);
    }
  }

  std::string text_until(std::string_view name) {
    const std::size_t end = xml_.find('<', at_);
    if (end == std::string_view::npos) fail("the property list ends early");
    std::string text(xml_.substr(at_, end - at_));
    at_ = end;
    if (next_tag() != fmt::format("/{}", name)) fail(fmt::format("<{}> is not closed", name));
    return text;
  }

  PlistNode value(std::string_view tag, int level) {
    if (level > kMostLevels) fail("the property list is nested too deeply");
    const std::string name(name_of_tag(tag));
    PlistNode node;
    if (name == "dict") {
      node.kind = PlistNode::Kind::kDict;
      if (!is_empty_tag(tag)) read_entries(node, level);
    } else if (name == "array") {
      node.kind = PlistNode::Kind::kArray;
      while (!is_empty_tag(tag) && (tag = next_tag()) != "/array")
        node.items.push_back(value(tag, level + 1));
    } else if (name == "true" || name == "false") {
      node.text = name;
    } else if (name == "string" || name == "integer" || name == "real" || name == "date" || name == "data") {
      if (!is_empty_tag(tag)) node.text = text_until(name);
    } else {
      fail(fmt::format("unexpected <{}>", name));
    }
    return node;
  }

  void read_entries(PlistNode& node, int level) {
    for (std::string_view tag = next_tag(); tag != "/dict"; tag = next_tag()) {
      if (tag != "key") fail("a key is missing");
      std::string key = text_until("key");
      node.entries.emplace_back(std::move(key), value(next_tag(), level + 1));
    }
  }

  std::string_view xml_;
  std::size_t at_ = 0;
};

}  // namespace

const PlistNode* PlistNode::find(std::string_view key) const {
  for (const auto& [name, value] : entries) {
    if (name == key) return &value;
  }
  return nullptr;
}

PlistNode parse_plist(std::string_view xml) {
  return Parser(xml).document();
}

}  // namespace periost
