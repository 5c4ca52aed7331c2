#include "native/translator.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "error.h"

namespace lab::native {
namespace {

using Names = std::set<std::string, std::less<>>;

const Names scalar_types{"void", "bool", "int", "uint", "float", "double"};
const Names dropped{"precise",  "highp",    "mediump",  "lowp",     "flat",      "smooth", "invariant",
                    "coherent", "volatile", "restrict", "readonly", "writeonly", "shared", "subroutine"};
// Names that C++ keeps for itself and GLSL does not.
const Names cpp_words{"alignas",  "alignof", "and",       "auto",      "bitand",   "bitor",     "catch",    "char",
                      "compl",    "concept", "constexpr", "co_await",  "co_yield", "co_return", "decltype", "delete",
                      "explicit", "export",  "friend",    "mutable",   "new",      "noexcept",  "not",      "nullptr",
                      "operator", "or",      "private",   "protected", "register", "requires",  "signed",   "throw",
                      "try",      "typeid",  "typename",  "virtual",   "wchar_t",  "xor",       "bindings", "main"};

bool is_vector_type(const std::string& name) {
    static const Names types = [] {
        Names all;
        for (const char* kind : {"", "i", "u", "b", "d"})
            for (const char* size : {"2", "3", "4"}) all.insert(kind + std::string("vec") + size);
        for (const std::string kind : {"mat", "dmat"})
            for (const char* size : {"2", "3", "4", "2x2", "2x3", "2x4", "3x2", "3x3", "3x4", "4x2", "4x3", "4x4"})
                all.insert(kind + size);
        return all;
    }();
    return types.contains(name);
}

// The indices of a swizzle's components as "2,0,1"; empty for other names.
std::string swizzle_indices(const std::string& name) {
    for (const std::string letters : {"xyzw", "rgba", "stpq"}) {
        std::string indices;
        for (const char letter : name) {
            const size_t index = letters.find(letter);
            if (index == std::string::npos) break;
            indices += (indices.empty() ? "" : ",") + std::to_string(index);
        }
        if (name.size() >= 2 && name.size() <= 4 && indices.size() == 2 * name.size() - 1) return indices;
    }
    return "";
}

// In braces, parts are made from left to right.
std::string join(std::initializer_list<std::string> parts) {
    std::string all;
    for (const auto& part : parts) all += part;
    return all;
}

struct Token {
    std::string space;  // before it: line ends and #line directives, too
    std::string text;   // empty at the end
};

std::vector<Token> tokenize(const std::string& glsl) {
    static const std::vector<std::string> symbols{"<<=", ">>=", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "^^",
                                                  "++",  "--",  "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^="};
    std::vector<Token> tokens;
    std::string space;
    for (size_t at = 0; at < glsl.size();) {
        const char c = glsl[at];
        const bool is_word = std::isalpha(static_cast<unsigned char>(c)) || c == '_';
        const bool is_number = std::isdigit(static_cast<unsigned char>(c)) ||
                               (c == '.' && at + 1 < glsl.size() && std::isdigit(static_cast<unsigned char>(glsl[at + 1])));
        size_t end = at + 1;
        if (std::isspace(static_cast<unsigned char>(c))) {
            space += c;
        } else if (c == '#') {  // #line stays, others have done their work
            end = std::min(glsl.find('\n', at), glsl.size());
            if (glsl.compare(at, 5, "#line") == 0) space += glsl.substr(at, end - at);
        } else {
            if (is_word || is_number) {
                while (end < glsl.size() && (std::isalnum(static_cast<unsigned char>(glsl[end])) || glsl[end] == '_' ||
                                             (is_number && (glsl[end] == '.' || ((glsl[end] == '+' || glsl[end] == '-') &&
                                                                                 std::tolower(glsl[end - 1]) == 'e' &&
                                                                                 glsl.compare(at, 2, "0x") != 0)))))
                    ++end;
            } else {
                for (const auto& symbol : symbols)
                    if (end == at + 1 && glsl.compare(at, symbol.size(), symbol) == 0) end = at + symbol.size();
            }
            tokens.push_back({std::exchange(space, ""), glsl.substr(at, end - at)});
        }
        at = end;
    }
    tokens.push_back({space, ""});
    return tokens;
}

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

bool overlap(const Names& a, const Names& b) {
    return std::any_of(a.begin(), a.end(), [&](const auto& name) { return b.contains(name); });
}
// Whether the order of evaluation matters: C++ leaves it open.
bool depend(const Expression& a, const Expression& b) {
    return overlap(a.writes, b.reads) || overlap(b.writes, a.reads) || overlap(a.writes, b.writes);
}

class Translator {
  public:
    explicit Translator(const std::string& glsl) : tokens_(tokenize(glsl)) {}

