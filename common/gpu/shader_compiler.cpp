#include "gpu/shader_compiler.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <regex>
#include <sstream>
#include <string_view>
#include <utility>

#include "error.h"
#include "files/cache.h"
#include "files/file.h"
#include "files/project_folder.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

// The name in an #include "name" line.
std::optional<std::string> included_name(std::string_view line) {
    const auto skip = [&](std::string_view word) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        const bool is_there = line.starts_with(word);
        if (is_there) line.remove_prefix(word.size());
        return is_there;
    };
    if (!skip("#") || !skip("include") || !skip("\"")) return std::nullopt;
    const size_t end = line.find('"');
    if (end == std::string_view::npos) return std::nullopt;
    return std::string(line.substr(0, end));
}

// Replaces each #include "…" by the file's text, every file once, with #line directives. The result is the compiler's input and
// the cache key. Shaders may come from strangers, so included files must lie in the folder of a named file or of a replacement,
// in shaders/ or in chapters/. Windows line ends and a byte order mark are accepted.
class Includer {
  public:
    explicit Includer(const ShaderSource& source) : named_(source.named_includes), replacements_(source.replacements) {
        folders_ = {project_folder() / "shaders", project_folder() / "chapters", fs::absolute(source.file).parent_path()};
        for (const auto& [name, file] : named_) folders_.push_back(fs::absolute(file).parent_path());
        for (const auto& [place, file] : replacements_) folders_.push_back(fs::absolute(file).parent_path());
        for (fs::path& folder : folders_) folder = fs::weakly_canonical(folder);
    }

    std::string expand(const fs::path& place) {
        const auto& [canonical, file] = *read_.emplace(fs::weakly_canonical(place), file_at(place)).first;
        // #line has names in quotes, and compilers disagree about escapes in them.
        if (file.generic_string().find_first_of("\"\\") != std::string::npos)
            throw UserError(file.generic_string() + ": the path of a shader must not contain \" or \\: rename the folder");
        std::string contents = read_file(file, max_shader_bytes);
        if (contents.starts_with("\xEF\xBB\xBF")) contents.erase(0, 3);
        std::istringstream stream(std::move(contents));
        std::string text, line;
        for (int number = 1; std::getline(stream, line); ++number) {
            if (line.ends_with('\r')) line.pop_back();
            const std::optional<std::string> name = included_name(line);
            text += name ? include(*name, place, file, number) : line + "\n";
        }
        return text;
    }

    // Places included so far, and the files that were read.
    const std::map<fs::path, fs::path>& read() const { return read_; }

  private:
    // The file that is read at this place.
    fs::path file_at(const fs::path& place) const {
        const auto replaced = replacements_.find(fs::weakly_canonical(place));
        return replaced == replacements_.end() ? place : replaced->second;
    }

    // The text that replaces an #include line of the file that is read at the place `includer`.
    std::string include(const std::string& name, const fs::path& includer, const fs::path& file, int line) {
        const std::string where = file.generic_string() + ":" + std::to_string(line) + ": ";
        const fs::path place = find(name, {includer.parent_path(), file.parent_path()}, where);
        std::string text;
        if (!read_.contains(fs::weakly_canonical(place)))
            text += "#line 1 \"" + file_at(place).generic_string() + "\"\n" + expand(place);
        return text + "#line " + std::to_string(line + 1) + " \"" + file.generic_string() + "\"\n";
    }

    fs::path find(const std::string& name, std::vector<fs::path> folders, const std::string& where) const {
        if (const auto named = named_.find(name); named != named_.end()) return named->second;
        folders.insert(folders.end(), {project_folder() / "shaders", project_folder() / "chapters"});
        for (const fs::path& folder : folders) {
            std::error_code error;
            const fs::path place = folder / name;
            if (!fs::exists(place, error)) continue;
            if (!is_in_the_tree(place))
                throw UserError(where + "the include file " + in_quotes(name) +
                                " is outside of the shader's folder, shaders/ and chapters/: copy it there");
            return place;
        }
        throw UserError(where + "cannot find the include file " + in_quotes(name));
    }

