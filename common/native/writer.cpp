#ifndef _WIN32
#include "native/writer.h"

#include <bit>
#include <cmath>
#include <cstdio>

namespace lab::native {
namespace {

// As C++ spells a name of GLSL, which may be a word of C++.
std::string spelled(const std::string& name) {
    static const std::set<std::string> words{
        "alignas",   "alignof",   "and",       "and_eq",       "asm",          "assert",      "auto",             "bitand",
        "bitor",     "catch",     "char",      "char16_t",     "char32_t",     "char8_t",     "class",            "co_await",
        "co_return", "co_yield",  "compl",     "concept",      "const_cast",   "consteval",   "constexpr",        "constinit",
        "decltype",  "delete",    "dynamic_cast", "enum",      "errno",        "explicit",    "export",           "extern",
        "friend",    "goto",      "inline",    "long",         "main",         "mutable",     "namespace",        "new",
        "noexcept",  "not",       "not_eq",    "nullptr",      "operator",     "or",          "or_eq",            "private",
        "protected", "public",    "register",  "reinterpret_cast", "requires", "short",       "signed",           "sizeof",
        "static",    "static_assert", "static_cast", "stderr", "stdin",        "stdout",      "template",         "this",
        "thread_local", "throw",  "try",       "typedef",      "typeid",       "typename",    "union",            "unsigned",
        "using",     "virtual",   "volatile",  "wchar_t",      "xor",          "xor_eq"};
    return words.contains(name) ? name + "__" : name;
}

// Instructions of GLSL.std.450 by their number (registry.khronos.org/SPIR-V/specs/unified1/GLSL.std.450.html).
constexpr const char* extended[] = {
    "", "round", "roundEven", "trunc", "abs", "abs", "sign", "sign", "floor", "ceil", "fract", "radians", "degrees", "sin", "cos",
    "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "atan", "pow", "exp", "log", "exp2", "log2",
    "sqrt", "inversesqrt", "determinant", "inverse", "", "modf", "min", "min", "min", "max", "max", "max", "clamp", "clamp",
    "clamp", "mix", "mix", "step", "smoothstep", "fma", "", "frexp", "ldexp", "packSnorm4x8", "packUnorm4x8", "packSnorm2x16",
    "packUnorm2x16", "packHalf2x16", "", "unpackSnorm2x16", "unpackUnorm2x16", "unpackHalf2x16", "unpackSnorm4x8",
    "unpackUnorm4x8", "", "length", "distance", "cross", "normalize", "faceforward", "reflect", "refract", "findLSB", "findMSB",
    "findMSB"};

// Operators, and functions of Builtins.
const std::map<spv::Op, std::string>& operations() {
    static const std::map<spv::Op, std::string> all{
        {spv::OpIAdd, "+"}, {spv::OpFAdd, "+"}, {spv::OpISub, "-"}, {spv::OpFSub, "-"}, {spv::OpIMul, "*"}, {spv::OpFMul, "*"},
        {spv::OpFDiv, "/"}, {spv::OpVectorTimesScalar, "*"}, {spv::OpBitwiseAnd, "&"}, {spv::OpBitwiseOr, "|"},
        {spv::OpBitwiseXor, "^"}, {spv::OpLogicalAnd, "both"}, {spv::OpLogicalOr, "either"},
        {spv::OpMatrixTimesScalar, "multiply"}, {spv::OpVectorTimesMatrix, "multiply"}, {spv::OpMatrixTimesVector, "multiply"},
        {spv::OpMatrixTimesMatrix, "multiply"}, {spv::OpOuterProduct, "outerProduct"}, {spv::OpTranspose, "transpose"},
        {spv::OpDot, "dot"}, {spv::OpFNegate, "negate"}, {spv::OpSNegate, "negate"}, {spv::OpNot, "flip"},
        {spv::OpLogicalNot, "not_"}, {spv::OpSDiv, "quotient"}, {spv::OpUDiv, "quotient"}, {spv::OpSMod, "remainder"},
        {spv::OpUMod, "remainder"}, {spv::OpFMod, "mod"}, {spv::OpAny, "any"}, {spv::OpAll, "all"}, {spv::OpIsNan, "isnan"},
        {spv::OpIsInf, "isinf"}, {spv::OpBitReverse, "bitfieldReverse"}, {spv::OpBitCount, "bitCount"},
        {spv::OpBitFieldInsert, "bitfieldInsert"}, {spv::OpBitFieldSExtract, "bitfieldExtract"},
        {spv::OpBitFieldUExtract, "bitfieldExtract"}, {spv::OpSelect, "select"}, {spv::OpIEqual, "equal"},
        {spv::OpFOrdEqual, "equal"}, {spv::OpLogicalEqual, "equal"}, {spv::OpINotEqual, "notEqual"},
        {spv::OpFOrdNotEqual, "notEqual"}, {spv::OpFUnordNotEqual, "notEqual"}, {spv::OpLogicalNotEqual, "notEqual"},
        {spv::OpULessThan, "lessThan"}, {spv::OpSLessThan, "lessThan"}, {spv::OpFOrdLessThan, "lessThan"},
        {spv::OpULessThanEqual, "lessThanEqual"}, {spv::OpSLessThanEqual, "lessThanEqual"},
        {spv::OpFOrdLessThanEqual, "lessThanEqual"}, {spv::OpUGreaterThan, "greaterThan"}, {spv::OpSGreaterThan, "greaterThan"},
        {spv::OpFOrdGreaterThan, "greaterThan"}, {spv::OpUGreaterThanEqual, "greaterThanEqual"},
        {spv::OpSGreaterThanEqual, "greaterThanEqual"}, {spv::OpFOrdGreaterThanEqual, "greaterThanEqual"}};
    return all;
}
// Functions with two results.
const std::map<spv::Op, std::string> pairs{{spv::OpUMulExtended, "multiply_extended"},
                                           {spv::OpSMulExtended, "multiply_extended"},
                                           {spv::OpIAddCarry, "add_carry"},
                                           {spv::OpISubBorrow, "subtract_borrow"}};
const std::map<spv::Op, std::string> atomics{
    {spv::OpAtomicIAdd, "atomicAdd"}, {spv::OpAtomicSMin, "atomicMin"}, {spv::OpAtomicUMin, "atomicMin"},
    {spv::OpAtomicSMax, "atomicMax"}, {spv::OpAtomicUMax, "atomicMax"}, {spv::OpAtomicAnd, "atomicAnd"},
    {spv::OpAtomicOr, "atomicOr"},    {spv::OpAtomicXor, "atomicXor"},  {spv::OpAtomicExchange, "atomicExchange"}};

std::string joined(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
    return all;
}

}  // namespace

// Types. Structures that differ in their layout alone are one type, since layouts are checked.
Id Writer::element_type(Id type, uint32_t member) const {
    const auto& operands = program_.definition(type).operands;
    return operands[kind(type) == spv::OpTypeStruct ? member : 0];
}
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
            const std::string letter = component == spv::OpTypeBool                         ? "b"
                                       : component == spv::OpTypeFloat                      ? ""
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
                if (kind(member) == spv::OpTypeMatrix &&
                    program_.decoration(type, spv::DecorationMatrixStride, i) !=
                        static_cast<int64_t>(size_in_memory(element_type(member))))
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
    if (definition.op == spv::OpConstantTrue) return "true";
    if (definition.op == spv::OpConstantFalse) return "false";
    if (definition.op == spv::OpConstantNull || definition.op == spv::OpUndef) return plain_type(type) + "{}";
    if (definition.op == spv::OpConstantComposite) {
        if (kind(type) == spv::OpTypeArray || kind(type) == spv::OpTypeStruct) return "constant__" + std::to_string(id);
        std::string parts;
        for (const Id part : definition.operands) parts += (parts.empty() ? "" : ", ") + constant(part);
        return plain_type(type) + "(" + parts + ")";
    }
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
        static const std::map<int64_t, std::string> inputs{{spv::BuiltInWorkgroupId, "gl_WorkGroupID"},
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
        if (!has_kind(type, spv::OpTypeImage)) program_.fail(program_.definition(variable), program_.name(variable));
        return kind(type) == spv::OpTypeImage
                   ? "const lab__::Texture& " + name + " = lab__::get<lab__::Texture>(" + bindings + binding + ", 0);\n"
                   : "lab__::Span<lab__::Texture> " + name + " = lab__::get_array<lab__::Texture>(" + bindings + binding + ", 0);\n";
    }
    size_in_memory(type);
    std::string text;
    const auto& members = program_.definition(type).operands;
    for (uint32_t i = 0; i < members.size(); ++i) {
        const std::string name = fresh_name(program_.member_name(type, i), variable);
        block_names_[{variable, i}] = "this->" + name;
        const bool is_open = kind(members[i]) == spv::OpTypeRuntimeArray;
        const std::string part = plain_type(is_open ? element_type(members[i]) : members[i]);
        const std::string offset = std::to_string(program_.decoration(type, spv::DecorationOffset, i));
        if (program_.storage(variable) == spv::StorageClassPushConstant)
            text += part + "& " + name + " = lab__::get_constant<" + part + ">(" + bindings + offset + ");\n";
        else
            text += (is_open ? "lab__::Span<" + part + "> " : part + "& ") + name + " = lab__::get" + (is_open ? "_array<" : "<") +
                    part + ">(" + bindings + binding + ", " + offset + ");\n";
    }
    return text;
}

