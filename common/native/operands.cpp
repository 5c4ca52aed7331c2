// What a program says and the translation does not use changes what the program does: it is refused, not ignored.
#include "native/bindings.h"
#include "native/writer.h"

namespace lab::native {

void Program::check(const Instruction& instruction) const {
    const auto& operands = instruction.operands;
    const auto refuse_unless = [&](bool is_known, const char* what) {
        if (!is_known) fail(instruction, what);
    };
    const auto is_zero = [&](size_t operand) { return is_constant(operands.at(operand)) && number(operands[operand]) == 0; };
    const bool is_store = instruction.op == spv::OpStore;
    if (is_store || instruction.op == spv::OpLoad)
        refuse_unless(operands.size() == (is_store ? 2 : 1) || operands.back() == 0, "this way to use memory");
    if (is_atomic(instruction.op)) refuse_unless(is_zero(2), "an order of memory operations");
    if (instruction.op == spv::OpExtInst)
        refuse_unless(name(operands[0]) == "GLSL.std.450", ("a function of " + name(operands[0])).c_str());
    if (instruction.op == spv::OpImageQuerySizeLod) refuse_unless(is_zero(1), "another level of an image than 0");
    if (instruction.op != spv::OpImageFetch) return;
    const uint32_t used = spv::ImageOperandsLodMask | spv::ImageOperandsConstOffsetMask | spv::ImageOperandsOffsetMask;
    refuse_unless(operands.size() > 3 && (operands[2] & spv::ImageOperandsLodMask) && !(operands[2] & ~used),
                  "this way to read an image");
    refuse_unless(is_zero(3), "another level of an image than 0");
}

void Program::check_declarations() const {
    // Those that say what is so in any case are known, too.
    static const std::set<spv::Decoration> known{
        spv::DecorationArrayStride,   spv::DecorationBinding,       spv::DecorationBlock,
        spv::DecorationBufferBlock,   spv::DecorationBuiltIn,       spv::DecorationCoherent,
        spv::DecorationColMajor,      spv::DecorationDescriptorSet, spv::DecorationMatrixStride,
        spv::DecorationNoContraction, spv::DecorationNonReadable,   spv::DecorationNonUniform,
        spv::DecorationNonWritable,   spv::DecorationOffset,        spv::DecorationRelaxedPrecision,
        spv::DecorationRowMajor,      spv::DecorationRestrict,      spv::DecorationAliased,
        spv::DecorationSpecId};
    for (const auto& [key, value] : decorations_) {
        const auto [id, member, decoration] = key;
        const auto refuse_unless = [&, id = id](bool is_known, const std::string& what) {
            if (!is_known) fail({.id = id}, what + " of '" + name(id) + "'");
        };
        refuse_unless(known.contains(decoration), "the qualifier " + std::to_string(decoration));
        refuse_unless(decoration != spv::DecorationDescriptorSet || value == 0, "the descriptor set");
        refuse_unless(decoration != spv::DecorationBinding || value < static_cast<int64_t>(std::size(Bindings{}.ranges)),
                      "the binding");
    }
    for (const Id id : globals) {
        const auto& operands = definition(id).operands;
        if (kind(id) != spv::OpTypeImage) continue;
        const bool is_known = kind(operands[0]) == spv::OpTypeFloat && operands[1] == spv::Dim2D && operands[3] == 0 &&
                              operands[4] == 0 && operands[5] == 1;
        if (!is_known) fail(definition(id), "images of another kind than texture2D");
    }
    if (has_unknown_mode_) fail({}, "this layout of a shader");
}

}  // namespace lab::native
