#include "apps/report/typeset.h"

#include <fmt/format.h>

#include <cctype>
#include <map>

#include "apps/report/numbers.h"

namespace grainlaw::report {
namespace {

const std::map<std::string_view, std::string_view>& symbols() {
  static const std::map<std::string_view, std::string_view> known = {
      {"I", "<i>I</i>"},
      {"I_mu", "<i>I<sub>μ</sub></i>"},
      {"I_phi", "<i>I<sub>φ</sub></i>"},
      {"L_2", "<i>L</i><sub>2</sub>"},
      {"N_c", "<i>N<sub>c</sub></i>"},
      {"N_eff", "<i>N</i><sub>eff</sub>"},
      {"R_c", "<i>R<sub>c</sub></i>"},
      {"R_s", "<i>R<sub>s</sub></i>"},
      {"Xi", "<i>Ξ</i>"},
      {"alpha", "<i>α</i>"},
      {"beta", "<i>β</i>"},
      {"c0", "<i>c</i><sub>0</sub>"},
      {"chi", "<i>χ</i>"},
      {"d_c", "<i>d<sub>c</sub></i>"},
      {"d_eff", "<i>d</i><sub>eff</sub>"},
      {"delta", "<i>δ</i>"},
      {"f_B", "<i>f<sub>B</sub></i>"},
      {"f_a", "<i>f<sub>a</sub></i>"},
      {"f_p", "<i>f<sub>p</sub></i>"},
      {"g_c", "<i>g<sub>c</sub></i>"},
      {"g_p", "<i>g<sub>p</sub></i>"},
      {"gd", "<i>γ̇</i>"},
      {"h_stop", "<i>h</i><sub>stop</sub>"},
      {"k_n", "<i>k<sub>n</sub></i>"},
      {"kappa", "<i>κ</i>"},
      {"mu", "<i>μ</i>"},
      {"mu0", "<i>μ</i><sub>0</sub>"},
      {"mu_inf", "<i>μ</i><sub>∞</sub>"},
      {"mu_p", "<i>μ<sub>p</sub></i>"},
      {"p1", "<i>p</i><sub>1</sub>"},
      {"p2", "<i>p</i><sub>2</sub>"},
      {"p3", "<i>p</i><sub>3</sub>"},
      {"p4", "<i>p</i><sub>4</sub>"},
      {"p_mu", "<i>p<sub>μ</sub></i>*"},
      {"p_phi", "<i>p<sub>φ</sub></i>*"},
      {"phi", "<i>φ</i>"},
      {"phi0", "<i>φ</i><sub>0</sub>"},
      {"rho_p", "<i>ρ<sub>p</sub></i>"},
      {"sigma_xy", "<i>σ<sub>xy</sub></i>"},
      {"sigma_xz", "<i>σ<sub>xz</sub></i>"},
      {"sigma_yy", "<i>σ<sub>yy</sub></i>"},
      {"sigma_zz", "<i>σ<sub>zz</sub></i>"},
      {"sqrt", "√"},
      {"t_mean", "<i>t</i><sub>mean</sub>"},
      {"t_mode", "<i>t</i><sub>mode</sub>"},
      {"tau", "<i>τ</i>"},
      {"tau_c", "<i>τ<sub>c</sub></i>"},
      {"tau_l", "<i>τ<sub>l</sub></i>"},
      {"theta", "<i>θ</i>"},
      {"u", "<i>u</i>"},
      {"z", "<i>z</i>"}};
  return known;
}

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

bool is_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Reads a sentence from left to right.
class Typesetter {
 public:
  explicit Typesetter(std::string_view plain) : rest_(plain) {}

  Html result() {
    while (!rest_.empty()) next();
    return result_;
  }

 private:
  void next() {
    if (is_letter(rest_.front())) return word();
    if (take("+-")) return add("±");
    if (take(" %")) return add("\u00a0%");
    if (rest_.starts_with(")e") && rest_.size() > 2 && power_of_bracket()) return;
    if (rest_.starts_with("p*")) return add("<i>p</i>*");
    if (rest_.front() == '^' && rest_.size() > 1 && is_letter(rest_[1])) return power();
    const bool sign = rest_.front() == '-' && rest_.size() > 1 && is_digit(rest_[1]);
    if (sign && (last_ == ' ' || last_ == '(' || last_ == '\0' || last_ == '[')) {
      rest_.remove_prefix(1);
      return add("−");
    }
    last_ = rest_.front();
    result_ += text(rest_.substr(0, 1));
    rest_.remove_prefix(1);
  }

  bool take(std::string_view start) {
    if (!rest_.starts_with(start)) return false;
    rest_.remove_prefix(start.size());
    return true;
  }

  void add(std::string_view markup) {
    result_.markup += markup;
    last_ = 'x';
  }

