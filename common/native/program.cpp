#ifndef _WIN32
#include "native/program.h"

#include <cstring>

namespace lab::native {

Program::Program(const std::vector<uint32_t>& words) {
    Function* function = nullptr;
    Blocks blocks;
    Id block = 0;
    for (size_t at = 5; at < words.size();) {
        const size_t size = words[at] >> spv::WordCountShift;
        Instruction instruction{.op = static_cast<spv::Op>(words[at] & spv::OpCodeMask), .file = file_, .line = line_};
        size_t next = at + 1;
        bool has_id = false, has_type = false;
        spv::HasResultAndType(instruction.op, &has_id, &has_type);
        if (has_type) instruction.type = words[next++];
        if (has_id) instruction.id = words[next++];
        for (at += size; next < at; ++next) instruction.operands.push_back(words[next]);
        if (instruction.id) types_[instruction.id] = instruction.type;
        read(instruction, function, blocks, block);
    }
}

void Program::read(Instruction& instruction, Function*& function, Blocks& blocks, Id& block) {
    const auto& operands = instruction.operands;
    const std::span rest(operands);
    switch (instruction.op) {
        case spv::OpString:
            names_[instruction.id] = text_of(rest);
            break;
        case spv::OpName:
            names_[operands[0]] = text_of(rest.subspan(1));
            break;
        case spv::OpMemberName:
            member_names_[{operands[0], operands[1]}] = text_of(rest.subspan(2));
            break;
        case spv::OpDecorate:
            decorations_[{operands[0], -1, static_cast<spv::Decoration>(operands[1])}] = operands.size() > 2 ? operands[2] : 0;
            break;
        case spv::OpMemberDecorate:
            decorations_[{operands[0], operands[1], static_cast<spv::Decoration>(operands[2])}] =
                operands.size() > 3 ? operands[3] : 0;
            break;
        case spv::OpLine:
            file_ = operands[0];
            line_ = operands[1];
            break;
        case spv::OpNoLine:
            break;
        case spv::OpExtInstImport:
            extended_instructions = instruction.id;
            break;
        case spv::OpEntryPoint:
            main = operands[1];
            break;
        case spv::OpExecutionMode:
            if (operands[1] != spv::ExecutionModeLocalSize) break;
            if (operands[3] != 1 || operands[4] != 1) fail(instruction, "workgroups of more than one dimension");
            local_size = operands[2];
            break;
        case spv::OpFunction:
            function = &functions[instruction.id];
            *function = {.id = instruction.id, .type = instruction.type, .line = instruction.line, .file = instruction.file};
            break;
        case spv::OpFunctionParameter:
            function->parameters.push_back(instruction);
            break;
        case spv::OpLabel:
            block = instruction.id;
            if (blocks.empty()) blocks[0] = {{.op = spv::OpBranch, .operands = {block}}};
            blocks[block];
            break;
        case spv::OpFunctionEnd:
            function->body = sequence(blocks, blocks.at(0).front().operands[0], 0, {}, 0);
            move_inwards(function->body);
            blocks.clear();
            function = nullptr;
            break;
        default:
            if (function)
                blocks.at(block).push_back(std::move(instruction));
            else if (instruction.id) {
                globals.push_back(instruction.id);
                definitions_[instruction.id] = std::move(instruction);
            }
    }
}

// Blocks from `first`, which `from` jumps to, up to `end`. glslang writes them in the shape of GLSL's statements: a selection
// and a loop name the block that follows them.
Sequence Program::sequence(const Blocks& blocks, Id first, Id end, const Targets& targets, int depth) {
    using Kind = Statement::Kind;
    constexpr int deepest = 256;
    Sequence all;
    for (Id label = first;;) {
        const std::vector<Instruction>& block = blocks.at(label);
        const auto merges = [&](Sequence& sequence, Id source, Id target) {  // on the way from one block to another
            for (const Instruction& phi : blocks.at(target)) {
                if (phi.op != spv::OpPhi) continue;
                for (size_t i = 0; i < phi.operands.size(); i += 2)
                    if (phi.operands[i + 1] == source)
                        sequence.statements.push_back({.kind = Kind::merge,
                                                       .instruction = {.file = phi.file, .line = phi.line},
                                                       .variable = phi.id,
                                                       .value = phi.operands[i]});
            }
        };
        const auto jump = [&](Sequence& sequence, Id target, const Targets& open) {  // whether it is one
            const Kind kind = target == open.leave_loop    ? Kind::leave_loop
                              : target == open.next_turn   ? Kind::next_turn
                              : target == open.leave_cases ? Kind::leave_cases
                                                           : Kind::instruction;
            if (kind == Kind::instruction) return target == open.next_case;
            sequence.statements.push_back({.kind = kind, .instruction = {.file = block.back().file, .line = block.back().line}});
            return true;
        };
        const auto part = [&](Id target, Id stop, const Targets& open) {
            Sequence inner;
            merges(inner, label, target);
            if (target == stop || jump(inner, target, open)) return inner;
            Sequence rest = sequence(blocks, target, stop, open, depth + 1);
            std::move(rest.statements.begin(), rest.statements.end(), std::back_inserter(inner.statements));
            inner.variables = std::move(rest.variables);
            return inner;
        };
        Id merge = 0, next_turn = 0;
        Id target = 0;
        for (const Instruction& instruction : block) {
            if (depth > deepest && instruction.line)
                throw UserError(place(instruction) + ": more than " + std::to_string(deepest) +
                                " levels of blocks are too many for the backend native: use another one, --backend compute");
            const auto& operands = instruction.operands;
            Statement statement{.instruction = {.file = instruction.file, .line = instruction.line}};
            switch (instruction.op) {
                case spv::OpPhi:
                    all.variables.push_back(instruction.id);
                    break;
                case spv::OpVariable:
                    if (operands.size() > 1)
                        tables[instruction.id] = operands[1];
                    else
                        all.variables.push_back(instruction.id);
                    break;
                case spv::OpSelectionMerge:
                    merge = operands[0];
                    break;
                case spv::OpLoopMerge:
                    merge = operands[0];
                    next_turn = operands[1];
                    break;
                case spv::OpBranch:
                    target = operands[0];
                    if (!next_turn) break;
                    {
                        const Targets inside{.leave_loop = merge, .next_turn = next_turn};
                        statement.kind = Kind::loop;
                        statement.parts.push_back(part(target, next_turn, inside));
                        Targets at_end = inside;
                        at_end.next_turn = 0;
                        statement.parts.push_back(sequence(blocks, next_turn, label, at_end, depth + 1));
                        all.statements.push_back(std::move(statement));
                        target = merge;
                        merge = 0;
                    }
                    break;
                case spv::OpBranchConditional: {
                    statement.kind = Kind::branch;
                    statement.value = operands[0];
                    if (merge) {
                        for (const Id to : {operands[1], operands[2]}) statement.parts.push_back(part(to, merge, targets));
                        target = merge;
                    } else {  // a loop's condition: one side jumps
                        Sequence nothing;
                        const bool is_second = operands[2] == end || (operands[1] != end && jump(nothing, operands[1], targets));
                        target = operands[is_second ? 2 : 1];
                        for (const Id to : {operands[1], operands[2]})
                            statement.parts.push_back(to == target ? Sequence{} : part(to, end, targets));
                    }
                    all.statements.push_back(std::move(statement));
                    break;
                }
                case spv::OpSwitch: {
                    statement.kind = Kind::cases;
                    statement.value = operands[0];
                    std::map<Id, std::vector<uint32_t>> cases{{operands[1], {}}};
                    for (size_t i = 2; i < operands.size(); i += 2) cases[operands[i + 1]].push_back(operands[i]);
                    cases.erase(merge);  // nothing to do
                    Targets inside = targets;
                    inside.leave_cases = merge;
                    for (auto i = cases.begin(); i != cases.end(); ++i) {
                        inside.next_case = std::next(i) == cases.end() ? 0 : std::next(i)->first;
                        statement.parts.push_back(part(i->first, 0, inside));
                        statement.literals.push_back(i->first == operands[1] ? std::vector<uint32_t>{} : i->second);
                    }
                    all.statements.push_back(std::move(statement));
                    target = merge;
                    break;
                }
                case spv::OpReturn:
                case spv::OpReturnValue:
                    statement.kind = Kind::give_back;
                    if (!operands.empty()) statement.value = operands[0];
                    all.statements.push_back(std::move(statement));
                    return all;
                case spv::OpUnreachable:
                    return all;
                default:
                    statement.instruction = instruction;
                    all.statements.push_back(std::move(statement));
            }
        }
        if (merge == 0 || target != merge) merges(all, label, target);
        if (target == end || jump(all, target, targets)) return all;
        label = target;
    }
}

// How a variable is used first.
Program::Access Program::first_access(const Sequence& sequence, Id variable) const {
    bool is_set = false;  // in some of the parts
    for (const Statement& statement : sequence.statements) {
        const Instruction& instruction = statement.instruction;
        const auto ids = ids_in(instruction);
        if (statement.value == variable) return Access::read;
        if (std::find(ids.begin(), ids.end(), variable) != ids.end()) {
            const bool is_stored = instruction.op == spv::OpStore && ids[0] == variable;
            const bool is_argument = instruction.op == spv::OpFunctionCall && name(variable) == "param";  // glslang's own
            return is_stored || is_argument ? Access::set : Access::read;
        }
        size_t count = 0;
        for (const Sequence& part : statement.parts) {
            const Access access = first_access(part, variable);
            if (access == Access::read) return access;
            count += access == Access::set ? 1 : 0;
        }
        if (statement.kind == Statement::Kind::branch && count == 2) return Access::set;
        is_set |= count > 0;
    }
    return is_set ? Access::set : Access::none;
}

// Variables are declared in the innermost block that has all their uses, as they mostly are in GLSL: SPIR-V does not say where.
// A block that may be repeated must set them first, since others keep their value for the next time.
void Program::move_inwards(Sequence& sequence) const {
    std::vector<Id> here;
    for (const Id variable : sequence.variables) {
        Sequence* target = nullptr;
        size_t count = 0;
        for (Statement& statement : sequence.statements) {
            size_t uses = 0;
            for_each_use(statement, [&](Id id) { uses += id == variable ? 1 : 0; });
            count += uses > 0 ? 1 : 0;
            for (Sequence& part : statement.parts) {
                size_t inside = 0;
                for (const Statement& inner : part.statements)
                    for_each_use(inner, [&](Id id) { inside += id == variable ? 1 : 0; });
                if (inside == uses && uses > 0) target = &part;
            }
        }
        const bool may_move = count == 1 && target && is_pointer(type_of(variable));  // the others are those of merges
        if (may_move && first_access(*target, variable) == Access::set)
            target->variables.push_back(variable);
        else
            here.push_back(variable);
    }
    sequence.variables = std::move(here);
    for (Statement& statement : sequence.statements)
        for (Sequence& part : statement.parts) move_inwards(part);
}

}  // namespace lab::native
#endif
