#include "gpu/compiler_messages.h"

#include <sstream>
#include <string_view>
#include <utility>

namespace lab {
namespace {

constexpr struct {
    const char* part;  // of a message
    const char* advice;
} hints[] = {
    {"'path_trace' : no matching", "the shader has to define vec3 path_trace(Ray ray, inout uvec2 seed)"},
    {"no matching overloaded function",
     "is the name misspelt, or is an argument missing or of another type?"},
    {"undeclared identifier", "is it misspelt, or declared only further down?"},
    {"expecting COMMA or SEMICOLON", "is a semicolon missing before this line?"},
    {"unexpected LEFT_BRACE", "is a } missing further up?"},
    {"unexpected RIGHT_BRACE", "is there a } too many, or a semicolon missing before it?"},
    {"cannot convert from", "both sides need the same type; vec3(x) makes three numbers of one"},
    {"l-value required", "what is const cannot be assigned"},
};

// Whether a message of glslang, "file:line: 'token' : text", names one byte of a character that is not ASCII,
// which no terminal shows.
size_t find_lone_byte(const std::string& line) {
    const size_t token = line.find(": '");
    const bool is_lone = token != std::string::npos && token + 4 < line.size() &&
                         static_cast<unsigned char>(line[token + 3]) >= 0x80 && line[token + 4] == '\'';
    return is_lone ? token : std::string::npos;
}

std::string with_advice(const std::string& line) {
    if (const size_t token = find_lone_byte(line); token != std::string::npos)
        return line.substr(0, token) + ": a character that is not ASCII, which GLSL knows in comments only";
    for (const auto& [part, advice] : hints)
        if (line.find(part) != std::string::npos) return line + " (" + advice + ")";
    return line;
}

}  // namespace

std::string readable_errors(const std::string& log) {
    std::istringstream lines(log);
    std::string line, text, place;
    while (std::getline(lines, line)) {
        constexpr std::string_view start = "ERROR: ";
        if (!line.starts_with(start) || line.find("compilation errors") != std::string::npos ||
            line.find("compilation terminated") != std::string::npos)
            continue;
        line = line.substr(start.size(), line.find_last_not_of(' ') + 1 - start.size());
        const std::string before = std::exchange(place, line.substr(0, line.find(": ")));
        if (place != before) text += (text.empty() ? "" : "\n") + with_advice(line);
    }
    return text.empty() ? log : text;
}

}  // namespace lab
