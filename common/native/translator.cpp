#include "native/translator.h"

#include <numeric>

#include "native/declarations.h"

namespace lab::native {
namespace {

class Translator : DeclarationReader {
  public:
    Translator(const std::string& glsl, const Variance& variance) : DeclarationReader(glsl, variance) {}
    using Variance::is_settled;
    using Variance::next;
    using Variance::refusal;

    std::string translate() {
        std::string text;
        while (!peek().empty()) text += global();
        Names macros;  // of C's headers, which shaders may use as names
        for (const auto& [space, word] : tokens_)
            if (is_name(word) && std::none_of(word.begin(), word.end(), [](unsigned char c) { return std::islower(c); }))
                macros.insert("#undef " + word + "\n");
        const std::string prefix = has_lanes() ? "lanes::" : "";
        return "#include \"native/" + std::string(has_lanes() ? "lane_builtins.h" : "glsl.h") + "\"\n" +
               std::accumulate(macros.begin(), macros.end(), std::string()) +
               "namespace lab::native {\nstruct Shader : " + prefix + "ShaderBase {\n" + usings_ + text + R"(
};
}
extern "C" __attribute__((visibility("default"))) const int lab_invocations_at_once = )" +
               (has_lanes() ? "lab::native::lane_count" : "1") + R"(;
extern "C" __attribute__((visibility("default"))) lab::native::Outcome lab_run_group(
    const lab::native::Bindings& bindings, uint32_t group, char* error, size_t size) {
    return lab::native::)" +
               prefix + R"(run_group<lab::native::Shader>(bindings, group, error, size);
}
)";
    }

  private:
    // layout(…): the binding, or the size of a workgroup.
    std::string layout() {
        std::string binding;
        skip();
        expect("(");
        for (int depth = 1; depth > 0;) {
            const std::string word = peek();
            depth += word == "(" ? 1 : word == ")" ? -1 : 0;
            if (word == "std140" || word == "std430" || word == "local_size_y" || word == "local_size_z") fail();
            skip();
            if (word == "push_constant") binding = word;
            if (word == "binding" || word == "local_size_x") {
                skip();
                binding = (word == "binding" ? "" : "=") + conditional().text;
            }
        }
        return binding;
    }
    // What follows layout(…).
    std::string resource(const std::string& binding) {
        std::string text;
        while (dropped.contains(peek()) || peek() == "uniform" || peek() == "buffer" || peek() == "in") text += skip();
        if (peek() == ";")
            return text + (binding.starts_with("=") ? "static constexpr uint local_size " + binding + skip() + ";" : skip());
        const auto getter = [&](const std::string& type, bool is_array, const std::string& offset) {
            if (binding == "push_constant") return "get_constant<" + type + ">(bindings, " + offset + ")";
            return (is_array ? "get_array<" : "get<") + type + ">(bindings, " + binding + ", " + offset + ")";
        };
        const std::string name = peek();
        text += skip();
        if (name == "texture2D") {
            declare(peek(), at_, -1, true);
            const std::string variable = take();
            const bool is_array = !dimensions().empty();
            return text + (is_array ? "Span<Texture>" : "const Texture&") + variable + " = " + getter("Texture", is_array, "0") +
                   take();
        }
        std::string fields, offset = "0";
        expect("{");
        while (peek() != "}") {
            bool is_const = false;
            std::string space = qualifiers(is_const);
            const std::string type = take();
            globals_.insert(peek());
            declare(peek(), at_, -1, true);
            const std::string field = take_variable();
            const auto sizes = dimensions();
            const bool is_open = !sizes.empty() && sizes[0].empty();
            const std::string declared = is_open ? type : array_type(type, sizes);
            fields += space + (is_open ? "Span<" + type + ">" : declared + "&") + field + " = " +
                      getter(declared, is_open, offset) + take();
            offset += " + sizeof(" + declared + ")";
        }
        fields += skip();
        if (peek() == ";") return text + fields + skip();
        declare(peek(), at_, -1, true);
        globals_.insert(peek());
        const std::string instance = take_variable();  // a name for the block
        return text + "struct " + name + "_block { const Bindings& bindings; " + fields + "};" + " " + name + "_block" +
               instance + "{bindings}" + take();
    }
    std::string global() {
        if (peek() == ";") return skip();
        if (peek() == "precision") {
            while (peek() != ";") skip();
            return skip();
        }
        if (peek() == "struct") return join({structure(), expect(";")});
        if (peek() == "layout") {
            const std::string space = tokens_[at_].space;
            return space + resource(layout());
        }
        const size_t begin = at_;
        bool is_const = false;
        std::string text = qualifiers(is_const);
        const std::string type = take();
        const auto sizes = dimensions();
        if (peek(1) == "(") return text + function(array_type(type, sizes));
        at_ = begin;
        return join({declaration(true), expect(";")});
    }
    std::string function(const std::string& type) {
        const std::string name = peek();
        std::string head = take(), text = take();
        Parameters parameters;
        scopes_.emplace_back();
        while (peek() != ")") {
            if (peek() == ",") text += take();
            if (peek() == "void" && peek(1) == ")") {
                text += skip();
                continue;
            }
            bool is_out = false;
            while (dropped.contains(peek()) || peek() == "const" || peek() == "in" || peek() == "out" || peek() == "inout") {
                is_out |= peek() == "out" || peek() == "inout";
                text += skip();
            }
            const std::string parameter = take();
            const auto sizes = dimensions();
            const size_t token = at_;
            std::string variable;
            if (is_name(peek())) {
                declare(peek(), token, is_out ? -1 : 0);
                if (is_out) vary(token);
                variable = take_variable();
            }
            const std::string declared = varying_type(array_type(parameter, dimensions(sizes)), varies(token));
            if (has_lanes() && !is_out && !is_written(token))
                text += " const " + declared + "&" + variable;
            else
                text += declared + (is_out ? "&" : "") + variable;
            parameters.push_back({is_out, token});
        }
        signature_ = name + "/" + std::to_string(parameters.size());
        const bool is_varying = is_varying_function(signature_);
        if (has_lanes())
            text = "(lanes::Mask active__" + std::string(parameters.empty() ? "" : ",") + text.substr(text.find('(') + 1);
        text = varying_type(type, is_varying) + head + text + take();
        // GLSL's own functions of this name stay.
        if (!functions_.contains(name))
            usings_ += "template <typename B = " + std::string(has_lanes() ? "lanes::" : "") +
                       "Builtins, typename... T> static constexpr auto " + spelled(name) +
                       "(const T&... x) requires requires { B::" + spelled(name) + "(x...); } { return B::" + spelled(name) +
                       "(x...); }\n";
        functions_[name].push_back(parameters);
        if (peek() == ";") {  // a prototype: members of a struct know each other
            scopes_.pop_back();
            skip();
            return std::string(static_cast<size_t>(std::count(text.begin(), text.end(), '\n')), '\n');
        }
        effects_of_function_ = {};
        returns_ = 0;
        const bool is_void = type.ends_with("void");
        result_ = is_void ? "" : " result__";
        if (has_lanes() && !is_void)
            text += " { " + varying_type(type, is_varying) + " result__; " + block() + " return result__; }";
        else
            text += block();
        scopes_.pop_back();
        effects_[name].add_effects(effects_of_function_);
        return text;
    }

    // Statements.
    std::string block() {
        std::string text = expect("{"), ends;
        scopes_.emplace_back();
        while (peek() != "}") {
            const int before = returns_ + jumps_;
            text += statement();
            if (returns_ + jumps_ > before && peek() != "}") {  // some lanes have left
                text += " if (lanes::any(active__)) {";
                ends += "}";
            }
        }
        scopes_.pop_back();
        return text + ends + take();
    }
    // A statement by itself, of a branch that only some lanes may take.
    std::string inner_statement(int depth) {
        depth_ += depth;
        scopes_.emplace_back();
        const std::string text = statement();
        scopes_.pop_back();
        depth_ -= depth;
        return text;
    }
    std::string body(int depth = 0) {  // of a loop
        return "{ if (bindings.must_stop()) [[unlikely]] throw Stopped(); " + inner_statement(depth) + " }";
    }
    Expression simple() { return is_declaration() ? Expression{declaration(false)} : expression(); }
    Expression parenthesised() {
        Expression all{expect("(")};
        all.add(simple());
        all.text += expect(")");
        return all;
    }
    bool is_declaration() const {
        const std::string& word = peek();
        return word == "const" || dropped.contains(word) || (is_type(word) && (is_name(peek(1)) || is_array_declaration()));
    }
    bool is_array_declaration() const {  // float[3] a, not float[3](…)
        if (peek(1) != "[") return false;
        size_t i = 1;
        for (int depth = 0; !peek(i).empty() && (depth > 0 || peek(i) == "["); ++i)
            depth += peek(i) == "[" ? 1 : peek(i) == "]" ? -1 : 0;
        return is_name(peek(i));
    }
    std::string branch() {
        const std::string word = take();
        const Expression condition = parenthesised();
        const int depth = condition.is_varying ? 1 : 0;
        const std::string first = inner_statement(depth);
        std::string otherwise, second;
        if (peek() == "else") {
            otherwise = take();
            second = inner_statement(depth);
        }
        if (!condition.is_varying) return word + condition.text + first + otherwise + second;
        std::string text = " { lanes::Branch branch__(active__, " + condition.text + "); if (branch__.begins()) {" + first + "}";
        if (!otherwise.empty()) text += " if (branch__.turns()) {" + second + "}";
        return text + " branch__.ends(); }";
    }
    // A loop that lanes may leave one by one goes on until none is left.
    std::string loop() {
        const size_t token = at_;
        const bool is_varying = varies(token);
        const int depth = is_varying ? 1 : 0, jumps = jumps_;
        const std::string word = peek();
        std::string text = take(), parts[3];
        depth_ += depth;
        scopes_.emplace_back();
        loops_.push_back({token, depth_});
        const auto condition = [&](bool is_parenthesised) {
            const bool is_declared = is_declaration();
            const Expression all = is_parenthesised ? parenthesised() : simple();
            if (all.is_varying) vary(token);
            if (is_declared && is_varying) refuse("a declaration in a loop's condition");
            return is_varying ? "loop__.goes_on(" + all.text + ")" : all.text;
        };
        if (word == "do") {
            text += " ";
            const std::string statements = body(depth);
            const std::string end = expect("while");
            parts[1] = condition(true);
            const std::string semicolon = expect(";");
            if (is_varying)
                text = " { lanes::Loop loop__(active__); do " + statements + " while (loop__.next(), " + parts[1] +
                       "); loop__.ends(); }";
            else
                text = join({text, statements, end, parts[1], semicolon});
        } else if (word == "while") {
            parts[1] = condition(true);
            const std::string statements = body(depth);
            text = is_varying ? " { lanes::Loop loop__(active__); while (loop__.next(), " + parts[1] + ") " + statements +
                                    " loop__.ends(); }"
                              : join({text, parts[1], statements});
        } else {
            text += expect("(");
            if (peek() != ";") parts[0] = simple().text;
            parts[0] += expect(";");
            if (peek() != ";")
                parts[1] = condition(false);
            else if (is_varying)
                parts[1] = "loop__.goes_on(true)";
            const std::string semicolon = expect(";");
            if (peek() != ")") parts[2] = simple().text;
            const std::string close = expect(")"), statements = body(depth);
            if (is_varying)
                text = " { " + parts[0] + " lanes::Loop loop__(active__); for (;" + parts[1] + semicolon + " loop__.next()" +
                       (parts[2].empty() ? "" : ", ") + parts[2] + close + statements + " loop__.ends(); }";
            else
                text = join({text, parts[0], parts[1], semicolon, parts[2], close, statements});
        }
        loops_.pop_back();
        scopes_.pop_back();
        depth_ -= depth;
        jumps_ = jumps;
        return text;
    }
    // break and continue
    std::string jump() {
        const std::string word = peek();
        std::string text = join({take(), expect(";")});
        if (!has_lanes() || loops_.empty()) return text;  // of a switch, which lanes do not know
        const auto& [token, depth] = loops_.back();
        if (depth_ > depth) vary(token);
        if (!varies(token)) return text;
        ++jumps_;
        return word == "break" ? " loop__.leave();" : " loop__.skip();";
    }
    std::string return_statement() {
        const std::string word = take();
        const Expression value = peek() == ";" ? Expression() : expression();
        const std::string end = expect(";");
        if (value.is_varying || (depth_ > 0 && !value.text.empty())) vary_function(signature_);
        if (depth_ == 0 && returns_ == 0) return word + value.text + end;
        const std::string assignment = value.text.empty() ? "" : "lanes::assign(active__, result__, " + value.text + "); ";
        if (depth_ == 0) return "{ " + assignment + word + result_ + end + " }";
        for (const auto& [token, depth] : loops_) vary(token);
        ++returns_;
        return "{ " + assignment + "active__ = false; }";
    }
    std::string statement() {
        const Nesting nesting(*this);
        const std::string word = peek();
        if (word == "{") return block();
        if (word == "struct") return join({structure(), expect(";")});
        if (word == "if") return branch();
        if (word == "switch") {
            if (has_lanes()) refuse("'switch'");
            return join({take(), parenthesised().text, statement()});
        }
        if (word == "while" || word == "do" || word == "for") return loop();
        if (word == "case") return join({take(), expression().text, expect(":")});
        if (word == "default") return join({take(), expect(":")});
        if (word == "return") return return_statement();
        if (word == "break" || word == "continue") return jump();
        if (word == "discard") return join({take(), expect(";")});
        if (word == ";") return take();
        return join({simple().text, expect(";")});
    }

    std::string signature_, result_;  // of the function that is read
    int returns_ = 0, jumps_ = 0;     // that some lanes do and others do not, so far in the function and in the loop
    struct OpenLoop {
        size_t token;
        int depth;
    };
    std::vector<OpenLoop> loops_;
    std::string usings_;
};

}  // namespace

std::string translate(const std::string& glsl) { return Translator(glsl, Variance(false)).translate(); }

std::string translate_for_lanes(const std::string& glsl, std::string& refusal) {
    for (Variance variance(true);;) {
        Translator translator(glsl, variance);
        const std::string text = translator.translate();
        if (translator.is_settled()) {
            refusal = translator.refusal();
            return text;
        }
        variance = translator.next();
    }
}

}  // namespace lab::native