    std::string translate() {
        std::string text;
        while (!peek().empty()) text += global();
        std::string macros;  // of C's headers, which shaders may use as names
        for (const auto& token : tokens_)
            if (std::all_of(token.text.begin(), token.text.end(),
                            [](char c) { return std::isupper(c) || std::isdigit(c) || c == '_'; }) &&
                !token.text.empty() && std::isupper(static_cast<unsigned char>(token.text[0])))
                macros_.insert(token.text);
        for (const auto& name : macros_) macros += "#undef " + name + "\n";
        return "#include \"native/glsl.h\"\n" + macros + "namespace lab::native {\nstruct Shader : ShaderBase {\n" + usings_ +
               text +
               "\n};\n}\nextern \"C\" __attribute__((visibility(\"default\"))) lab::native::Outcome lab_run_group(const lab::native::Bindings& bindings, uint32_t group, "
               "char* "
               "error, size_t size) {\n    return lab::native::run_group<lab::native::Shader>(bindings, group, error, "
               "size);\n}\n";
    }

  private:
    // Tokens.
    const std::string& peek(size_t ahead = 0) const { return tokens_[std::min(at_ + ahead, tokens_.size() - 1)].text; }
    std::string take() {  // with the space before it
        const Token& token = tokens_[at_];
        if (token.text.empty()) fail();
        ++at_;
        return token.space + spelled(token.text);
    }
    std::string expect(const char* text) {
        if (peek() != text) fail();
        return take();
    }
    std::string skip() {  // a token: only its space is left
        ++at_;
        return tokens_[at_ - 1].space;
    }
    [[noreturn]] void fail() const {
        std::string place = "the shader";
        int line = 0;
        for (size_t i = 0; i <= at_ && i < tokens_.size(); ++i) {
            const std::string& space = tokens_[i].space;
            size_t begin = 0;
            if (const size_t directive = space.rfind("#line "); directive != std::string::npos) {
                line = std::atoi(space.c_str() + directive + 6) - 1;
                const size_t quote = space.find('"', directive);
                place = space.substr(quote + 1, space.find('"', quote + 1) - quote - 1);
                begin = directive;
            }
            line += static_cast<int>(std::count(space.begin() + static_cast<std::ptrdiff_t>(begin), space.end(), '\n'));
        }
        throw UserError(place + ":" + std::to_string(line) + ": the backend native does not know what '" + peek() +
                        "' means here: use another one, --backend compute");
    }
    static std::string spelled(const std::string& token) {
        if (cpp_words.contains(token)) return token + "_";
        if (std::isdigit(static_cast<unsigned char>(token[0])) || (token[0] == '.' && token.size() > 1)) {
            const bool is_hexadecimal = token.starts_with("0x") || token.starts_with("0X");
            if (!is_hexadecimal && token.find_first_of(".eE") != std::string::npos &&
                !std::isalpha(static_cast<unsigned char>(token.back())))
                return token + "f";
        }
        return token;
    }
    static bool is_name(const std::string& token) {
        return !token.empty() && (std::isalpha(static_cast<unsigned char>(token[0])) || token[0] == '_');
    }
    bool is_type(const std::string& token) const {
        return scalar_types.contains(token) || is_vector_type(token) || structs_.contains(token);
    }