    bool is_in_the_tree(const fs::path& file) const {
        const fs::path real = fs::weakly_canonical(file);
        return std::any_of(folders_.begin(), folders_.end(), [&](const fs::path& folder) {
            return std::mismatch(folder.begin(), folder.end(), real.begin(), real.end()).first == folder.end();
        });
    }

    const std::map<std::string, fs::path>& named_;
    std::vector<fs::path> folders_;
    const Replacements& replacements_;
    std::map<fs::path, fs::path> read_;  // canonical places
};

constexpr struct {
    const char* part;  // of a message
    const char* advice;
} hints[] = {
    {"'path_trace' : no matching", "the shader has to define vec3 path_trace(Ray ray, inout uvec2 seed)"},
    {"no matching overloaded function", "is the name misspelt, or is an argument missing or of another type?"},
    {"undeclared identifier", "is it misspelt, or declared only further down?"},
    {"expecting COMMA or SEMICOLON", "is a semicolon missing before this line?"},
    {"unexpected LEFT_BRACE", "is a } missing further up?"},
    {"unexpected RIGHT_BRACE", "is there a } too many, or a semicolon missing before it?"},
    {"cannot convert from", "both sides need the same type; vec3(x) makes three numbers of one"},
    {"l-value required", "what is const cannot be assigned"},
};

// Finds the token in a glslang message "file:line: 'token' : text" that is a single byte of a non-ASCII character.
size_t find_lone_byte(const std::string& line) {
    const size_t token = line.find(": '");
    const bool is_lone = token != std::string::npos && token + 4 < line.size() &&
                         static_cast<unsigned char>(line[token + 3]) >= 0x80 && line[token + 4] == '\'';
    return is_lone ? token : std::string::npos;
}

// The feature of scenes without which the lab's shaders do not declare a name, such as FEATURE_LIGHT_TRIANGLES, or nothing.
std::string feature_of(const std::string& name, const std::string& shader) {
    constexpr std::string_view start = "#ifdef FEATURE_";
    const std::regex word("\\b" + name + "\\b");
    std::istringstream lines(shader);
    std::vector<std::string> conditions;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("#if")) {
            conditions.push_back(line);
        } else if (line.starts_with("#el") && !conditions.empty()) {
            conditions.back().clear();
        } else if (line.starts_with("#endif") && !conditions.empty()) {
            conditions.pop_back();
        } else if (std::regex_search(line.substr(0, line.find("//")), word)) {
            const auto feature = std::find_if(conditions.rbegin(), conditions.rend(),
                                              [&](const std::string& condition) { return condition.starts_with(start); });
            return feature == conditions.rend() ? "" : feature->substr(std::string_view("#ifdef ").size());
        }
    }
    return "";
}

std::string with_advice(const std::string& line, const std::string& shader) {
    static const std::regex unknown("'(\\w+)' : (undeclared identifier|no matching overloaded function|no such field)");
    std::smatch name;
    if (std::regex_search(line, name, unknown))
        if (const std::string feature = feature_of(name[1], shader); !feature.empty())
            return line + " (this scene lacks what it belongs to: put #ifdef " + feature +
                   " before and #endif after what needs it)";
    if (const size_t token = find_lone_byte(line); token != std::string::npos)
        return line.substr(0, token) + ": a character that is not ASCII, which GLSL knows in comments only";
    for (const auto& [part, advice] : hints)
        if (line.find(part) != std::string::npos) return line + " (" + advice + ")";
    return line;
}

// "caller(parameters calling callee(parameters" as a message.
std::string recursion_text(const std::string& line) {
    constexpr std::string_view calling = " calling ";
    const size_t middle = std::min(line.find(calling), line.size()), callee = std::min(middle + calling.size(), line.size());
    const size_t caller = std::min(line.find_first_not_of(' '), middle);
    const auto name = [&](size_t begin, size_t end) { return line.substr(begin, std::min(line.find('(', begin), end) - begin); };
    return name(caller, middle) + "() calls " + name(callee, line.size()) +
           "(), and so itself: GLSL has no recursion, write a loop";
}