// Names.
std::string Writer::fresh_name(const std::string& wish, Id id) {
    std::string name = wish.empty() ? "value__" + std::to_string(id) : spelled(wish.substr(0, wish.find('(')));
    for (const auto& names : visible_)
        if (names.contains(name)) {
            name += "__" + std::to_string(id);
            break;
        }
    visible_.back().insert(name);
    return name;
}
Pointer Writer::pointer_to(Id id) const {
    const auto found = pointers_.find(id);
    return found != pointers_.end() ? found->second : Pointer{.root = id, .type = program_.pointee(type_of(id))};
}
std::string Writer::element(const std::string& text, Id& type, Id index) {
    const bool is_structure = kind(type) == spv::OpTypeStruct;
    const uint32_t member = is_structure ? program_.number(index) : 0;
    const std::string part = is_structure ? "." + field(type, member) : "[" + value(index) + "]";
    type = element_type(type, member);
    return text + part;
}
std::string Writer::place(const Pointer& pointer, size_t end) {
    size_t next = 0;
    std::string text;
    Id type = program_.pointee(type_of(pointer.root));
    if (const auto table = program_.tables.find(pointer.root); table != program_.tables.end()) {
        text = constant(table->second);
    } else if (block_names_.contains({pointer.root, 0})) {
        const uint32_t member = program_.number(pointer.indices.at(next++));
        text = block_names_.at({pointer.root, member});
        type = element_type(type, member);
    } else {
        text = names_.at(pointer.root);
    }
    for (; next < std::min(end, pointer.indices.size()); ++next) text = element(text, type, pointer.indices[next]);
    return text;
}

