#include "gpu/shader_compiler.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <cstring>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "error.h"
#include "files/cache.h"
#include "files/hash.h"
#include "files/project_folder.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

// Puts the text of included files in place of their #include "…" lines, each file once. #line directives keep
// the names and lines of messages right. One text then serves as input of the compiler and as key of the
// cache.
class Includer {
  public:
    explicit Includer(const ShaderSource& source) : named_(source.named_includes) {}

    std::string expand(const fs::path& file) {
        std::ifstream stream(file);
        if (!stream) throw UserError("cannot read the shader " + file.string());
        std::string text, line;
        for (int number = 1; std::getline(stream, line); ++number) {
            std::smatch name;
            if (!std::regex_match(line, name, include_line_)) {
                text += line + "\n";
                continue;
            }
            const fs::path included = find(name[1].str(), file, number);
            if (seen_.insert(fs::weakly_canonical(included)).second)
                text += "#line 1 \"" + included.generic_string() + "\"\n" + expand(included);
            text += "#line " + std::to_string(number + 1) + " \"" + file.generic_string() + "\"\n";
        }
        return text;
    }

    // Those in the text so far, without the first one.
    const std::set<fs::path>& included() const { return seen_; }

  private:
    fs::path find(const std::string& name, const fs::path& includer, int line) const {
        if (const auto named = named_.find(name); named != named_.end()) return named->second;
        if (const auto beside = includer.parent_path() / name; fs::exists(beside)) return beside;
        if (const auto shared = project_folder() / "shaders" / name; fs::exists(shared)) return shared;
        throw UserError(includer.generic_string() + ":" + std::to_string(line) +
                        ": cannot find the include file \"" + name + "\"");
    }

    const std::map<std::string, fs::path>& named_;
    std::set<fs::path> seen_;
    const std::regex include_line_{R"re(\s*#\s*include\s*"([^"]+)".*)re"};
};

EShLanguage stage_of(const fs::path& file) {
    static const std::map<std::string, EShLanguage> stages{{".comp", EShLangCompute},
                                                           {".rgen", EShLangRayGen},
                                                           {".rmiss", EShLangMiss},
                                                           {".rchit", EShLangClosestHit}};
    return stages.at(file.extension().string());
}

// glslang writes "ERROR: file:line: 'token' : text"; editors and people look for "file:line: text".
std::string readable(const std::string& log) {
    std::istringstream lines(log);
    std::string line, text;
    while (std::getline(lines, line)) {
        if (line.rfind("ERROR: ", 0) != 0 || line.find("compilation errors") != std::string::npos ||
            line.find("compilation terminated") != std::string::npos)
            continue;
        text += (text.empty() ? "" : "\n") + line.substr(std::strlen("ERROR: "));
    }
    return text.empty() ? log : text;
}

std::vector<uint32_t> compile(const ShaderSource& source, const std::string& text,
                              const std::string& preamble) {
    static const bool initialised = glslang::InitializeProcess();
    if (!initialised) throw UserError("glslang could not be initialised");
    const EShLanguage stage = stage_of(source.file);
    glslang::TShader shader(stage);
    const std::string name = source.file.generic_string();  // GLSL has escapes in quotes
    const char* texts[] = {text.c_str()};
    const int lengths[] = {static_cast<int>(text.size())};
    const char* names[] = {name.c_str()};
    shader.setStringsWithLengthsAndNames(texts, lengths, names, 1);
    shader.setPreamble(preamble.c_str());
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 120);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
    const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
    if (!shader.parse(GetDefaultResources(), 460, false, messages))
        throw UserError(readable(shader.getInfoLog()));
    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(messages)) throw UserError(name + ": " + readable(program.getInfoLog()));
    std::vector<uint32_t> words;
    glslang::GlslangToSpv(*program.getIntermediate(stage), words);
    return words;
}

}  // namespace

std::vector<fs::path> shader_files(const ShaderSource& source) {
    Includer includer(source);
    includer.expand(source.file);
    std::vector<fs::path> files{source.file};
    files.insert(files.end(), includer.included().begin(), includer.included().end());
    return files;
}

std::vector<uint32_t> compile_shader(const ShaderSource& source) {
    std::string text = Includer(source).expand(source.file);
    if (source.edit) text = source.edit(text);
    std::string preamble = "#extension GL_GOOGLE_cpp_style_line_directive : require\n";
    for (const auto& define : source.defines) preamble += "#define " + define + "\n";

    const auto version = glslang::GetVersion();
    const std::string key = preamble + text + source.file.extension().string() + "/" +
                            std::to_string(version.major) + "." + std::to_string(version.minor) + "." +
                            std::to_string(version.patch);
    // Two independent 64-bit hashes make a chance collision impossible in practice.
    const std::string name =
        "shader-" + std::to_string(hash_text(key)) + "-" + std::to_string(hash_text(key, key.size()));
    std::vector<uint32_t> words;
    if (const auto cached = read_cache(name)) {
        words.resize(cached->size() / sizeof(uint32_t));
        std::memcpy(words.data(), cached->data(), words.size() * sizeof(uint32_t));
        return words;
    }
    words = compile(source, text, preamble);
    write_cache(name, {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(uint32_t)});
    return words;
}

}  // namespace lab
