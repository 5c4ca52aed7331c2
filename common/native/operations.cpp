// SPIR-V's functions as C++.
#include <spirv/unified1/GLSL.std.450.h>

#include "native/writer.h"

namespace lab::native {
namespace {

// clang-format off
// Instructions of GLSL.std.450 by their number (registry.khronos.org/SPIR-V/specs/unified1/GLSL.std.450.html).
constexpr const char* extended[] = {
    "", "round", "roundEven", "trunc", "abs", "abs", "sign", "sign", "floor", "ceil", "fract", "radians", "degrees", "sin", "cos",
    "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "atan", "pow", "exp", "log", "exp2", "log2",
    "sqrt", "inversesqrt", "determinant", "inverse", "", "", "min", "min", "min", "max", "max", "max", "clamp", "clamp",
    "clamp", "mix", "mix", "step", "smoothstep", "fma", "", "", "ldexp", "packSnorm4x8", "packUnorm4x8", "packSnorm2x16",
    "packUnorm2x16", "packHalf2x16", "", "unpackSnorm2x16", "unpackUnorm2x16", "unpackHalf2x16", "unpackSnorm4x8",
    "unpackUnorm4x8", "", "length", "distance", "cross", "normalize", "faceforward", "reflect", "refract", "findLSB", "findMSB",
    "findMSB"};

// Operators, and functions of Builtins.
const std::map<spv::Op, std::string>& operations() {
    static const std::map<spv::Op, std::string> all{
        {spv::OpIAdd, "+"}, {spv::OpFAdd, "+"}, {spv::OpISub, "-"}, {spv::OpFSub, "-"}, {spv::OpIMul, "*"}, {spv::OpFMul, "*"},
        {spv::OpFDiv, "/"}, {spv::OpVectorTimesScalar, "*"}, {spv::OpBitwiseAnd, "&"}, {spv::OpBitwiseOr, "|"},
        {spv::OpBitwiseXor, "^"}, {spv::OpShiftLeftLogical, "<<"}, {spv::OpShiftRightLogical, ">>"},
        {spv::OpShiftRightArithmetic, ">>"}, {spv::OpLogicalAnd, "both"}, {spv::OpLogicalOr, "either"},
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
// clang-format on
// Functions with two results, by the one that is a structure's first member and the other one.
const std::map<spv::Op, std::pair<const char*, const char*>> pairs{{spv::OpUMulExtended, {" * ", "upper_half"}},
                                                                   {spv::OpSMulExtended, {" * ", "upper_half"}},
                                                                   {spv::OpIAddCarry, {" + ", "carry"}},
                                                                   {spv::OpISubBorrow, {" - ", "borrow"}}};
// The same of GLSL.std.450. Newer compilers write ModfStruct, where older ones pass a variable for the second result.
const std::map<uint32_t, std::pair<const char*, const char*>> extended_pairs{{GLSLstd450ModfStruct, {"rest", "trunc"}},
                                                                             {GLSLstd450FrexpStruct, {"fraction", "exponent"}}};
const std::map<spv::Op, std::string> atomics{{spv::OpAtomicIAdd, "atomicAdd"},
                                             {spv::OpAtomicSMin, "atomicMin"},
                                             {spv::OpAtomicUMin, "atomicMin"},
                                             {spv::OpAtomicSMax, "atomicMax"},
                                             {spv::OpAtomicUMax, "atomicMax"},
                                             {spv::OpAtomicAnd, "atomicAnd"},
                                             {spv::OpAtomicOr, "atomicOr"},
                                             {spv::OpAtomicXor, "atomicXor"},
                                             {spv::OpAtomicExchange, "atomicExchange"},
                                             {spv::OpAtomicCompareExchange, "atomicCompSwap"}};

}  // namespace

bool is_atomic(spv::Op op) { return atomics.contains(op); }

std::string Writer::operation(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    const std::string type = type_name(instruction.type, instruction.id), builtin = "lab__::Builtins::";
    const auto values = [&](size_t first) {
        std::string all;
        for (size_t i = first; i < operands.size(); ++i) all += (i > first ? ", " : "") + value(operands[i]);
        return all;
    };
    const auto part_of = [&](std::string text, Id whole, size_t first) {
        for (size_t i = first; i < operands.size(); ++i) {
            text += kind(whole) == spv::OpTypeStruct ? "." + field(whole, operands[i]) : "[" + std::to_string(operands[i]) + "]";
            whole = program_.definition(whole).operands[kind(whole) == spv::OpTypeStruct ? operands[i] : 0];
        }
        return text;
    };
    if (const auto found = operations().find(instruction.op); found != operations().end()) {
        if (std::isalpha(static_cast<unsigned char>(found->second[0]))) return builtin + found->second + "(" + values(0) + ")";
        const std::string first = value(operands[0]), second = value(operands[1]);
        const bool has_other_sign = type_of(operands[1]) != instruction.type && instruction.op != spv::OpVectorTimesScalar;
        return "(" + first + " " + found->second + " " +
               (has_other_sign ? "lab__::convert<" + plain_type(instruction.type) + ">(" + second + ")" : second) + ")";
    }
    if (const auto found = pairs.find(instruction.op); found != pairs.end()) {
        const std::string a = value(operands[0]), b = value(operands[1]);
        return type + "{(" + a + found->second.first + b + "), " + builtin + found->second.second + "(" + a + ", " + b + ")}";
    }
    switch (instruction.op) {
        case spv::OpExtInst: {
            const uint32_t number = operands[1];
            const std::string parts = "(" + values(2) + ")";
            if (const auto found = extended_pairs.find(number); found != extended_pairs.end())
                return type + "{" + builtin + found->second.first + parts + ", " + builtin + found->second.second + parts + "}";
            const std::string name = number < std::size(extended) ? extended[number] : "";
            if (name.empty()) program_.fail(instruction, "a function of this line");
            return builtin + name + parts;
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
            return vector + "[" + checked_index(type_of(operands[0]), operands[1]) + "]";
        }
        case spv::OpVectorShuffle: {
            std::string indices;
            for (size_t i = 2; i < operands.size(); ++i)
                indices += (i > 2 ? ", " : "") + std::to_string(operands[i] == UINT32_MAX ? 0 : operands[i]);
            const std::string first = value(operands[0]), second = operands[0] == operands[1] ? first : value(operands[1]);
            return "lab__::shuffle<" + indices + ">(" + first + ", " + second + ")";
        }
        case spv::OpArrayLength:
            return "lab__::uint(" + block_names_.at({operands[0], operands[1]}) + ".length())";
        case spv::OpImageFetch:
            return fetch(instruction);
        case spv::OpImageQuerySizeLod:
        case spv::OpImageQuerySize:
            return builtin + "textureSize(" + place(pointer_to(operands[0])) + ")";
        default:
            if (const auto found = atomics.find(instruction.op); found != atomics.end())
                return atomic(found->second, operands[0], values(instruction.op == spv::OpAtomicCompareExchange ? 4 : 3));
            program_.fail(instruction, "a function of this line (SPIR-V's instruction " + std::to_string(instruction.op) + ")");
    }
}

}  // namespace lab::native
