#include "native/program.h"

#include <cstring>

namespace lab::native {
namespace {

// Makes a tree of a function's blocks. glslang writes them in the shape of GLSL's statements: a selection and a loop name the
// block that follows them.
class TreeBuilder {
  public:
    TreeBuilder(Program& program, const Program::Blocks& blocks) : program_(program), blocks_(blocks) {}

    struct Targets {  // of jumps
        Id leave_loop = 0, next_turn = 0, leave_cases = 0, next_case = 0;
    };
    // Blocks from `first` up to `end`, which the caller goes on with.
    Sequence sequence(Id first, Id end, const Targets& targets) {
        Sequence all;
        ++depth_;
        for (Id label = first; label != 0;) {
            Id merge = 0, next_turn = 0, target = 0;  // what follows
            for (const Instruction& instruction : blocks_.at(label)) {
                check_depth(instruction);
                const auto& operands = instruction.operands;
                switch (instruction.op) {
                    case spv::OpPhi:
                        all.variables.push_back(instruction.id);
                        break;
                    case spv::OpVariable:
                        if (operands.size() > 1 && program_.definition(operands[1]).op == spv::OpConstantComposite) {
                            program_.tables[instruction.id] = operands[1];
                            break;
                        }
                        all.variables.push_back(instruction.id);
                        if (operands.size() > 1)
                            all.statements.push_back(
                                {.instruction = {.op = spv::OpStore, .operands = {instruction.id, operands[1]}}});
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
                        all.statements.push_back(loop(instruction, label, merge, next_turn));
                        target = std::exchange(merge, 0);
                        break;
                    case spv::OpBranchConditional:
                        all.statements.push_back(branch(instruction, label, merge, end, targets, target));
                        break;
                    case spv::OpSwitch:
                        all.statements.push_back(cases(instruction, label, merge, targets));
                        target = merge;
                        break;
                    case spv::OpReturn:
                    case spv::OpReturnValue:
                        all.statements.push_back(statement(Kind::give_back, instruction, operands.empty() ? 0 : operands[0]));
                        break;
                    case spv::OpUnreachable:
                        break;
                    default:
                        all.statements.push_back({.instruction = instruction});
                }
            }
            if (target != 0 && (merge == 0 || target != merge)) set_merged(all, label, target);
            const bool ends = target == 0 || target == end || jump(all, blocks_.at(label).back(), target, targets);
            label = ends ? 0 : target;
        }
        --depth_;
        return all;
    }

  private:
    using Kind = Statement::Kind;

    static Statement statement(Kind kind, const Instruction& at, Id value = 0) {
        return {.kind = kind, .instruction = {.file = at.file, .line = at.line}, .value = value};
    }
    void check_depth(const Instruction& at) const {
        constexpr int deepest = 256;
        if (depth_ > deepest && at.line)
            throw UserError(program_.place(at) + ": more than " + std::to_string(deepest) +
                            " levels of blocks are too many for the backend native: use another one, --backend compute");
    }
    // What an OpPhi gets on the way from one block to another.
    void set_merged(Sequence& sequence, Id source, Id target) const {
        for (const Instruction& phi : blocks_.at(target)) {
            if (phi.op != spv::OpPhi) continue;
            for (size_t i = 0; i < phi.operands.size(); i += 2) {
                if (phi.operands[i + 1] != source) continue;
                sequence.statements.push_back(statement(Kind::merge, phi, phi.operands[i]));
                sequence.statements.back().variable = phi.id;
            }
        }
    }
    // Adds a jump if `target` is where one leads. True if the sequence ends there.
    static bool jump(Sequence& sequence, const Instruction& at, Id target, const Targets& targets) {
        const Kind kind = target == targets.leave_loop    ? Kind::leave_loop
                          : target == targets.next_turn   ? Kind::next_turn
                          : target == targets.leave_cases ? Kind::leave_cases
                                                          : Kind::instruction;
        if (kind == Kind::instruction) return target == targets.next_case;
        sequence.statements.push_back(statement(kind, at));
        return true;
    }
    // What begins at `target`, which the block `source` goes to.
    Sequence part(const Instruction& at, Id source, Id target, Id end, const Targets& targets) {
        Sequence all;
        set_merged(all, source, target);
        if (target == end || jump(all, at, target, targets)) return all;
        Sequence rest = sequence(target, end, targets);
        std::move(rest.statements.begin(), rest.statements.end(), std::back_inserter(all.statements));
        all.variables = std::move(rest.variables);
        return all;
    }
    Statement loop(const Instruction& at, Id label, Id merge, Id next_turn) {
        Statement all = statement(Kind::loop, at);
        all.parts.push_back(part(at, label, at.operands[0], next_turn, {.leave_loop = merge, .next_turn = next_turn}));
        all.parts.push_back(sequence(next_turn, label, {.leave_loop = merge}));
        return all;
    }
    Statement branch(const Instruction& at, Id label, Id merge, Id end, const Targets& targets, Id& target) {
        Statement all = statement(Kind::branch, at, at.operands[0]);
        const Id first = at.operands[1], second = at.operands[2];
        Sequence nothing;
        if (merge)
            target = merge;
        else  // a loop's condition: one side jumps
            target = second == end || (first != end && jump(nothing, at, first, targets)) ? second : first;
        for (const Id to : {first, second})
            all.parts.push_back(!merge && to == target ? Sequence{} : part(at, label, to, merge ? merge : end, targets));
        return all;
    }
    Statement cases(const Instruction& at, Id label, Id merge, const Targets& targets) {
        Statement all = statement(Kind::cases, at, at.operands[0]);
        const Id otherwise = at.operands[1];
        std::map<Id, std::vector<uint32_t>> literals{{otherwise, {}}};  // by their blocks, in the order of the text
        for (size_t i = 2; i < at.operands.size(); i += 2) literals[at.operands[i + 1]].push_back(at.operands[i]);
        literals.erase(merge);  // nothing to do
        Targets inside = targets;
        inside.leave_cases = merge;
        for (auto i = literals.begin(); i != literals.end(); ++i) {
            inside.next_case = std::next(i) == literals.end() ? 0 : std::next(i)->first;
            all.parts.push_back(part(at, label, i->first, 0, inside));
            all.literals.push_back(i->first == otherwise ? std::vector<uint32_t>{} : i->second);
        }
        return all;
    }

