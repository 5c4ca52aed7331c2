// What a program declares: types, constants, variables and what bindings bring.
#include <bit>
#include <cmath>
#include <cstdio>

#include "native/writer.h"

namespace lab::native {

// Types. Structures that differ in their layout alone are one type, since layouts are checked.
bool Writer::has_kind(Id type, spv::Op op) const {
    if (kind(type) == op) return true;
    const auto& operands = program_.definition(type).operands;
    if (kind(type) == spv::OpTypeStruct)
        return std::any_of(operands.begin(), operands.end(), [&](Id part) { return has_kind(part, op); });
    const bool has_parts = kind(type) == spv::OpTypeArray || kind(type) == spv::OpTypeRuntimeArray ||
                           kind(type) == spv::OpTypeVector || kind(type) == spv::OpTypeMatrix;
    return has_parts && has_kind(operands[0], op);
}
Id Writer::same_structure(Id type) const {
    const auto key = [&](Id structure) {
        std::string all = program_.name(structure);
        const auto& members = program_.definition(structure).operands;
        for (uint32_t i = 0; i < members.size(); ++i)
            all += ";" + program_.member_name(structure, i) + ":" +
                   (has_kind(members[i], spv::OpTypeRuntimeArray) ? std::to_string(structure) : plain_type(members[i]));
        return all;
    };
    const std::string wanted = key(type);
    for (const Id id : program_.globals)
        if (kind(id) == spv::OpTypeStruct && (id == type || key(id) == wanted)) return id;
    return type;
}
std::string Writer::plain_type(Id type) const {
    const Instruction& definition = program_.definition(type);
    const auto& operands = definition.operands;
    switch (definition.op) {
        case spv::OpTypeVoid:
            return "void";
        case spv::OpTypeBool:
            return "bool";
        case spv::OpTypeInt:
            if (operands[0] != 32) program_.fail(definition, "numbers of other than 32 bits");
            return operands[1] ? "int" : "lab__::uint";
        case spv::OpTypeFloat:
            if (operands[0] != 32) program_.fail(definition, "numbers of other than 32 bits");
            return "float";
        case spv::OpTypeVector: {
            const spv::Op component = kind(operands[0]);
            const std::string letter = component == spv::OpTypeBool                        ? "b"
                                       : component == spv::OpTypeFloat                     ? ""
                                       : program_.definition(operands[0]).operands[1] != 0 ? "i"
                                                                                           : "u";
            return "lab__::" + letter + "vec" + std::to_string(operands[1]);
        }
        case spv::OpTypeMatrix:
            return "lab__::mat" + std::to_string(operands[1]) + "x" +
                   std::to_string(program_.definition(operands[0]).operands[1]);
        case spv::OpTypeArray:
            return "lab__::Array<" + plain_type(operands[0]) + ", " + std::to_string(program_.number(operands[1])) + ">";
        case spv::OpTypeStruct: {
            const Id id = same_structure(type);
            return program_.name(id) + "__" + std::to_string(id);
        }
        default:
            program_.fail(definition, "a type of this shader");
    }
}
std::string Writer::field(Id structure, uint32_t member) const {
    const std::string name = program_.member_name(structure, member);
    return name.empty() ? "m" + std::to_string(member) : spelled(name);
}
std::string Writer::structure(Id type) const {
    std::string text = "struct " + plain_type(type) + " {";
    const auto& members = program_.definition(type).operands;
    for (uint32_t i = 0; i < members.size(); ++i) text += " " + plain_type(members[i]) + " " + field(type, i) + ";";
    return text + " };\n";
}
// In bytes, where numbers follow each other without a gap: layout(scalar).
size_t Writer::size_in_memory(Id type) const {
    const Instruction& definition = program_.definition(type);
    const auto refuse = [&] { program_.fail(definition, "a layout of memory other than layout(scalar)"); };
    switch (definition.op) {
        case spv::OpTypeVector:
        case spv::OpTypeMatrix:
            return definition.operands[1] * size_in_memory(definition.operands[0]);
        case spv::OpTypeRuntimeArray:
        case spv::OpTypeArray: {
            const size_t element = size_in_memory(definition.operands[0]);
            if (program_.decoration(type, spv::DecorationArrayStride) != static_cast<int64_t>(element)) refuse();
            return element * (definition.op == spv::OpTypeArray ? program_.number(definition.operands[1]) : 0);
        }
        case spv::OpTypeStruct: {
            size_t size = 0;
            for (uint32_t i = 0; i < definition.operands.size(); ++i) {
                if (program_.decoration(type, spv::DecorationOffset, i) != static_cast<int64_t>(size)) refuse();
                const Id member = definition.operands[i];
                Id matrix = member;
                while (kind(matrix) == spv::OpTypeArray || kind(matrix) == spv::OpTypeRuntimeArray)
                    matrix = program_.definition(matrix).operands[0];
                if (program_.decoration(type, spv::DecorationRowMajor, i) >= 0 ||
                    (kind(matrix) == spv::OpTypeMatrix &&
                     program_.decoration(type, spv::DecorationMatrixStride, i) !=
                         static_cast<int64_t>(size_in_memory(program_.definition(matrix).operands[0]))))
                    refuse();
                size += size_in_memory(member);
            }
            return size;
        }
        default:
            return 4;
    }
}

// Constants and global variables.
std::string Writer::constant(Id id) const {
    const Instruction& definition = program_.definition(id);
    const Id type = definition.type;
    if (definition.op == spv::OpConstantTrue || definition.op == spv::OpSpecConstantTrue) return "true";
    if (definition.op == spv::OpConstantFalse || definition.op == spv::OpSpecConstantFalse) return "false";
    if (definition.op == spv::OpConstantNull || definition.op == spv::OpUndef) return plain_type(type) + "{}";
    if (definition.op == spv::OpConstantComposite) {
        if (kind(type) == spv::OpTypeArray || kind(type) == spv::OpTypeStruct) return "constant__" + std::to_string(id);
        std::string parts;
        for (const Id part : definition.operands) parts += (parts.empty() ? "" : ", ") + constant(part);
        return plain_type(type) + "(" + parts + ")";
    }
    if (definition.op != spv::OpConstant && definition.op != spv::OpSpecConstant)
        program_.fail(definition, "constants that are computed from specialisation constants");
    const uint32_t word = definition.operands.at(0);
    if (kind(type) == spv::OpTypeInt) {
        if (program_.definition(type).operands[1] == 0) return std::to_string(word) + "u";
        return "int(" + std::to_string(static_cast<int32_t>(word)) + (word == 0x80000000u ? "ll)" : ")");
    }
    const float number = std::bit_cast<float>(word);
    char text[40];
    if (!std::isfinite(number))
        std::snprintf(text, sizeof text, "std::bit_cast<float>(0x%xu)", word);
    else
        std::snprintf(text, sizeof text, std::signbit(number) ? "(%af)" : "%af", static_cast<double>(number));
    return text;
}
std::string Writer::global(Id id) {
    const Instruction& definition = program_.definition(id);
    if (definition.op == spv::OpTypeStruct)
        return same_structure(id) == id && !has_kind(id, spv::OpTypeRuntimeArray) && !program_.is_block(id) ? structure(id) : "";
    if (definition.op == spv::OpConstantComposite && constant(id).starts_with("constant__")) {
        std::string parts;
        for (const Id part : definition.operands) parts += (parts.empty() ? "" : ", ") + constant(part);
        return "inline static const " + plain_type(definition.type) + " " + constant(id) +
               (kind(definition.type) == spv::OpTypeArray ? "{{" + parts + "}};\n" : "{" + parts + "};\n");
    }
    if (definition.op != spv::OpVariable) return "";
    const spv::StorageClass storage = program_.storage(id);
    if (storage == spv::StorageClassInput) {
        static const std::map<int64_t, std::string> inputs{{spv::BuiltInNumWorkgroups, "gl_NumWorkGroups"},
                                                           {spv::BuiltInWorkgroupId, "gl_WorkGroupID"},
                                                           {spv::BuiltInLocalInvocationId, "gl_LocalInvocationID"},
                                                           {spv::BuiltInGlobalInvocationId, "gl_GlobalInvocationID"},
                                                           {spv::BuiltInLocalInvocationIndex, "gl_LocalInvocationIndex"}};
        const auto input = inputs.find(program_.decoration(id, spv::DecorationBuiltIn));
        if (input == inputs.end()) program_.fail(definition, program_.name(id));
        names_[id] = "this->" + input->second;
        return "";
    }
    if (storage == spv::StorageClassWorkgroup) program_.fail(definition, "shared variables");
    if (storage != spv::StorageClassPrivate) return resources(id);
    const std::string name = fresh_name(program_.name(id), id);
    names_[id] = "this->" + name;
    return type_name(program_.pointee(definition.type), id) + " " + name +
           (definition.operands.size() > 1 ? " = " + constant(definition.operands[1]) : "") + ";\n";
}
// What a binding brings: the parts of a buffer, or textures.
std::string Writer::resources(Id variable) {
    const Id type = program_.pointee(type_of(variable));
    const std::string binding = std::to_string(program_.decoration(variable, spv::DecorationBinding));
    const std::string bindings = "lab__::ShaderBase::bindings, ";
    if (kind(type) != spv::OpTypeStruct) {
        const std::string name = fresh_name(program_.name(variable), variable);
        names_[variable] = "this->" + name;
        const bool is_list = kind(type) == spv::OpTypeArray || kind(type) == spv::OpTypeRuntimeArray;
        if (kind(is_list ? program_.definition(type).operands[0] : type) != spv::OpTypeImage)
            program_.fail(program_.definition(variable), "'" + program_.name(variable) + "'");
        return kind(type) == spv::OpTypeImage
                   ? "const lab__::Texture& " + name + " = lab__::get<lab__::Texture>(" + bindings + binding + ", 0);\n"
                   : "lab__::Span<lab__::Texture> " + name + " = lab__::get_array<lab__::Texture>(" + bindings + binding +
                         ", 0);\n";
    }
    size_in_memory(type);
    std::string text;
    const auto& members = program_.definition(type).operands;
    for (uint32_t i = 0; i < members.size(); ++i) {
        const std::string name = fresh_name(program_.member_name(type, i), variable);
        block_names_[{variable, i}] = "this->" + name;
        const bool is_open = kind(members[i]) == spv::OpTypeRuntimeArray;
        const std::string part = plain_type(is_open ? program_.definition(members[i]).operands[0] : members[i]);
        const std::string offset = std::to_string(program_.decoration(type, spv::DecorationOffset, i));
        if (program_.storage(variable) == spv::StorageClassPushConstant)
            text += part + "& " + name + " = lab__::get_constant<" + part + ">(" + bindings + offset + ");\n";
        else
            text += (is_open ? "lab__::Span<" + part + "> " : part + "& ") + name + " = lab__::get" +
                    (is_open ? "_array<" : "<") + part + ">(" + bindings + binding + ", " + offset + ");\n";
    }
    return text;
}

}  // namespace lab::native
