// GLSL's expressions as C++: swizzles, arguments that a function writes, and the order of evaluation are what differs.
#pragma once
#include <map>

#include "native/variance.h"

namespace lab::native {

class ExpressionReader : protected TokenReader, protected Variance {
  protected:
    ExpressionReader(const std::string& glsl, Variance variance) : TokenReader(glsl), Variance(std::move(variance)) {
        for (size_t i = 1; i < tokens_.size(); ++i)
            if (tokens_[i - 1].text == "struct") structs_.insert(tokens_[i].text);
    }

    bool is_type(const std::string& token) const {
        const Variable* found = find(token);
        return scalar_types.contains(token) || is_vector_type(token) || (found && found->is_type);
    }
    // A variable or field may have the name of a structure. C++ would not know that any more.
    std::string variable_name(const std::string& token) const {
        return spelled(token) + (structs_.contains(token) ? "_name__" : "");
    }
    std::string take_variable() {
        if (peek().empty()) fail();
        const std::string name = variable_name(peek());
        return skip() + name;
    }
    void refuse(const std::string& what) { Variance::refuse(place(), what); }
    Change change_of(const Expression& target, bool is_varying) {
        const Change change = note_change(target, is_varying);
        if (change == Change::refused) refuse("assignments to '" + target.root + "' as it is indexed here");
        return change;
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
            all.root = all.lvalue = all.place = "";
            all.text += take();
            all.add(assignment());
        }
        return all;
    }
    Expression assignment() {
        const Nesting nesting(*this);
        Expression left = conditional();
        static const Names operators{"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="};
        const std::string symbol = peek();
        if (!operators.contains(symbol)) return left;
        const std::string token = take();
        const Expression right = assignment();
        return assign(left, token, symbol, right);
    }
    // `target` op= `value` becomes `target` = `target` op `value` where lanes differ.
    Expression assign(const Expression& target, const std::string& token, const std::string& symbol, const Expression& value) {
        Expression all = target;
        const Change change = change_of(target, value.is_varying);
        all.add(value);
        write(all, target.root);
        all.text = target.assignable() + token + value.text;
        if (change != Change::uniform) {
            if (symbol != "=" && !target.writes.empty()) refuse("'" + symbol + "' where the index changes a variable, too");
            std::string changed = value.text;
            if (symbol != "=") changed = target.text + " " + symbol.substr(0, symbol.size() - 1) + " (" + value.text + ")";
            all.text = change == Change::of_all_lanes ? target.assignable() + " = " + changed
                                                      : " lanes::assign(active__, " + target.assignable() + ", " + changed + ")";
            all.is_varying = all.is_masked = true;
        }
        all.lvalue = all.place = "";
        return all;
    }
    // A part of an expression that is not evaluated in all lanes that come to the whole.
    template <typename F>
    Expression inside(bool is_branch, F read) {
        depth_ += is_branch ? 1 : 0;
        Expression part = read();
        depth_ -= is_branch ? 1 : 0;
        return part;
    }
    static void load(Expression& memory) {
        memory.text = " lanes::load(active__, " + memory.place + ")";
        memory.is_varying = memory.is_masked = true;
    }
    static std::string lazy(const Expression& part) {
        return "[&](lanes::Mask active__) __attribute__((always_inline)) { return " + part.text + "; }";
    }
    static std::string at_once(const std::string& statements) {
        return " ([&]() __attribute__((always_inline)) {" + statements + " }())";
    }
    Expression conditional() {
        Expression all = binary(0);
        if (peek() != "?") return all;
        const std::string question = take();
        const bool is_branch = all.is_varying;
        const Expression first = inside(is_branch, [&] { return expression(); });
        const std::string colon = expect(":");
        const Expression second = inside(is_branch, [&] { return assignment(); });
        const std::string condition = all.text;
        const bool is_lazy = first.is_masked || second.is_masked || depend(all, first) || depend(all, second);
        all.add(first);
        all.add(second);
        all.text = condition + question + first.text + colon + second.text;
        if (is_branch && is_lazy)
            all.text = " lanes::select_lazily(active__, " + condition + ", " + lazy(first) + ", " + lazy(second) + ")";
        else if (is_branch)
            all.text = " lanes::select(" + condition + ", " + first.text + ", " + second.text + ")";
        else if (all.is_varying)
            all.text = "(" + condition + question + "lanes::varying(" + first.text + ")" + colon + "lanes::varying(" +
                       second.text + "))";
        all.root = all.lvalue = all.place = "";
        return all;
    }
    Expression binary(int lowest) {
        static const std::map<std::string, int> strengths{
            {"||", 1}, {"^^", 2}, {"&&", 3}, {"|", 4},  {"^", 5},  {"&", 6},  {"==", 7}, {"!=", 7}, {"<", 8}, {">", 8},
            {"<=", 8}, {">=", 8}, {"<<", 9}, {">>", 9}, {"+", 10}, {"-", 10}, {"*", 11}, {"/", 11}, {"%", 11}};
        Expression left = unary();
        for (auto found = strengths.find(peek()); found != strengths.end() && found->second > lowest;
             found = strengths.find(peek())) {
            const std::string symbol = found->first, token = take(), first = left.text;
            const bool is_lazy = symbol == "||" || symbol == "&&";
            Expression right = inside(is_lazy && left.is_varying, [&] { return binary(found->second); });
            left.root = left.lvalue = left.place = "";
            const bool is_ordered = depend(left, right);
            left.add(right);
            // Where only some lanes get here, the others may divide by 0.
            left.is_masked |= depth_ > 0 && (symbol == "/" || symbol == "%") && !right.reads.empty();
            if (is_lazy && left.is_varying && (right.is_masked || is_ordered || !right.writes.empty()))
                left.text = " lanes::" + std::string(symbol == "||" ? "or" : "and") + "_lazily(active__, " + first + ", " +
                            lazy(right) + ")";
            else if (is_lazy && left.is_varying)
                left.text = " (lanes::Mask(" + first + ") " + symbol[0] + " lanes::Mask(" + right.text + "))";
            else {
                const std::string sign = symbol == "^^" ? " !=" : token;
                left.text = is_ordered && !is_lazy
                                ? at_once(" auto a__ = " + first + "; auto b__ = " + right.text + "; return a__" + sign + " b__;")
                            : symbol == "^^" ? "((" + first + ")" + sign + " (" + right.text + "))"
                                             : first + sign + right.text;
            }
        }
        return left;
    }
    Expression unary() {
        static const Names operators{"+", "-", "!", "~", "++", "--"};
        const std::string symbol = peek();
        if (!operators.contains(symbol)) return postfix();
        const Nesting nesting(*this);
        const std::string token = take();
        const Expression inner = unary();
        if (symbol.size() == 2 && change_of(inner, false) != Change::uniform)
            return assign(inner, token, symbol.substr(1) + "=", {"1"});
        Expression operand = {token};
        operand.add(inner);
        if (symbol.size() == 2) {
            operand.text = token + inner.assignable();
            write(operand, inner.root);
        }
        return operand;
    }
    Expression postfix() {
        Expression all = primary();
        for (;;) {
            if (peek() == "[") {
                const std::string open = take(), array = all.text;
                const Expression index = expression();
                const std::string close = expect("]");
                const bool is_array_varying = all.is_varying;
                all.add(index);
                if (const Variable* variable = find(all.root)) all.is_masked |= variable->is_memory;  // what is there to read?
                if (!all.lvalue.empty()) all.lvalue += open + index.text + close;
                all.text = array + open + index.text + close;
                if (!all.place.empty() || (index.is_varying && !is_array_varying)) {
                    all.place = " lanes::at(" + (all.place.empty() ? array : all.place) + ", " + index.text + ")";
                    load(all);
                } else if (index.is_varying) {
                    all.text = " lanes::pick(" + array + ", " + index.text + ")";
                    all.is_picked = true;
                }
            } else if (peek() == "++" || peek() == "--") {
                const std::string symbol = peek();
                if (change_of(all, false) != Change::uniform) {
                    const std::string before = all.text;
                    const Expression changed = assign(all, skip(), symbol.substr(1) + "=", {"1"});
                    all = changed;
                    all.text = " lanes::before(" + before + ", [&] { " + changed.text + "; })";
                } else {
                    all.text = all.assignable() + take();
                    write(all, all.root);
                }
            } else if (peek() == ".") {
                const std::string dot = take(), indices = swizzle_indices(peek());
                if (indices.empty() || fields_.contains(peek())) {
                    const std::string name = take_variable();
                    all.text += dot + name;
                    if (!all.lvalue.empty()) all.lvalue += "[" + std::to_string(component_index(name[0])) + "]";
                    if (peek() == "(") {  // length()
                        if (!all.place.empty()) refuse("length() of an array in memory");
                        all.text += join({take(), expect(")")});
                        all.is_varying = false;
                    } else if (!all.place.empty()) {
                        all.place = " lanes::field(" + all.place + ", [](auto& x) -> auto& { return x." + name + "; })";
                        load(all);
                    }
                } else {
                    if (!all.place.empty()) all.is_picked = true;
                    all.place = "";
                    all.lvalue = " swizzled<" + indices + ">(" + all.text + ")";
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
            const std::string open = take();
            Expression all = expression();
            all.text = open + all.text + expect(")");
            return all;
        }
        const std::string word = peek();
        if (is_type(word) && peek(1) != "(") {  // float[3](…)
            const std::string type = take();
            auto sizes = dimensions();
            sizes.erase(sizes.begin());
            return call(" make_array<" + array_type(type, sizes) + ">", word, Call::constructor);
        }
        if (is_type(word))
            return call(scalar_types.contains(word) ? skip() + "scalar<" + word + ">" : take(), word, Call::constructor);
        if (is_name(word) && peek(1) == "(") {
            const auto found = functions_.find(word);
            std::string name = take();
            if (declared_.contains(word)) name.insert(name.size() - spelled(word).size(), "this->");
            if (found == functions_.end()) return call(name, word, Call::builtin, outs_of_builtin(word));
            return call(name, word, Call::function, found->second);
        }
        Expression all{take_variable()};
        if (is_name(word)) {
            all.root = word;
            all.reads.insert(word);
            if (globals_.contains(word)) effects_of_function_.reads.insert(word);
            all.is_varying = varies(word);
        }
        return all;
    }
    static std::vector<Parameters> outs_of_builtin(const std::string& name) {
        if (name == "umulExtended" || name == "imulExtended") return {{{false}, {false}, {true}, {true}}};
        if (name == "uaddCarry" || name == "usubBorrow") return {{{false}, {false}, {true}}};
        if (name == "modf" || name == "frexp") return {{{false}, {true}}};
        if (name == "native_closest_hit") return {{{false}, {false}, {false}, {true}, {true}, {true}, {true}}};
        return {};
    }
    // The arguments of a call.
    enum class Call { constructor, builtin, function };
    Expression call(std::string name, const std::string& word, Call kind, const std::vector<Parameters>& overloads = {}) {
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
        Expression all;
        std::string first, passed;  // what comes before the call, and what it passes
        const auto is_out_argument = [&](size_t i) {
            return std::any_of(overloads.begin(), overloads.end(),
                               [&](const auto& outs) { return outs.size() == arguments.size() && outs[i].is_out; });
        };
        for (size_t i = 0; i < arguments.size(); ++i)
            if (is_out_argument(i)) write(all, arguments[i].root);
        for (size_t i = 0; i < arguments.size(); ++i) {
            Expression& argument = arguments[i];
            const bool is_out = is_out_argument(i);
            const bool is_memory = i == 0 && (word.starts_with("atomic") || word == "texelFetch");
            bool is_copied = false;
            if (has_lanes() && is_memory && (word != "texelFetch" || !argument.place.empty())) {
                if (argument.place.empty()) refuse("atomic functions of one variable for all paths");
                argument.text = argument.place;
            } else if (is_out) {
                // Another name for the variable is a global's or an argument's.
                is_copied = globals_.contains(argument.root) || !argument.lvalue.empty() || !argument.place.empty();
                for (size_t j = 0; j < arguments.size(); ++j) is_copied |= j != i && arguments[j].root == argument.root;
                if (has_lanes()) {
                    change_of(argument, true);
                    is_copied |= kind == Call::builtin;
                }
                if (is_copied)
                    argument.text = (has_lanes() ? " lanes::copied(active__, " : " copied(") + argument.assignable() + ")";
            } else if (has_lanes() && kind == Call::function &&
                       (globals_.contains(argument.root) || all.writes.contains(argument.root))) {
                argument.text = " lanes::copy(" + argument.text + ")";  // it may change while the function reads it
            }
            for (const auto& parameters : overloads)
                if (argument.is_varying && parameters.size() == arguments.size()) vary(parameters[i].token);
            passed += i == 0 ? "" : ",";
            all.add(argument);
            // C++ evaluates arguments in any order, and a temporary would be copied out only after the whole expression.
            if (is_ordered || is_copied) {
                const std::string variable = "a" + std::to_string(i) + "__";
                first += (is_out || is_memory ? " auto&& " : " auto ") + variable + " =" + argument.text + ";";
                passed += " " + variable;
            } else {
                passed += argument.text;
            }
        }
        bool is_masked = kind == Call::function;
        if (has_lanes()) {
            const std::string signature = word + "/" + std::to_string(arguments.size());
            if (kind == Call::constructor && all.is_varying)
                name = name.find('<') == std::string::npos ? " lanes::make<" + name + ">" : " lanes::" + name;
            if (kind == Call::builtin && asks_for_mask(word)) is_masked = all.is_varying = true;
            if (kind == Call::function) all.is_varying = is_varying_function(signature);
        }
        const std::string mask = has_lanes() && is_masked ? arguments.empty() ? "active__" : "active__, " : "";
        all.is_masked |= is_masked;
        all.text = name + open + mask + passed + close;
        if (!first.empty()) all.text = at_once(first + " return " + all.text + ";");
        if (kind == Call::function) {
            const auto found = effects_.find(word);  // a function may have only a prototype so far
            const Expression effects =
                found != effects_.end() ? found->second : Expression{.reads = globals_, .writes = globals_};
            all.add_effects(effects);
            effects_of_function_.add_effects(effects);
        }
        return all;
    }

    void write(Expression& all, const std::string& variable) {
        all.writes.insert(variable);
        if (globals_.contains(variable)) effects_of_function_.writes.insert(variable);
    }

    Names structs_;  // all names of structures
    Names fields_;
    Names declared_;  // names in the declaration that is being read: their initialisers still call functions of these names
    std::map<std::string, std::vector<Parameters>, std::less<>> functions_;  // of each overload
    // What functions read and write of global variables, and what the present one does.
    std::map<std::string, Expression, std::less<>> effects_;
    Expression effects_of_function_;
};

}  // namespace lab::native