// The errors in glslang's log as lines "file:line: text": only the first of each source line, since the others follow from it.
// The most common ones say what to do.
std::string readable_errors(const std::string& log, const std::string& shader) {
    std::istringstream lines(log);
    std::string line, text, place;
    while (std::getline(lines, line)) {
        constexpr std::string_view start = "ERROR: ";
        if (!line.starts_with(start) || line.find("compilation errors") != std::string::npos ||
            line.find("compilation terminated") != std::string::npos)
            continue;
        if (line.find("Recursion detected") != std::string::npos) {  // the next line tells where
            std::getline(lines, line);
            return recursion_text(line);
        }
        line = line.substr(start.size(), line.find_last_not_of(' ') + 1 - start.size());
        const std::string before = std::exchange(place, line.substr(0, line.find(": ")));
        if (place != before) text += (text.empty() ? "" : "\n") + with_advice(line, shader);
    }
    return text.empty() ? log : text;
}

EShLanguage stage_of(const fs::path& file) {
    static const std::map<std::string, EShLanguage> stages{
        {".comp", EShLangCompute}, {".rgen", EShLangRayGen}, {".rmiss", EShLangMiss}, {".rchit", EShLangClosestHit}};
    return stages.at(file.extension().string());
}

// A shader's text with everything it includes, and its defines.
struct ExpandedShader {
    std::string text, preamble;
    explicit ExpandedShader(const ShaderSource& source) : text(Includer(source).expand(source.file)) {
        if (source.edit) text = source.edit(text);
        preamble = "#extension GL_GOOGLE_cpp_style_line_directive : require\n";
        for (const auto& define : source.defines) preamble += "#define " + define + "\n";
    }
};

constexpr auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);

std::vector<uint32_t> compile(const ShaderSource& source, const ExpandedShader& expanded, bool has_lines) {
    static const bool initialised = glslang::InitializeProcess();
    if (!initialised) throw UserError("glslang could not be initialised");
    const EShLanguage stage = stage_of(source.file);
    glslang::TShader shader(stage);
    const std::string name = source.file.generic_string();  // GLSL interprets escapes in quotes
    const char* texts[] = {expanded.text.c_str()};
    const int lengths[] = {static_cast<int>(expanded.text.size())};
    const char* names[] = {name.c_str()};
    shader.setStringsWithLengthsAndNames(texts, lengths, names, 1);
    shader.setPreamble(expanded.preamble.c_str());
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 120);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
    if (!shader.parse(GetDefaultResources(), 460, false, messages))
        throw UserError(readable_errors(shader.getInfoLog(), expanded.text));
    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(messages))
        throw UserError(source.file.generic_string() + ": " + readable_errors(program.getInfoLog(), expanded.text));
    std::vector<uint32_t> words;
    glslang::SpvOptions options;
    options.generateDebugInfo = has_lines;
    glslang::GlslangToSpv(*program.getIntermediate(stage), words, &options);
    return words;
}

}  // namespace

std::map<fs::path, fs::path> shader_files(const ShaderSource& source) {
    Includer includer(source);
    includer.expand(source.file);
    return includer.read();
}

std::vector<uint32_t> compile_shader(const ShaderSource& source, bool has_lines) {
    const ExpandedShader expanded(source);
    const auto version = glslang::GetVersion();
    const std::string key = expanded.preamble + expanded.text + source.file.extension().string() +
                            (has_lines ? " with lines of " + source.file.generic_string() : "") + "/" +
                            std::to_string(version.major) + "." + std::to_string(version.minor) + "." +
                            std::to_string(version.patch);
    const std::string name = cache_name("shader", key);
    std::vector<uint32_t> words;
    if (const auto cached = read_cache(name)) {
        words.resize(cached->size() / sizeof(uint32_t));
        std::memcpy(words.data(), cached->data(), words.size() * sizeof(uint32_t));
        return words;
    }
    try {
        words = compile(source, expanded, has_lines);
    } catch (const UserError&) {
        if (!source.edit) throw;
        ShaderSource as_written = source;
        as_written.edit = {};
        compile_shader(as_written, has_lines);  // describes mistakes in the words of the file
        throw;
    }
    write_cache(name, {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(uint32_t)});
    return words;
}

}  // namespace lab