  /// Letters, digits and underscores; points only inside, as in names of files.
  std::string_view read_word() {
    std::size_t end = 0;
    while (end < rest_.size() &&
           (is_letter(rest_[end]) ||
            (rest_[end] == '.' && end > 0 && end + 1 < rest_.size() && is_letter(rest_[end + 1]))))
      ++end;
    const std::string_view result = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return result;
  }

  void word() {
    if (is_digit(rest_.front()) && number()) return;
    const std::string_view word = read_word();
    const bool starred = word == "p" && rest_.starts_with("*");
    if (starred) {
      rest_.remove_prefix(1);
      return add("<i>p</i>*");
    }
    if (word == "deg" && result_.markup.ends_with(' ')) {
      result_.markup.pop_back();
      return add("°");
    }
    if (word == "us" && follows_number()) return add("µs");
    const auto known = symbols().find(word);
    // part of a name with dashes, as in a path; a ratio of two symbols is none
    const bool ratio = result_.markup.ends_with("</sub>/") || result_.markup.ends_with("</i>/");
    const bool named = (last_ == '/' && !ratio) || last_ == '-';
    if (known != symbols().end() && !(named && word.size() > 2)) return add(known->second);
    const bool is_name = word.find('_') != word.npos && last_ != '/' && !rest_.starts_with("/");
    result_ += is_name ? code(word) : text(word);
    last_ = 'x';
  }

  /// "7 "
  bool follows_number() const {
    const std::string& text = result_.markup;
    return text.size() > 1 && text.back() == ' ' && is_digit(text[text.size() - 2]);
  }

  /// "1.2e-06", "3e+08" and "2e5"; false: no number with a power of ten.
  bool number() {
    std::size_t end = 0;
    while (end < rest_.size() && (is_digit(rest_[end]) || rest_[end] == '.')) ++end;
    if (end + 1 >= rest_.size() || rest_[end] != 'e') return false;
    const std::size_t digits = end + (rest_[end + 1] == '-' || rest_[end + 1] == '+' ? 2 : 1);
    std::size_t last = digits;
    while (last < rest_.size() && is_digit(rest_[last])) ++last;
    if (last == digits || (last < rest_.size() && is_letter(rest_[last]))) return false;
    const int power = std::stoi(std::string(rest_.substr(end + 1, last - end - 1)));
    const std::string times = power_of_ten(power);
    const std::string_view factor = rest_.substr(0, end);
    const bool alone = factor == "1" && last_ != '.';
    add(alone ? times.substr(times.find("10")) : std::string(factor) + times);
    rest_.remove_prefix(last);
    return true;
  }

  /// ")e-07" of "(3.19 +- 0.24)e-07"
  bool power_of_bracket() {
    std::size_t end = rest_[2] == '-' || rest_[2] == '+' ? 3 : 2;
    const std::size_t digits = end;
    while (end < rest_.size() && is_digit(rest_[end])) ++end;
    if (end == digits) return false;
    add(")");
    add(power_of_ten(std::stoi(std::string(rest_.substr(2, end - 2)))));
    rest_.remove_prefix(end);
    return true;
  }

  void power() {
    rest_.remove_prefix(1);
    const std::string_view word = read_word();
    const auto known = symbols().find(word);
    add(known == symbols().end() ? "<sup>" + text(word).markup + "</sup>"
                                 : fmt::format("<sup>{}</sup>", known->second));
  }

  std::string_view rest_;
  Html result_;
  char last_ = '\0';
};

void replace_all(std::string& in, std::string_view what, std::string_view by) {
  std::string out;
  std::size_t begin = 0;
  for (std::size_t at = in.find(what); at != std::string::npos; at = in.find(what, begin)) {
    out.append(in, begin, at - begin).append(by);
    begin = at + what.size();
  }
  in = out.append(in, begin);
}

}  // namespace

Html typeset(std::string_view plain) {
  return Typesetter(plain).result();
}

std::string plot_symbol(const Html& symbol) {
  std::string result = symbol.markup;
  for (const char* special : {"{", "}", "&#39;", "&quot;", "`", "@", "~", "%", "\\"}) {
    replace_all(result, special, " ");
  }
  replace_all(result, "_", "\\_");
  replace_all(result, "&amp;", "\\&");
  replace_all(result, "&lt;", "<");
  replace_all(result, "&gt;", ">");
  for (const char* tag : {"<code>", "</code>", "<wbr/>"}) replace_all(result, tag, "");
  replace_all(result, "<i>", "{/:Italic ");
  replace_all(result, "</i>", "}");
  replace_all(result, "<sub>", "_{");
  replace_all(result, "<sup>", "^{");
  replace_all(result, "</sub>", "}");
  replace_all(result, "</sup>", "}");
  return result;
}

}  // namespace grainlaw::report
