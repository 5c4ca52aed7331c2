// GLSL's expressions as C++: swizzles, arguments that a function writes, and the order of evaluation are what differs.
#pragma once
#include <map>

#include "native/tokens.h"

namespace lab::native {

struct Expression {
    std::string text;
    std::string root = {};                  // the variable that it is a part of
    std::string target = {}, indices = {};  // of a swizzle, which `text` reads
    Names reads = {}, writes = {};          // variables; it writes those that it passes as `out` arguments

    void add(const Expression& part) {
        text += part.text;
        reads.insert(part.reads.begin(), part.reads.end());
        writes.insert(part.writes.begin(), part.writes.end());
    }
    std::string assignable() const { return indices.empty() ? text : " swizzled<" + indices + ">(" + target + ")"; }
};

inline bool overlap(const Names& a, const Names& b) {
    return std::any_of(a.begin(), a.end(), [&](const auto& name) { return b.contains(name); });
}
// Whether the order of evaluation matters: C++ leaves it open.
inline bool depend(const Expression& a, const Expression& b) {
    return overlap(a.writes, b.reads) || overlap(b.writes, a.reads) || overlap(a.writes, b.writes);
}

class ExpressionReader : protected TokenReader {
  protected:
    using TokenReader::TokenReader;

    bool is_type(const std::string& token) const {
        return scalar_types.contains(token) || is_vector_type(token) || structs_.contains(token);
    }
    // [2][3] after a name or a type: the sizes, empty for [], and then those `of_type`.
    std::vector<std::string> dimensions(const std::vector<std::string>& of_type = {}) {
        std::vector<std::string> sizes;
        while (peek() == "[") {
            skip();
            sizes.push_back(peek() == "]" ? "" : expression().text);
            expect("]");
        }
        sizes.insert(sizes.end(), of_type.begin(), of_type.end());
        return sizes;
    }
    static std::string array_type(std::string element, const std::vector<std::string>& sizes) {
        for (auto size = sizes.rbegin(); size != sizes.rend(); ++size)
            element = size->empty() ? "auto" : "Array<" + element + ", (" + *size + ")>";
        return element;
    }

