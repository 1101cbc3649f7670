#include "pipeline/config/yaml_document.h"

#include <fmt/format.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <optional>
#include <set>
#include <sstream>
#include <vector>

namespace periost {
namespace {

struct Problem {
  const char* code;
  SourcePlace place;
  std::string text;
  std::string hint;
};

SourcePlace place_of(const std::string& file, const YAML::Mark& mark) {
  if (mark.is_null()) return {file, 0, 0};
  return {file, mark.line + 1, mark.column + 1};
}

// Builds Values from the parser's events. Unlike the library's own tree it is told of the depth before the
// parser descends, sees every duplicate key, and knows what was in quotes. The first fatal problem ends
// parsing.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& file, Diagnostics& diagnostics) : file_(file), diagnostics_(diagnostics) {}

  Value root;

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    if (expects_key()) fail("config.bad_key", mark, "a key is missing");
    Value null;
    null.place = place_of(file_, mark);
    // The parser's mark of a value left out is that of the next token: the key tells more.
    if (!levels_.empty() && levels_.back().pending) null.place = levels_.back().pending->place;
    place(std::move(null));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { refuse_anchor(mark, 1); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    Value value = Value::scalar(text);
    value.is_quoted = tag == "!";
    add(std::move(value), mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open(mark, tag, anchor, Value::list({}));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open(mark, tag, anchor, Value::map({}));
  }
  void OnMapEnd() override { close(); }

 private:
  // A list or map that is still being filled.
  struct Level {
    Value value;
    std::set<std::string> keys;
    std::optional<Value::Entry> pending;  // a key whose value is still to come
  };

  [[noreturn]] void fail(const char* code, const YAML::Mark& mark, std::string text, std::string hint = {}) {
    throw Problem{code, place_of(file_, mark), std::move(text), std::move(hint)};
  }
  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) fail("config.anchor", mark, "anchors and aliases are not taken", "write the value out");
  }
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    const bool is_plain = tag.empty() || tag == "?" || tag == "!";
    if (!is_plain) fail("config.tag", mark, fmt::format("the tag '{}' is not taken", tag), "remove it");
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Value value) {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    if (levels_.size() >= static_cast<std::size_t>(kDeepestDocument)) {
      fail("config.too_deep", mark,
           fmt::format("lists and maps are nested more than {} deep", kDeepestDocument));
    }
    if (expects_key())
      fail("config.bad_key", mark, "a key must be a text, not a list or map", "is a bracket left open?");
    value.place = place_of(file_, mark);
    levels_.push_back({std::move(value), {}, std::nullopt});
  }
  void close() {
    Value value = std::move(levels_.back().value);
    levels_.pop_back();
    place(std::move(value));
  }

  bool expects_key() const {
    return !levels_.empty() && levels_.back().value.kind == Value::Kind::kMap && !levels_.back().pending;
  }
  void add(Value value, const YAML::Mark& mark) {
    value.place = place_of(file_, mark);
    if (expects_key())
      take_key(value, mark);
    else
      place(std::move(value));
  }
  void take_key(const Value& key, const YAML::Mark& mark) {
    if (key.kind != Value::Kind::kScalar || key.text.empty())
      fail("config.bad_key", mark, "a key is missing");
    if (key.text == "<<" && !key.is_quoted) {
      fail("config.merge_key", mark, "the merge key '<<' is not taken", "write the keys out");
    }
    Level& level = levels_.back();
    if (!level.keys.insert(key.text).second) {
      diagnostics_.push_back({Severity::kError,
                              "config.duplicate_key",
                              {},
                              key.text,
                              key.place,
                              fmt::format("key '{}' is given twice", key.text),
                              "keep one of them"});
    }
    level.pending = Value::Entry{key.text, key.place, {}};
  }
  // Puts a finished value where it belongs; a duplicate's is dropped.
  void place(Value value) {
    if (levels_.empty()) {
      root = std::move(value);
      return;
    }
    Level& level = levels_.back();
    if (level.value.kind == Value::Kind::kList) {
      level.value.items.push_back(std::move(value));
      return;
    }
    Value::Entry entry = std::move(*level.pending);
    level.pending.reset();
    if (level.value.find(entry.key) != nullptr) return;
    entry.value = std::move(value);
    level.value.entries.push_back(std::move(entry));
  }

  const std::string& file_;
  Diagnostics& diagnostics_;
  std::vector<Level> levels_;
};

// Bytes of the UTF-8 character that starts at text[i], or 0 if there is none.
std::size_t utf8_length(const std::string& text, std::size_t i) {
  const auto byte = [&](std::size_t at) {
    return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
  };
  const unsigned lead = byte(i);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 && lead < 0xF5 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC2 ? 2 : 0;
  if (lead >= 0xF5 || length == 0) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0u) != 0x80u) return 0;
  }
  const unsigned second = byte(i + 1);
  const bool is_overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool is_outside = (lead == 0xED && second > 0x9F) || (lead == 0xF4 && second > 0x8F);
  return is_overlong || is_outside ? 0 : length;
}

// What must be refused before the parser sees the text.
void check_characters(const std::string& text, const std::string& file) {
  if (text.size() > kLargestDocument) {
    throw Problem{"config.too_large",
                  {file, 0, 0},
                  fmt::format("the file has more than {} bytes", kLargestDocument),
                  "is it a configuration?"};
  }
  SourcePlace place{file, 1, 1};
  bool is_indentation = true;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) throw Problem{"config.syntax", place, "the text is not UTF-8", {}};
    const char c = text[i];
    if ((c >= 0 && c < ' ' && c != '\n' && c != '\r' && c != '\t') || c == '\x7F') {
      throw Problem{"config.syntax", place, "there is a control character", "is it a text file?"};
    }
    if (c == '\t' && is_indentation) {
      throw Problem{"config.tab", place, "a tab stands in the indentation", "indent with blanks"};
    }
    is_indentation = c == '\n' || (is_indentation && c == ' ');
    i += length;
    if (c == '\n')
      place = {file, place.line + 1, 1};
    else
      ++place.column;
  }
}

void parse_into(TreeBuilder& builder, const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  parser.HandleNextDocument(builder);
  Diagnostics ignored;
  TreeBuilder second(file, ignored);
  if (parser && parser.HandleNextDocument(second)) {
    throw Problem{"config.syntax", second.root.place, "a second document starts here",
                  "keep one document a file"};
  }
}

}  // namespace

Value parse_yaml(const std::string& text, const std::string& file, Diagnostics& diagnostics) {
  TreeBuilder builder(file, diagnostics);
  const auto add = [&](const Problem& problem) {
    diagnostics.push_back(
        {Severity::kError, problem.code, {}, {}, problem.place, problem.text, problem.hint});
  };
  try {
    check_characters(text, file);
    parse_into(builder, text, file);
  } catch (const Problem& problem) {
    add(problem);
  } catch (const YAML::DeepRecursion& error) {
    add({"config.too_deep", place_of(file, error.mark), "lists and maps are nested too deep", {}});
  } catch (const YAML::Exception& error) {
    add({"config.syntax", place_of(file, error.mark), "this is not YAML: " + error.msg, {}});
  }
  return std::move(builder.root);
}

}  // namespace periost
