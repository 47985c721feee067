#pragma once
#include <Eigen/Core>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/slice/result.h"

namespace sonoloft {

/// Reads numbers and words out of text, whatever the locale. The first error stays: from then on every read gives 0 or
/// an empty word, so that callers check once a loop. Errors say "name:line: cause: remedy".
class TextScanner {
 public:
  TextScanner(std::string_view text, std::string_view name, std::size_t first_line = 1)
      : text_(text), name_(name), line_(first_line) {}

  /// True at the end of the text (blanks do not count).
  bool at_end() {
    skip_blanks();
    return next_ == text_.size();
  }

  /// The next run of characters that are no blanks; empty at the end of the text, which is an error.
  std::string_view word(std::string_view what) {
    if (failed()) return {};
    if (at_end()) {
      set_error(ErrorCode::parse_failed,
                std::string("the text ends where ").append(what).append(" is due: it is truncated"));
      return {};
    }
    const std::size_t first = next_;
    while (next_ < text_.size() && !is_blank(text_[next_])) ++next_;
    return text_.substr(first, next_ - first);
  }

  /// A finite number.
  double real(std::string_view what) {
    double value = 0;
    std::string_view digits = word(what);
    if (failed()) return 0;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
      set_error(ErrorCode::parse_failed, std::string(what) + " is no number: mend the line");
    else if (error != std::errc{} || !std::isfinite(value))
      set_error(ErrorCode::non_finite, std::string(what) + " is not finite: mend the line");
    return failed() ? 0 : value;
  }

  Eigen::Vector3d vector(std::string_view what) {
    const double x = real(what), y = real(what), z = real(what);
    return {x, y, z};
  }

  /// A whole number of 0..max. Above max is the error `beyond`.
  std::uint64_t whole(std::string_view what, std::uint64_t max, ErrorCode beyond = ErrorCode::too_large) {
    return whole_from(word(what), what, max, beyond);
  }

  /// A number of things that are still to come and take at least `bytes_each` of the text: what is declared without
  /// being there is an error before anybody makes room for it.
  std::size_t count(std::string_view what, std::uint64_t max, std::size_t bytes_each) {
    const std::uint64_t value = whole(what, max);
    if (!failed() && value > (text_.size() - next_) / bytes_each)
      set_error(ErrorCode::parse_failed, "the file is too short for " + std::string(what) + " of " +
                                             std::to_string(value) + ": it is truncated");
    return failed() ? 0 : static_cast<std::size_t>(value);
  }

  std::uint64_t whole_from(std::string_view digits, std::string_view what, std::uint64_t max, ErrorCode beyond) {
    std::uint64_t value = 0;
    if (failed()) return 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
      set_error(ErrorCode::parse_failed, std::string(what) + " is no whole number: mend the line");
    else if (error != std::errc{} || value > max)
      set_error(beyond, std::string(what) + " is above " + std::to_string(max) + ": mend the line");
    return failed() ? 0 : value;
  }

  /// Goes on behind the end of this line.
  void skip_line() {
    const std::size_t end = text_.find('\n', next_);
    next_ = end == std::string_view::npos ? text_.size() : end + 1;
    ++line_;
  }

  std::size_t offset() const { return next_; }
  std::size_t line() const { return line_; }
  bool failed() const { return error_.has_value(); }
  /// @pre failed()
  tl::unexpected<Error> failure() const { return tl::unexpected(*error_); }

  void set_error(ErrorCode code, const std::string& message) {
    if (!failed()) error_ = Error{code, name_ + ":" + std::to_string(line_) + ": " + message};
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\v' || c == '\f'; }

  void skip_blanks() {
    for (; next_ < text_.size() && is_blank(text_[next_]); ++next_) line_ += text_[next_] == '\n';
  }

  std::string_view text_;
  std::string name_;
  std::size_t next_ = 0;
  std::size_t line_;
  std::optional<Error> error_;
};

}  // namespace sonoloft
