#pragma once
// Reads numbers and words from a text in memory, knowing the line for error messages.
#include <algorithm>
#include <charconv>
#include <string_view>

namespace periost {

class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  int line() const { return line_; }
  bool at_end() {
    skip_blanks(true);
    return at_ == end_;
  }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
  std::string_view rest() const { return {at_, bytes_left()}; }
  // Steps over bytes whatever they are. Precondition: bytes <= bytes_left().
  void skip(std::size_t bytes) {
    line_ += static_cast<int>(std::count(at_, at_ + bytes, '\n'));
    at_ += bytes;
  }

  // The next word, also on a later line; empty at the end.
  std::string_view word() {
    skip_blanks(true);
    return take_word();
  }
  // The next word of this line; empty at its end.
  std::string_view word_in_line() {
    skip_blanks(false);
    return take_word();
  }
  void skip_line() {
    while (at_ != end_ && *at_ != '\n') ++at_;
  }
  // False when the next word is not a whole number that fits.
  template <class T>
  bool number(T& value) {
    std::string_view w = word();
    if (!w.empty() && w.front() == '+') w.remove_prefix(1);
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    return error == std::errc() && end == w.data() + w.size();
  }
  // Words after it on a line are comments.
  void set_comment(char mark) { comment_ = mark; }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
  void skip_blanks(bool over_lines) {
    while (at_ != end_) {
      if (*at_ == '\n') {
        if (!over_lines) return;
        ++line_;
      } else if (comment_ != '\0' && *at_ == comment_) {
        skip_line();
        continue;
      } else if (!is_blank(*at_)) {
        return;
      }
      ++at_;
    }
  }
  std::string_view take_word() {
    const char* begin = at_;
    while (at_ != end_ && *at_ != '\n' && !is_blank(*at_)) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }

  const char* at_;
  const char* end_;
  int line_ = 1;
  char comment_ = '\0';
};

}  // namespace periost