    Expression expression() {
        Expression all = assignment();
        while (peek() == ",") {
            all.text += take();
            all.add(assignment());
        }
        return all;
    }
    Expression assignment() {
        Expression left = conditional();
        static const Names operators{"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="};
        if (!operators.contains(peek())) return left;
        left.text = left.assignable();
        left.writes.insert(left.root);
        left.text += take();
        left.add(assignment());
        left.target = left.indices = "";
        return left;
    }
    Expression conditional() {
        Expression all = binary(0);
        if (peek() != "?") return all;
        all.text += take();
        all.add(expression());
        all.text += expect(":");
        all.add(assignment());
        all.root = all.indices = "";
        return all;
    }
    Expression binary(int lowest) {
        static const std::map<std::string, int> strengths{
            {"||", 1}, {"^^", 2}, {"&&", 3}, {"|", 4},  {"^", 5},  {"&", 6},  {"==", 7}, {"!=", 7}, {"<", 8}, {">", 8},
            {"<=", 8}, {">=", 8}, {"<<", 9}, {">>", 9}, {"+", 10}, {"-", 10}, {"*", 11}, {"/", 11}, {"%", 11}};
        Expression left = unary();
        for (auto found = strengths.find(peek()); found != strengths.end() && found->second > lowest;
             found = strengths.find(peek())) {
            const std::string symbol = found->first, token = take();
            Expression right = binary(found->second);
            left.root = left.indices = "";
            const bool is_lazy = symbol == "||" || symbol == "&&";
            if (symbol == "^^") {
                left.text = "(bool(" + left.text + ") != bool(";
                right.text += "))";
            } else if (!is_lazy && depend(left, right)) {
                left.text = " Ordered{" + left.text + ", ";
                right.text += "}.pass_to([&](auto... x) { return (x " + symbol + " ...); })";
            } else {
                left.text += token;
            }
            left.add(right);
        }
        return left;
    }
    Expression unary() {
        static const Names operators{"+", "-", "!", "~", "++", "--"};
        if (!operators.contains(peek())) return postfix();
        const bool assigns = peek().size() == 2;
        Expression operand{take()}, inner = unary();
        if (assigns) {
            inner.text = inner.assignable();
            operand.writes.insert(inner.root);
        }
        operand.add(inner);
        return operand;
    }
    Expression postfix() {
        Expression all = primary();
        for (;;) {
            if (peek() == "[") {
                all.text += take();
                all.indices = "";
                all.add(expression());
                all.text += expect("]");
            } else if (peek() == "++" || peek() == "--") {
                all.text = all.assignable() + take();
                all.writes.insert(all.root);
            } else if (peek() == ".") {
                const std::string dot = take(), indices = swizzle_indices(peek());
                if (indices.empty() || fields_.contains(peek())) {
                    all.text += dot + take();
                    all.indices = "";
                    if (peek() == "(") all.text += join({take(), expect(")")});  // length()
                } else {
                    all.target = all.text;
                    all.indices = indices;
                    skip();
                    all.text = " swizzle<" + indices + ">(" + all.text + ")";
                }
            } else {
                return all;
            }
        }
    }
    Expression primary() {
        if (peek() == "(") {
            Expression all{take()};
            all.add(expression());
            all.text += expect(")");
            return all;
        }
        const std::string word = peek();
        if (is_type(word) && peek(1) != "(") {  // float[3](…)
            const std::string type = take();
            auto sizes = dimensions();
            sizes.erase(sizes.begin());
            return call("make_array<" + array_type(type, sizes) + ">", {});
        }
        if (is_type(word)) return call(scalar_types.contains(word) ? skip() + "scalar<" + word + ">" : take(), {});
        if (is_name(word) && peek(1) == "(") {
            const auto found = functions_.find(word);
            std::string name = take();
            if (declared_.contains(word)) name.insert(name.size() - word.size(), "this->");
            return call(name, found == functions_.end() ? outs_of_builtin(word) : found->second);
        }
        Expression all{take()};
        if (is_name(word)) {
            all.root = word;
            all.reads.insert(word);
        }
        return all;
    }
    static std::vector<std::vector<bool>> outs_of_builtin(const std::string& name) {
        if (name == "umulExtended" || name == "imulExtended") return {{false, false, true, true}};
        if (name == "uaddCarry" || name == "usubBorrow") return {{false, false, true}};
        if (name == "modf" || name == "frexp") return {{false, true}};
        return {};
    }
    // The arguments of a call. `overloads` tell which ones are `out`.
    Expression call(const std::string& name, const std::vector<std::vector<bool>>& overloads) {
        std::vector<Expression> arguments;
        const std::string open = expect("(");
        while (peek() != ")") {
            std::string space = peek() == "," ? skip() : "";
            if (peek() == "void" && peek(1) == ")")
                space += skip();
            else
                arguments.push_back(assignment());
            if (!space.empty() && !arguments.empty()) arguments.back().text = space + arguments.back().text;
        }
        const std::string close = take();
        bool is_ordered = false;
        for (size_t i = 0; i < arguments.size(); ++i)
            for (size_t j = 0; j < i; ++j) is_ordered |= depend(arguments[i], arguments[j]);
        Expression all{name + open};
        if (is_ordered) all.text = " Ordered{";
        for (size_t i = 0; i < arguments.size(); ++i) {
            Expression& argument = arguments[i];
            const bool is_out = std::any_of(overloads.begin(), overloads.end(),
                                            [&](const auto& outs) { return outs.size() == arguments.size() && outs[i]; });
            if (is_out) {
                // Another name for the variable is a global's or an argument's.
                bool is_known_twice = globals_.contains(argument.root) || !argument.indices.empty();
                for (size_t j = 0; j < arguments.size(); ++j) is_known_twice |= j != i && arguments[j].root == argument.root;
                argument.text = is_known_twice ? " copied(" + argument.assignable() + ")" : argument.text;
                if (is_ordered && !is_known_twice) argument.text = " Reference(" + argument.text + ")";
                all.writes.insert(argument.root);
            }
            all.text += i == 0 ? "" : ",";
            all.add(argument);
        }
        if (is_ordered)
            all.text += "}.pass_to([&](auto... x) { return " + name + "(x...); })";
        else
            all.text += close;
        return all;
    }

    Names structs_, fields_, globals_;
    Names declared_;  // names in the declaration that is being read: their initialisers still call functions of these names
    std::map<std::string, std::vector<std::vector<bool>>, std::less<>>
        functions_;  // of each overload: which parameters are `out`
};

}  // namespace lab::native
