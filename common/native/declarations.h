// GLSL's structures and variables as C++. Where lanes run a shader, a structure is a template: its numbers are the same in all
// lanes, or differ.
#pragma once
#include "native/expressions.h"

namespace lab::native {

class DeclarationReader : protected ExpressionReader {
  protected:
    using ExpressionReader::ExpressionReader;

    // Skips words that C++ has no need of; whether `const` was among them.
    std::string qualifiers(bool& is_const) {
        std::string space;
        while (dropped.contains(peek()) || peek() == "const") {
            is_const |= peek() == "const";
            space += skip();
        }
        return space;
    }
    std::string structure() {
        std::string text = take(), parameters, initialisers, copies, members;
        const std::string name = spelled(peek()), kind = has_lanes() ? name + "__" : name;
        declare_type(peek());
        if (has_lanes())
            text = join({" template <template <typename> class W> ", text, skip(), " ", kind, expect("{")});
        else
            text += join({take(), expect("{")});
        while (peek() != "}") {
            bool is_const = false;
            std::string space = qualifiers(is_const);
            const std::string type = take();
            const auto sizes = dimensions();
            do {
                if (peek() == ",") skip();
                const std::string field = variable_name(peek());
                fields_.insert(peek());
                space += skip();
                std::string declared = array_type(type, dimensions(sizes));
                if (has_lanes()) declared = "W<" + declared + ">";
                const std::string separator = parameters.empty() ? "" : ", ", start = parameters.empty() ? " : " : ", ";
                text += space + declared + " " + field + ";";
                parameters += separator + declared + " " + field + "_";
                initialisers += start + field + "(" + field + "_)";
                copies += start + field + "(other__." + field + ")";
                members += " f(x__." + field + "...);";
                space.clear();
            } while (peek() == ",");
            text += expect(";").substr(1);
        }
        text += " " + kind + "() = default; " + kind + "(" + parameters + ")" + initialisers + " {}";
        if (!has_lanes()) return text + " bool operator==(const " + name + "&) const = default;" + take();
        if (depth_ >= 0 && scopes_.size() > 1) refuse("structures inside of a function");  // where C++ allows no templates
        return text + " using VaryingStruct = " + kind + "<lanes::V>; template <template <typename> class X> " + kind +
               "(const " + kind + "<X>& other__)" + copies +
               " {} template <typename F, typename... T> static void fields(const F& f, T&&... x__) {" + members + " }" + take() +
               "; using " + name + " = " + kind + "<Uniform>";
    }
    // A declaration of variables, without the `;`. Global constants are `static`.
    std::string declaration(bool is_global) {
        bool is_const = false;
        std::string text = qualifiers(is_const), space;
        const std::string type = take();
        const auto sizes = dimensions();
        declared_.clear();
        std::string previous;
        do {
            const std::string separator = peek() == "," ? skip() : "";
            const size_t token = at_;
            const std::string name = peek(), variable = take_variable();
            if (is_global) globals_.insert(name);
            declared_.insert(name);
            const auto all = dimensions(sizes);
            std::string value;
            bool is_constant = true;
            if (peek() == "=") {
                const size_t begin = at_;
                value = take();
                const Expression initialiser = peek() == "{" ? braces() : assignment();
                if (initialiser.reads.contains(name) && !is_global) {  // in GLSL, an outer variable of this name
                    text += (previous.empty() ? " const auto " : "; const auto ") + name + "__ =" + initialiser.text + ";";
                    value += name + "__";
                    previous.clear();
                } else {
                    value += initialiser.text;
                }
                if (initialiser.is_varying) vary(token);
                if (is_global && initialiser.is_masked && has_lanes()) refuse("calls in the initial value of a global variable");
                for (size_t i = begin; i + 1 < at_; ++i)
                    is_constant &= tokens_[i + 1].text != "(" || !is_name(tokens_[i].text) ||
                                   scalar_types.contains(tokens_[i].text) || is_vector_type(tokens_[i].text);
            }
            const std::string before = is_global && is_const ? (is_constant ? "static constexpr " : "inline static const ")
                                       : is_const            ? "const "
                                                             : "";
            declare(name, token, is_global ? -1 : depth_);
            const std::string declared = before + varying_type(array_type(type, all), varies(token));
            text += separator + (previous == declared ? "," : (previous.empty() ? "" : ";") + declared) + variable + value;
            previous = declared;
        } while (peek() == ",");
        declared_.clear();
        return text;
    }
    static std::string varying_type(const std::string& type, bool is_varying) {
        return is_varying && type != "auto" ? "lanes::V<" + type + ">" : type;
    }
    Expression braces() {
        const Nesting nesting(*this);
        Expression all{take()};
        while (peek() != "}") all.add(peek() == "{" ? braces() : peek() == "," ? Expression{take()} : assignment());
        all.text += take();
        return all;
    }
};

}  // namespace lab::native
