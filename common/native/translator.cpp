#include "native/translator.h"

#include <numeric>

#include "native/expressions.h"

namespace lab::native {
namespace {

class Translator : ExpressionReader {
  public:
    explicit Translator(const std::string& glsl) : ExpressionReader(glsl) {}

    std::string translate() {
        std::string text;
        while (!peek().empty()) text += global();
        Names macros;  // of C's headers, which shaders may use as names
        for (const auto& [space, word] : tokens_)
            if (is_name(word) && std::none_of(word.begin(), word.end(), [](unsigned char c) { return std::islower(c); }))
                macros.insert("#undef " + word + "\n");
        return "#include \"native/glsl.h\"\n" + std::accumulate(macros.begin(), macros.end(), std::string()) +
               "namespace lab::native {\nstruct Shader : ShaderBase {\n" + usings_ + text + R"(
};
}
extern "C" __attribute__((visibility("default"))) lab::native::Outcome lab_run_group(
    const lab::native::Bindings& bindings, uint32_t group, char* error, size_t size) {
    return lab::native::run_group<lab::native::Shader>(bindings, group, error, size);
}
)";
    }

  private:
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
        std::string text = take(), fields, parameters, initialisers;
        const std::string name = peek();
        structs_.insert(name);
        text += join({take(), expect("{")});
        while (peek() != "}") {
            bool is_const = false;
            std::string space = qualifiers(is_const);
            const std::string type = take();
            const auto sizes = dimensions();
            do {
                if (peek() == ",") skip();
                const std::string field = spelled(peek());
                fields_.insert(field);
                space += skip();
                const std::string declared = array_type(type, dimensions(sizes));
                text += space + declared + " " + field + ";";
                parameters += (parameters.empty() ? "" : ", ") + declared + " " + field + "_";
                initialisers += (initialisers.empty() ? " : " : ", ") + field + "(" + field + "_)";
                space.clear();
            } while (peek() == ",");
            text += expect(";").substr(1);
        }
        text += " " + name + "() = default; " + name + "(" + parameters + ")" + initialisers + " {} bool operator==(const " +
                name + "&) const = default;";
        return text + take();
    }
    // layout(…): the binding, or the size of a workgroup.
    std::string layout() {
        std::string binding;
        skip();
        expect("(");
        for (int depth = 1; depth > 0;) {
            const std::string word = peek();
            depth += word == "(" ? 1 : word == ")" ? -1 : 0;
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
            const std::string field = take();
            const auto sizes = dimensions();
            const bool is_open = !sizes.empty() && sizes[0].empty();
            const std::string declared = is_open ? type : array_type(type, sizes);
            fields += space + (is_open ? "Span<" + type + ">" : declared + "&") + field + " = " +
                      getter(declared, is_open, offset) + take();
            offset += " + sizeof(" + declared + ")";
        }
        fields += skip();
        if (peek() == ";") return text + fields + skip();
        const std::string instance = take();  // a name for the block
        return text + "struct " + name + "_block { const Bindings& bindings; " + fields + "};" + " " + name + "_block" +
               instance + "{bindings}" + take();
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
            const std::string name = peek(), variable = take();
            if (is_global) globals_.insert(name);
            declared_.insert(name);
            const auto all = dimensions(sizes);
            std::string value;
            bool is_constant = true;
            if (peek() == "=") {
                const size_t begin = at_;
                value = take();
                value += peek() == "{" ? braces() : assignment().text;
                for (size_t i = begin; i + 1 < at_; ++i)
                    is_constant &= tokens_[i + 1].text != "(" || !is_name(tokens_[i].text) ||
                                   scalar_types.contains(tokens_[i].text) || is_vector_type(tokens_[i].text);
            }
            const std::string before = is_global && is_const ? (is_constant ? "static constexpr " : "inline static const ")
                                       : is_const            ? "const "
                                                             : "";
            const std::string declared = before + array_type(type, all);
            text += separator + (previous == declared ? "," : (previous.empty() ? "" : ";") + declared) + variable + value;
            previous = declared;
        } while (peek() == ",");
        declared_.clear();
        return text;
    }
    std::string braces() {
        std::string text = take();
        while (peek() != "}") text += peek() == "{" ? braces() : peek() == "," ? take() : assignment().text;
        return text + take();
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
        std::string text = type + join({take(), take()});
        std::vector<bool> outs;
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
            const std::string variable = is_name(peek()) ? take() : "";
            text += array_type(parameter, dimensions(sizes)) + (is_out ? "&" : "") + variable;
            outs.push_back(is_out);
        }
        text += take();
        // GLSL's own functions of this name stay.
        if (!functions_.contains(name))
            usings_ += "template <typename B = Builtins, typename... T> static constexpr auto " + spelled(name) +
                       "(const T&... x) requires requires { B::" + spelled(name) + "(x...); } { return B::" + spelled(name) +
                       "(x...); }\n";
        functions_[name].push_back(outs);
        if (peek() == ";") {  // a prototype: members of a struct know each other
            skip();
            return std::string(static_cast<size_t>(std::count(text.begin(), text.end(), '\n')), '\n');
        }
        return text + block();
    }

    // Statements.
    std::string block() {
        std::string text = expect("{");
        while (peek() != "}") text += statement();
        return text + take();
    }
    std::string body() {  // of a loop
        return "{ if (bindings.must_stop()) [[unlikely]] throw Stopped(); " + statement() + " }";
    }
    std::string simple() { return is_declaration() ? declaration(false) : expression().text; }
    std::string parenthesised() { return join({expect("("), simple(), expect(")")}); }
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
    std::string statement() {
        const std::string word = peek();
        if (word == "{") return block();
        if (word == "struct") return join({structure(), expect(";")});
        if (word == "if" || word == "switch") {
            std::string text = join({take(), parenthesised(), statement()});
            if (word == "if" && peek() == "else") text += join({take(), statement()});
            return text;
        }
        if (word == "while") return join({take(), parenthesised(), body()});
        if (word == "do") return join({take(), " ", body(), expect("while"), parenthesised(), expect(";")});
        if (word == "for") {
            std::string text = join({take(), expect("(")});
            for (const char* end : {";", ";", ")"}) {
                if (peek() != end) text += simple();
                text += expect(end);
            }
            return text + body();
        }
        if (word == "case") return join({take(), expression().text, expect(":")});
        if (word == "default") return join({take(), expect(":")});
        if (word == "return" && peek(1) != ";") return join({take(), expression().text, expect(";")});
        if (word == "break" || word == "continue" || word == "discard" || word == "return") return join({take(), expect(";")});
        if (word == ";") return take();
        return join({simple(), expect(";")});
    }

    std::string usings_;
};

}  // namespace

std::string translate(const std::string& glsl) { return Translator(glsl).translate(); }

}  // namespace lab::native
