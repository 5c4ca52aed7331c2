// The tokens of GLSL, and how C++ spells them.
#pragma once
#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "error.h"

namespace lab::native {

using Names = std::set<std::string, std::less<>>;

inline const Names scalar_types{"void", "bool", "int", "uint", "float", "double"};
inline const Names dropped{"precise",  "highp",    "mediump",  "lowp",     "flat",      "smooth", "invariant",
                           "coherent", "volatile", "restrict", "readonly", "writeonly", "shared", "subroutine"};
// Names that C++ keeps for itself and GLSL does not.
// clang-format off
inline const Names cpp_words{
    "alignas", "alignof", "and", "and_eq", "assert", "auto", "bindings", "bitand", "bitor", "catch", "char", "char16_t",
    "char32_t", "char8_t", "co_await", "co_return", "co_yield", "compl", "concept", "const_cast", "consteval", "constexpr",
    "constinit", "decltype", "delete", "dynamic_cast", "errno", "explicit", "export", "friend", "main", "mutable", "new",
    "noexcept", "not", "not_eq", "nullptr", "operator", "or", "or_eq", "private", "protected", "register", "reinterpret_cast",
    "requires", "signed", "static_assert", "static_cast", "stderr", "stdin", "stdout", "thread_local", "throw", "try", "typeid",
    "typename", "virtual", "wchar_t", "xor", "xor_eq"};
// Names that the translation uses itself.
inline const Names own_words{
    "Array", "Builtins", "Loop", "Shader", "Span", "copied", "each", "get", "get_array", "get_constant", "glm", "lab", "lanes",
    "local_size", "make_array", "native", "run_group", "scalar", "std", "swizzle", "swizzled"};
// clang-format on

inline bool is_vector_type(const std::string& name) {
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

inline size_t component_index(char letter) { return std::string("xyzwrgbastpq").find(letter) % 4; }
// The indices of a swizzle's components as "2,0,1"; empty for other names.
inline std::string swizzle_indices(const std::string& name) {
    for (const std::string letters : {"xyzw", "rgba", "stpq"}) {
        std::string indices;
        for (const char letter : name) {
            const size_t index = letters.find(letter);
            if (index == std::string::npos) break;
            if (!indices.empty()) indices += ',';
            indices += std::to_string(index);
        }
        if (name.size() >= 2 && name.size() <= 4 && indices.size() == 2 * name.size() - 1) return indices;
    }
    return "";
}

// In braces, parts are made from left to right.
inline std::string join(std::initializer_list<std::string> parts) {
    std::string all;
    for (const auto& part : parts) all += part;
    return all;
}

struct Token {
    std::string space;  // before it: line ends and #line directives, too
    std::string text;   // empty at the end
};

inline std::vector<Token> tokenize(const std::string& glsl) {
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
            if (glsl.compare(at, 5, "#line") == 0) space += "\n" + glsl.substr(at, end - at);
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

// A text that is read token by token.
class TokenReader {
  protected:
    explicit TokenReader(const std::string& glsl) : tokens_(tokenize(glsl)) {}

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
    // Functions that read what may be nested call each other. Where they hold one of these, they do not exhaust the stack.
    class Nesting {
      public:
        explicit Nesting(TokenReader& reader) : depth_(reader.nesting_) {
            if (++depth_ > max_nesting)
                throw UserError(reader.place() + ": more than " + std::to_string(max_nesting) +
                                " levels of parentheses or blocks are too many for the backend native: use another one, "
                                "--backend compute");
        }
        ~Nesting() { --depth_; }

      private:
        static constexpr int max_nesting = 256;  // as many as Clang reads
        int& depth_;
    };
    // The file and line of the next token.
    std::string place() const {
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
        return place + ":" + std::to_string(line);
    }
    [[noreturn]] void fail() const {
        throw UserError(place() + ": the backend native does not know what '" + peek() +
                        "' means here: use another one, --backend compute");
    }
    static std::string spelled(const std::string& token) {
        if (cpp_words.contains(token) || own_words.contains(token) || token.ends_with('_'))
            return token + "_";  // so that new and new_ are two names
        if (std::isdigit(static_cast<unsigned char>(token[0])) || (token[0] == '.' && token.size() > 1)) {
            const bool is_hexadecimal = token.starts_with("0x") || token.starts_with("0X");
            if (is_hexadecimal && std::tolower(token.back()) != 'u') return "int(" + token + ")";  // C++ has an unsigned one
            if (!is_hexadecimal && token.find_first_of(".eE") != std::string::npos &&
                !std::isalpha(static_cast<unsigned char>(token.back())))
                return token + "f";
            // In C++ a decimal number that int cannot hold is a long one.
            const bool is_whole = token.find_first_not_of("0123456789") == token.npos;
            if (is_whole && std::stod(token) > 2147483647.0) return "int(" + token + "u)";
        }
        return token;
    }
    static bool is_name(const std::string& token) {
        return !token.empty() && (std::isalpha(static_cast<unsigned char>(token[0])) || token[0] == '_');
    }

    std::vector<Token> tokens_;
    size_t at_ = 0;
    int nesting_ = 0;
};

}  // namespace lab::native