    Program& program_;
    const Program::Blocks& blocks_;
    int depth_ = 0;
};

}  // namespace

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
    if (local_size == 0) fail({}, "workgroups of more than one dimension");
    check_declarations();
}

std::string Program::first_use(Id declared) const {
    if (const auto found = first_uses_.find(declared); found != first_uses_.end()) return place(found->second);
    for (const Id id : globals) {  // what has it as its type or as a part of it
        const Instruction& user = definition(id);
        const size_t begin = user.op == spv::OpTypePointer ? 1 : 0, end = user.op == spv::OpTypeStruct ? SIZE_MAX : begin + 1;
        const bool is_type = user.op >= spv::OpTypeVector && user.op <= spv::OpTypePointer;
        bool is_used = user.type == declared;
        for (size_t i = begin; is_type && i < std::min(end, user.operands.size()); ++i) is_used |= user.operands[i] == declared;
        if (!is_used) continue;
        if (std::string text = first_use(id); !text.empty()) return text;
    }
    return "";
}
std::string Program::place(const Instruction& at) const {
    if (at.line) return name(at.file) + ":" + std::to_string(at.line);
    const std::string text = first_use(at.id);
    const Function& function = functions.at(main);
    return text.empty() ? place({.file = function.file, .line = std::max(function.line, 1u)}) : text;
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
            names_[instruction.id] = text_of(rest);
            break;
        case spv::OpEntryPoint:
            main = operands[1];
            break;
        case spv::OpExecutionModeId:
            has_unknown_mode_ = true;
            break;
        case spv::OpExecutionMode:
            has_unknown_mode_ |= operands[1] != spv::ExecutionModeLocalSize;
            if (has_unknown_mode_) break;
            local_size = operands[3] == 1 && operands[4] == 1 ? operands[2] : 0;
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
            function->body = TreeBuilder(*this, blocks).sequence(blocks.at(0).front().operands[0], 0, {});
            move_inwards(function->body);
            blocks.clear();
            function = nullptr;
            break;
        default:
            if (function) {
                check(instruction);
                if (instruction.op == spv::OpFunctionCall) arguments_.insert(operands.begin() + 1, operands.end());
                for (const Id used : ids_in(instruction))
                    first_uses_.try_emplace(used, Instruction{.file = file_, .line = line_});
                first_uses_.try_emplace(instruction.type, Instruction{.file = file_, .line = line_});
                blocks.at(block).push_back(std::move(instruction));
            } else if (instruction.id) {
                globals.push_back(instruction.id);
                definitions_[instruction.id] = std::move(instruction);
            }
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
            const bool is_passed = instruction.op == spv::OpFunctionCall && is_argument(variable);
            return is_stored || is_passed ? Access::set : Access::read;
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
