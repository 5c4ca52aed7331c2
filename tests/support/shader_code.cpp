#include "support/shader_code.h"

#include <map>
#include <regex>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "shaders/interface.h"

namespace lab {
namespace {

constexpr auto environment = SPV_ENV_VULKAN_1_2;
using Words = std::vector<uint32_t>;

std::string disassemble(const Words& words) {
    std::string text;
    if (!spvtools::SpirvTools(environment).Disassemble(words, &text, SPV_BINARY_TO_TEXT_OPTION_NO_HEADER))
        throw std::runtime_error("SPIRV-Tools cannot read a shader");
    return text;
}

// All matches of a pattern, each with its groups starting at number 1.
std::vector<std::vector<std::string>> find_all(const std::string& text, const std::string& pattern) {
    const std::regex regex(pattern);
    std::vector<std::vector<std::string>> matches;
    for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match)
        matches.emplace_back(std::next(match->begin()), match->end());
    return matches;
}

// Names of functions by their ids; for GLSL functions, parameter types follow after a bracket.
std::map<std::string, std::string> function_names(const std::string& text) {
    std::map<std::string, std::string> names;
    for (const auto& match : find_all(text, R"re(OpName %(\d+) "(\w+)\()re")) names[match[0]] = match[1];
    return names;
}

// Prevents the named functions from being inlined, which would hide them.
void keep_apart(Words& words, const std::set<std::string>& functions) {
    constexpr uint32_t op_function = 54, dont_inline = 2, header_words = 5;
    const auto names = function_names(disassemble(words));
    for (size_t i = header_words; i < words.size(); i += words[i] >> 16) {
        if ((words[i] & 0xffff) != op_function) continue;
        const auto name = names.find(std::to_string(words[i + 2]));
        if (name != names.end() && functions.contains(name->second)) words[i + 3] |= dont_inline;
    }
}

Words optimise(const Words& words) {
    spvtools::Optimizer optimizer(environment);
    optimizer.RegisterPerformancePasses();
    spvtools::OptimizerOptions options;
    options.set_run_validator(false);  // it does not know scalar block layout
    Words optimised;
    if (!optimizer.Run(words.data(), words.size(), &optimised, options))
        throw std::runtime_error("SPIRV-Tools cannot optimise a shader");
    return optimised;
}

// The members of a struct that are read from the block at `binding`: through pointers with `depth` indices, or from a copy of the
// whole struct.
std::set<std::string> members_read(const std::string& text, const std::string& name, uint32_t binding, int depth) {
    std::map<std::string, std::string> members, constants;
    std::set<std::string> read;
    for (const auto& type : find_all(text, R"re(OpName (%\d+) ")re" + name + "\""))
        for (const auto& match : find_all(text, "OpMemberName " + type[0] + R"re( (\d+) "(\w+)")re"))
            members[match[0]] = match[1];
    for (const auto& match : find_all(text, R"re((%\d+) = OpConstant %\d+ (\d+)\n)re")) constants[match[0]] = match[1];
    const std::string index = R"re( (%\d+))re";
    std::string indices;
    for (int i = 0; i < depth; ++i) indices += R"re( %\d+)re";
    for (const auto& block : find_all(text, "OpDecorate (%\\d+) Binding " + std::to_string(binding) + "\n"))
        for (const auto& match : find_all(text, "OpAccessChain %\\d+ " + block[0] + indices + index))
            read.insert(members[constants[match[0]]]);
    for (const auto& type : find_all(text, R"re(OpName (%\d+) ")re" + name + "\""))
        for (const auto& copy : find_all(text, R"re((%\d+) = Op(?:CopyLogical|Load) )re" + type[0] + "\\b"))
            for (const auto& match : find_all(text, "OpCompositeExtract %\\d+ " + copy[0] + R"re( (\d+))re"))
                read.insert(members[match[0]]);
    return read;
}

// Lines between the heads and ends of functions.
size_t count_instructions(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    size_t count = 0;
    bool is_body = false;
    while (std::getline(lines, line)) {
        if (line.find("= OpFunction ") != std::string::npos) is_body = true;
        if (line.find("OpFunctionEnd") != std::string::npos) is_body = false;
        count += is_body;
    }
    return count;
}

}  // namespace

void ShaderCode::merge(const ShaderCode& other) {
    bindings.insert(other.bindings.begin(), other.bindings.end());
    functions.insert(other.functions.begin(), other.functions.end());
    material_members.insert(other.material_members.begin(), other.material_members.end());
    parameter_members.insert(other.parameter_members.begin(), other.parameter_members.end());
    reads_images |= other.reads_images;
    has_samplers |= other.has_samplers;
    instructions += other.instructions;
}

ShaderCode read_code(const ShaderSource& source, const std::set<std::string>& functions) {
    Words words = compile_shader(source);
    keep_apart(words, functions);
    ShaderCode code;
    for (const auto& match : find_all(disassemble(words), R"re(Binding (\d+))re"))
        code.bindings.insert(static_cast<uint32_t>(std::stoul(match[0])));
    const std::string text = disassemble(optimise(words));
    for (const auto& [id, name] : function_names(text))
        if (functions.contains(name)) code.functions.insert(name);
    code.material_members = members_read(text, "Material", BINDING_MATERIALS, 2);
    code.parameter_members = members_read(text, "RenderParameters", BINDING_RENDER_PARAMETERS, 1);
    code.reads_images = !find_all(text, R"re(OpTypeImage %\d+ 2D )re").empty();
    code.has_samplers = text.find("OpTypeSampledImage") != std::string::npos;
    code.instructions = count_instructions(text);
    return code;
}

}  // namespace lab