// Values.
std::string Writer::value(Id id) {
    if (program_.is_constant(id)) return constant(id);
    if (const auto found = pending_.find(id); found != pending_.end()) {
        reads_ |= found->second.reads;
        depth_ = std::max(depth_, found->second.depth);
        std::string text = std::move(found->second.text);
        pending_.erase(found);
        return text;
    }
    if (const auto found = names_.find(id); found != names_.end()) return found->second;
    return constant(id);  // undefined
}
// Writes what is pending: all, or what a change of variables might change.
void Writer::flush(bool only_reads) {
    std::vector<Id> rest;
    for (const Id id : std::exchange(order_, {})) {
        const auto found = pending_.find(id);
        if (found == pending_.end()) continue;
        if (only_reads && !found->second.reads) {
            rest.push_back(id);
            continue;
        }
        out("const auto " + names_[id] + " = " + found->second.text + "; ");
        pending_.erase(found);
    }
    order_ = std::move(rest);
}
void Writer::give(const Instruction& instruction, const std::string& text, bool reads) {
    constexpr int deepest = 30;  // parentheses, which compilers do not like deep
    names_[instruction.id] = "value__" + std::to_string(instruction.id);
    const bool is_short = uses_[instruction.id] == 1 && depth_ < deepest;
    pending_[instruction.id] = {text, reads || reads_, depth_ + 1};
    order_.push_back(instruction.id);
    if (!is_short) flush();
}
void Writer::line(const Instruction& at) {
    const std::string& file = program_.name(at.file);
    if (at.line == 0 || (at.line == line_ && file == file_)) return;
    out("\n#line " + std::to_string(at.line) + " \"" + file + "\"\n");
    line_ = at.line;
    file_ = file;
}
std::string Writer::call(const Instruction& instruction) {
    const Id callee = instruction.operands[0];
    std::vector<std::string> parts;
    for (size_t i = 1; i < instruction.operands.size(); ++i) {
        const Id argument = instruction.operands[i];
        parts.push_back(program_.is_pointer(type_of(argument)) ? place(pointer_to(argument)) : value(argument));
    }
    const std::string name = is_native(program_, callee)
                                 ? "lab__::ShaderBase::" + program_.name(callee).substr(0, program_.name(callee).find('('))
                                 : "this->" + names_.at(callee);
    return name + "(" + mask(!parts.empty()) + joined(parts) + ")";
}
std::string Writer::load(const Pointer& pointer) { return place(pointer); }
void Writer::store(const Pointer& pointer, Id stored) {
    const std::string text = value(stored), target = place(pointer);
    flush(true);
    out(target + " = " + text + "; ");
}
std::string Writer::atomic(const std::string& name, const Instruction& instruction) {
    return "lab__::Builtins::" + name + "(" + place(pointer_to(instruction.operands[0])) + ", " + value(instruction.operands.back()) + ")";
}
std::string Writer::fetch(const Instruction& instruction) {
    return "lab__::Builtins::texelFetch(" + place(pointer_to(instruction.operands[0])) + ", " + value(instruction.operands[1]) + ")";
}
std::string Writer::operation(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    const std::string type = type_name(instruction.type, instruction.id), builtin = "lab__::Builtins::";
    const auto values = [&](size_t first, size_t end = SIZE_MAX) {
        std::vector<std::string> all;
        for (size_t i = first; i < std::min(end, operands.size()); ++i) all.push_back(value(operands[i]));
        return joined(all);
    };
    const auto part_of = [&](std::string text, Id whole, size_t first) {
        for (size_t i = first; i < operands.size(); ++i) {
            text += kind(whole) == spv::OpTypeStruct ? "." + field(whole, operands[i]) : "[" + std::to_string(operands[i]) + "]";
            whole = element_type(whole, operands[i]);
        }
        return text;
    };
    if (const auto found = operations().find(instruction.op); found != operations().end()) {
        if (found->second.size() > 1) return builtin + found->second + "(" + values(0) + ")";
        const std::string first = value(operands[0]);
        return "(" + first + " " + found->second + " " + value(operands[1]) + ")";
    }
    if (const auto found = pairs.find(instruction.op); found != pairs.end())
        return builtin + found->second + "<" + type + ">(" + values(0) + ")";
    switch (instruction.op) {
        case spv::OpExtInst: {
            const uint32_t number = operands[1];
            const std::string name = number < std::size(extended) ? extended[number] : "";
            if (name.empty()) program_.fail(instruction, "a function of this line");
            return builtin + name + (kind(instruction.type) == spv::OpTypeStruct ? "<" + type + ">" : "") + "(" + values(2) + ")";
        }
        case spv::OpShiftLeftLogical:
        case spv::OpShiftRightLogical:
        case spv::OpShiftRightArithmetic: {
            const std::string first = value(operands[0]);
            return "(" + first + (instruction.op == spv::OpShiftLeftLogical ? " << " : " >> ") + "lab__::convert<" +
                   plain_type(instruction.type) + ">(" + value(operands[1]) + "))";
        }
        case spv::OpConvertFToS:
        case spv::OpConvertFToU:
        case spv::OpConvertSToF:
        case spv::OpConvertUToF:
            return "lab__::convert<" + plain_type(instruction.type) + ">(" + values(0) + ")";
        case spv::OpBitcast:
            return "lab__::bits<" + plain_type(instruction.type) + ">(" + values(0) + ")";
        case spv::OpCopyObject:
        case spv::OpCopyLogical:
            return values(0);
        case spv::OpUndef:
            return plain_type(instruction.type) + "{}";
        case spv::OpCompositeConstruct:
            if (kind(instruction.type) == spv::OpTypeArray) return type + "{{" + values(0) + "}}";
            if (kind(instruction.type) == spv::OpTypeStruct) return type + "{" + values(0) + "}";
            return "lab__::make<" + plain_type(instruction.type) + ">(" + values(0) + ")";
        case spv::OpCompositeExtract:
            return part_of(value(operands[0]), type_of(operands[0]), 1);
        case spv::OpCompositeInsert: {
            const std::string inserted = value(operands[0]), whole = value(operands[1]);
            return "lab__::changed(" + type + "(" + whole + "), [&](auto& x__) { " + part_of("x__", instruction.type, 2) + " = " +
                   inserted + "; })";
        }
        case spv::OpVectorExtractDynamic: {
            const std::string vector = value(operands[0]);
            return vector + "[" + value(operands[1]) + "]";
        }
        case spv::OpVectorShuffle: {
            std::string indices;
            for (size_t i = 2; i < operands.size(); ++i)
                indices += (i > 2 ? ", " : "") + std::to_string(operands[i] == UINT32_MAX ? 0 : operands[i]);
            const std::string first = value(operands[0]), second = operands[0] == operands[1] ? first : value(operands[1]);
            return "lab__::shuffle<" + indices + ">(" + first + ", " + second + ")";
        }
        case spv::OpArrayLength: {
            const std::string name = block_names_.at({operands[0], operands[1]});
            return "lab__::uint(" + name + ".length())";
        }
        case spv::OpImageFetch:
            return fetch(instruction);
        case spv::OpImageQuerySizeLod:
        case spv::OpImageQuerySize:
            return builtin + "textureSize(" + place(pointer_to(operands[0])) + ")";
        default:
            if (const auto found = atomics.find(instruction.op); found != atomics.end()) return atomic(found->second, instruction);
            program_.fail(instruction, "a function of this line (SPIR-V's instruction " + std::to_string(instruction.op) + ")");
    }
}