    // Types and declarations.
    // [2][3] after a type or a name: the sizes, empty for [].
    std::vector<std::string> dimensions() {
        std::vector<std::string> sizes;
        while (peek() == "[") {
            skip();
            sizes.push_back(peek() == "]" ? "" : expression().text);
            expect("]");
        }
        return sizes;
    }
    static std::string array_type(std::string element, const std::vector<std::string>& sizes) {
        for (auto size = sizes.rbegin(); size != sizes.rend(); ++size)
            element = size->empty() ? "auto" : "Array<" + element + ", (" + *size + ")>";
        return element;
    }
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
                auto all = dimensions();
                all.insert(all.end(), sizes.begin(), sizes.end());
                const std::string declared = array_type(type, all);
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
        fields += expect("{").substr(0, 0);
        while (peek() != "}") {
            bool is_const = false;
            std::string space = qualifiers(is_const);
            const std::string type = take(), field = take();
            const auto sizes = dimensions();
            const bool is_open = !sizes.empty() && sizes[0].empty();
            const std::string declared = is_open ? type : array_type(type, sizes);
            fields += space + (is_open ? "Span<" + type + ">" : declared + "&") + field + " = " +
                      getter(declared, is_open, offset) + take();
            offset += " + sizeof(" + declared + ")";
            globals_.insert(
                field.substr(field.find_last_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") + 1));
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
            auto all = dimensions();
            all.insert(all.end(), sizes.begin(), sizes.end());
            std::string value;
            bool is_constant = true;
            if (peek() == "=") {
                const size_t begin = at_;
                value = take();
                value += peek() == "{" ? braces() : assignment().text;
                for (size_t i = begin; i + 1 < at_; ++i)
                    is_constant &= tokens_[i + 1].text != "(" || !is_name(tokens_[i].text) || scalar_types.contains(tokens_[i].text) ||
                                   is_vector_type(tokens_[i].text);
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
            bool is_const = false, is_out = false;
            while (dropped.contains(peek()) || peek() == "const" || peek() == "in" || peek() == "out" || peek() == "inout") {
                is_out |= peek() == "out" || peek() == "inout";
                text += skip();
            }
            const std::string parameter = take();
            auto sizes = dimensions();
            const std::string variable = is_name(peek()) ? take() : "";
            const auto more = dimensions();
            sizes.insert(sizes.begin(), more.begin(), more.end());
            text += array_type(parameter, sizes) + (is_out ? "&" : "") + variable;
            outs.push_back(is_out);
            (void)is_const;
        }
        text += take();
        // GLSL's own functions of this name stay.
        if (!functions_.contains(name))
            usings_ += "template <typename B = Builtins, typename... T> static constexpr auto " + spelled(name) +
                       "(const T&... x) requires requires { B::" + spelled(name) + "(x...); } { return B::" + spelled(name) + "(x...); }\n";
        functions_[name].push_back(outs);
        if (peek() == ";") {  // a prototype: members of a struct know each other
            skip();
            std::string lines;
            for (const char c : text)
                if (c == '\n') lines += c;
            return lines;
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
        return "{ if (*bindings.is_stopped) [[unlikely]] throw Stopped(); " + statement() + " }";
    }
    std::string parenthesised() {
        std::string text = expect("(");
        text += is_declaration() ? declaration(false) : expression().text;
        return text + expect(")");
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
            if (peek() != ";") text += is_declaration() ? declaration(false) : expression().text;
            text += expect(";");
            if (peek() != ";") text += is_declaration() ? declaration(false) : expression().text;
            text += expect(";");
            if (peek() != ")") text += expression().text;
            text += expect(")");
            return text + body();
        }
        if (word == "case") return join({take(), expression().text, expect(":")});
        if (word == "default") return join({take(), expect(":")});
        if (word == "break" || word == "continue" || word == "discard") return join({take(), expect(";")});
        if (word == "return") {
            std::string text = take();
            if (peek() != ";") text += expression().text;
            return text + expect(";");
        }
        if (word == ";") return take();
        return join({is_declaration() ? declaration(false) : expression().text, expect(";")});
    }

    // Expressions.
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
            return call("make_array<" + array_type(type, sizes) + ">", word, {});
        }
        if (is_type(word)) return call(scalar_types.contains(word) ? skip() + "scalar<" + word + ">" : take(), word, {});
        if (is_name(word) && peek(1) == "(") {
            const auto found = functions_.find(word);
            std::string name = take();
            if (declared_.contains(word)) name.insert(name.size() - word.size(), "this->");
            return call(word == "not" ? name : name, word, found == functions_.end() ? outs_of_builtin(word) : found->second);
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
    Expression call(const std::string& name, const std::string&, const std::vector<std::vector<bool>>& overloads) {
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
                if (is_ordered && !is_known_twice) argument.text = "std::ref(" + argument.text + ")";
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

    std::vector<Token> tokens_;
    size_t at_ = 0;
    Names structs_, fields_, globals_, macros_;
    Names declared_;  // names in the declaration that is being read: their initialisers still call functions of these names
    std::map<std::string, std::vector<std::vector<bool>>, std::less<>>
        functions_;  // of each overload: which parameters are `out`
    std::string usings_;
};

}  // namespace

std::string translate(const std::string& glsl) { return Translator(glsl).translate(); }

}  // namespace lab::native
