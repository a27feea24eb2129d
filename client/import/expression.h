#ifndef FASCICLE_CLIENT_IMPORT_EXPRESSION_H_
#define FASCICLE_CLIENT_IMPORT_EXPRESSION_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fascicle::client {

// A formula of one variable: + - * / ^, parentheses, numbers, pi, and the functions of FEBio's expressions that have
// one or two arguments [FEBio User Manual, appendix C].
class Expression {
 public:
  // `variable` is the name of the variable; none if empty. Nothing, with `mistake` set, if the text is no such formula.
  static std::optional<Expression> Parse(std::string_view text, std::string_view variable, std::string& mistake);

  // The value; not finite outside of the domain.
  double At(double variable) const;

  // An operation on a stack of numbers.
  struct Operation {
    enum class Kind { kNumber, kVariable, kOne, kTwo };
    Kind kind = Kind::kNumber;
    double number = 0;
    double (*one)(double) = nullptr;
    double (*two)(double, double) = nullptr;
  };

 private:
  std::vector<Operation> operations_;  // in postfix order
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_EXPRESSION_H_