// Statements.
void Writer::execute(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    reads_ = false;
    depth_ = 0;
    if (instruction.op == spv::OpAccessChain) {
        note_pointer(pointers_, program_, instruction);
        if (uses_[instruction.id] > 1) flush();  // its indices are read once
        return;
    }
    line(instruction);
    if (instruction.op == spv::OpStore) {
        const Pointer target = pointer_to(operands[0]);
        if (undeclared_.erase(operands[0]) == 0) return store(target, operands[1]);
        const std::string text = value(operands[1]);
        flush(true);
        names_[target.root] = fresh_name(program_.name(target.root), target.root);
        return out(type_name(target.type, target.root) + " " + names_[target.root] + " = " + text + "; ");
    }
    if (instruction.op == spv::OpFunctionCall) {
        const std::string text = call(instruction);
        flush(true);
        if (kind(instruction.type) == spv::OpTypeVoid || uses_[instruction.id] == 0) return out(text + "; ");
        names_[instruction.id] = "value__" + std::to_string(instruction.id);
        return out("const auto " + names_[instruction.id] + " = " + text + "; ");
    }
    if (instruction.op == spv::OpLoad) {
        const Pointer source = pointer_to(operands[0]);
        if (kind(source.type) == spv::OpTypeImage || kind(source.type) == spv::OpTypeSampledImage)
            pointers_[instruction.id] = source;
        else
            give(instruction, load(source), true);
        return;
    }
    if (instruction.op == spv::OpImage) {  // of a sampled image
        pointers_[instruction.id] = pointer_to(operands[0]);
        return;
    }
    if (!instruction.id) program_.fail(instruction, "a function of this line");
    const bool is_atomic = atomics.contains(instruction.op);
    const std::string text = operation(instruction);
    if (is_atomic) flush(true);
    give(instruction, text, is_atomic || instruction.op == spv::OpImageFetch);
    if (is_atomic) flush();
}
// Declares a block's variables, but not those that its own assignments set first.
void Writer::declare_all(const Sequence& sequence) {
    for (const Id variable : sequence.variables) {
        const auto first = std::find_if(sequence.statements.begin(), sequence.statements.end(), [&](const Statement& statement) {
            bool is_used = false;
            for_each_use(statement, [&](Id id) { is_used |= id == variable; });
            return is_used;
        });
        if (first == sequence.statements.end()) continue;
        const bool is_pointer = program_.is_pointer(type_of(variable));
        if (first->instruction.op == spv::OpStore && first->instruction.operands[0] == variable) {
            undeclared_.insert(variable);
            continue;
        }
        names_[variable] = fresh_name(program_.name(variable), variable);
        out(type_name(is_pointer ? program_.pointee(type_of(variable)) : type_of(variable), variable) + " " + names_[variable] +
            "; ");
    }
}
std::string Writer::sequence(const Sequence& sequence) {
    visible_.emplace_back();
    const std::string outer_ends = std::exchange(ends_, "");
    const std::string text = written_by([&] {
        declare_all(sequence);
        for (const Statement& inner : sequence.statements) statement(inner);
        flush();
        out(ends_);
    });
    visible_.pop_back();
    ends_ = outer_ends;
    return "{ " + text + "}";
}
void Writer::statement(const Statement& statement) {
    using Kind = Statement::Kind;
    if (statement.kind == Kind::instruction) return execute(statement.instruction);
    line(statement.instruction);
    const std::string text = statement.value ? value(statement.value) : "";
    flush();
    switch (statement.kind) {
        case Kind::merge:
            return out(names_.at(statement.variable) + " = " + text + "; ");
        case Kind::branch: {
            out("if (" + text + ") " + sequence(statement.parts[0]));
            if (!statement.parts[1].statements.empty()) out(" else " + sequence(statement.parts[1]));
            return out(" ");
        }
        case Kind::loop: {
            labels_.push_back(label_count_++);
            const std::string label = "next__" + std::to_string(labels_.back());
            out("for (;;) { " + stop());
            out(sequence(statement.parts[0]) + " " + label + ":; ");
            out(sequence(statement.parts[1]) + " } ");
            labels_.pop_back();
            return;
        }
        case Kind::cases: {
            out("switch (lab__::uint(" + text + ")) { ");
            for (size_t i = 0; i < statement.parts.size(); ++i) {
                for (const uint32_t literal : statement.literals[i])
                    out("case " + std::to_string(literal) + "u: ");
                out((statement.literals[i].empty() ? "default: " : "") + sequence(statement.parts[i]) + " ");
            }
            return out("} ");
        }
        case Kind::leave_loop:
        case Kind::leave_cases:
            return out("break; ");
        case Kind::next_turn:
            return out("goto next__" + std::to_string(labels_.back()) + "; ");
        default:
            return out("return " + text + "; ");
    }
}
std::string Writer::function(const Function& function) {
    function_ = function.id;
    visible_.emplace_back();
    std::vector<std::string> parameters;
    for (const Instruction& parameter : function.parameters) {
        const bool is_pointer = program_.is_pointer(parameter.type);
        names_[parameter.id] = fresh_name(program_.name(parameter.id), parameter.id);
        parameters.push_back((is_pointer ? "" : "const ") +
                             type_name(is_pointer ? program_.pointee(parameter.type) : parameter.type, parameter.id) +
                             (is_pointer ? "& " : " ") + names_[parameter.id]);
    }
    std::string text = written_by([&] {
        line({.file = function.file, .line = function.line});
        const std::string masked = mask(!parameters.empty());
        out(type_name(function.type, function.id) + " " + names_.at(function.id) + "(" +
            (masked.empty() ? "" : "lab__::Mask " + masked) + joined(parameters) + ") ");
        out(returned(function, sequence(function.body)) + "\n");
    });
    visible_.pop_back();
    return text;
}
// Functions that a function calls, and how often values are used.
void Writer::reach(Id id) {
    if (is_native(program_, id) || std::find(reached_.begin(), reached_.end(), id) != reached_.end()) return;
    reached_.push_back(id);
    names_[id] = fresh_name(program_.name(id), id);
    const auto visit = [&](const auto& self, const Statement& statement) -> void {
        if (statement.value) ++uses_[statement.value];
        for (const Id used : ids_in(statement.instruction)) ++uses_[used];
        if (statement.instruction.op == spv::OpFunctionCall) reach(statement.instruction.operands[0]);
        for (const Sequence& part : statement.parts)
            for (const Statement& inner : part.statements) self(self, inner);
    };
    for (const Statement& statement : program_.functions.at(id).body.statements) visit(visit, statement);
}
std::string Writer::prologue() const {
    return "#include \"native/glsl.h\"\nnamespace lab__ = lab::native;\n";
}
std::string Writer::write() {
    std::string globals, code;
    for (const Id id : program_.globals) globals += global(id);
    reach(program_.main);
    for (const Id id : reached_) code += function(program_.functions.at(id));
    std::string macros;  // of C's headers, whose names shaders may use
    for (const std::string& name : program_.names())
        if (std::none_of(name.begin(), name.end(), [](unsigned char c) { return std::islower(c) || !(std::isalnum(c) || c == '_'); }))
            macros += "#undef " + name + "\n";
    return prologue() + macros + "namespace lab::native {\nstruct Shader : lab__::ShaderBase {\nstatic constexpr lab__::uint local_size__ = " +
           std::to_string(program_.local_size) + ";\n" + globals + code +
           "\n};\n}\nextern \"C\" __attribute__((visibility(\"default\"))) lab::native::Outcome lab_run_group(\n"
           "    const lab::native::Bindings& bindings, uint32_t group, char* error, size_t size) {\n"
           "    return lab__::run_group<lab::native::Shader>(bindings, group, error, size);\n}\n";
}

}  // namespace lab::native
#endif
