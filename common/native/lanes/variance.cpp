#include "native/lanes/variance.h"

#include <spirv/unified1/GLSL.std.450.h>

namespace lab::native {

// Follows a program until it finds nothing new.
class Variance::Walk {
  public:
    Walk(Variance& variance, const Program& program) : variance_(variance), program_(program) {}

    void run() {
        for (const Id id : program_.globals) {
            const bool is_input = program_.definition(id).op == spv::OpVariable && program_.storage(id) == spv::StorageClassInput;
            const int64_t input = program_.decoration(id, spv::DecorationBuiltIn);
            if (is_input && input != spv::BuiltInWorkgroupId && input != spv::BuiltInNumWorkgroups) vary(id);
        }
        do {
            is_settled_ = true;
            for (const auto& [id, function] : program_.functions) {
                function_ = &function;
                returns_ = depth_ = 0;
                sequence(function.body);
            }
        } while (!is_settled_);
    }

  private:
    using Kind = Statement::Kind;

    void vary(Id id) { is_settled_ &= !variance_.ids_.insert(id).second; }
    bool varies(Id id) const { return variance_.varies(id); }
    Id root_of(Id pointer) const {
        const auto found = pointers_.find(pointer);
        return found == pointers_.end() ? pointer : found->second.root;
    }
    bool has_varying_index(Id pointer) const {
        const auto found = pointers_.find(pointer);
        return found != pointers_.end() &&
               std::any_of(found->second.indices.begin(), found->second.indices.end(), [&](Id index) { return varies(index); });
    }

    void sequence(const Sequence& sequence) {
        for (const Id variable : sequence.variables) variance_.depths_[variable] = depth_;
        for (const Statement& statement : sequence.statements) follow(statement);
    }
    void parts(const Statement& statement, int depth) {
        depth_ += depth;
        for (const Sequence& part : statement.parts) sequence(part);
        depth_ -= depth;
    }
    void leave(const std::pair<const Statement*, int>& loop) {
        if (depth_ > loop.second) is_settled_ &= !variance_.loops_.insert(loop.first).second;
    }
    void follow(const Statement& statement) {
        switch (statement.kind) {
            case Kind::instruction:
                return execute(statement.instruction);
            case Kind::merge:
                return change(statement.variable, varies(statement.value));
            case Kind::branch:
                return parts(statement, varies(statement.value) ? 1 : 0);
            case Kind::cases:
                return parts(statement, 1);
            case Kind::loop: {
                const int depth = variance_.varies(statement) ? 1 : 0;
                open_.emplace_back(&statement, depth_ + depth);
                parts(statement, depth);
                open_.pop_back();
                return;
            }
            case Kind::leave_loop:
            case Kind::next_turn:
                return leave(open_.back());
            case Kind::leave_cases:
                return;
            case Kind::give_back:
                if (depth_ > 0 || returns_ > 0 || (statement.value && varies(statement.value))) vary(function_->id);
                if (depth_ == 0) return;
                for (const auto& loop : open_) is_settled_ &= !variance_.loops_.insert(loop.first).second;
                ++returns_;
        }
    }
    // Notes that a variable changes.
    void change(Id pointer, bool is_varying) {
        const Id root = root_of(pointer);
        if (is_shared(program_, root)) return;
        const bool is_of_some = variance_.is_of_some_lanes(root, *function_, program_, depth_, returns_);
        if (is_varying || has_varying_index(pointer) || is_of_some) vary(root);
    }
    void call(const Instruction& instruction) {
        const Id callee = instruction.operands[0];
        const Function& function = program_.functions.at(callee);
        if (is_native(program_, callee)) vary(callee);
        for (size_t i = 0; i < function.parameters.size(); ++i) {
            const Id argument = instruction.operands[i + 1], parameter = function.parameters[i].id;
            if (varies(argument)) vary(parameter);
            const bool is_pointer = program_.is_pointer(function.parameters[i].type);
            if (is_pointer && (varies(parameter) || (is_native(program_, callee) && i > 2))) vary(argument);
        }
        if (varies(callee)) vary(instruction.id);
    }
    void execute(const Instruction& instruction) {
        const auto& operands = instruction.operands;
        if (instruction.op == spv::OpExtInst && operands[1] == GLSLstd450Modf) change(operands[3], varies(operands[2]));
        note_pointer(pointers_, program_, instruction);
        if (instruction.op == spv::OpStore) return change(operands[0], varies(operands[1]));
        if (instruction.op == spv::OpFunctionCall) return call(instruction);
        if (!instruction.id || instruction.op == spv::OpAccessChain) return;
        bool is_varying = instruction.op >= spv::OpAtomicLoad && instruction.op <= spv::OpAtomicXor;
        if (instruction.op == spv::OpLoad)
            is_varying = varies(root_of(operands[0])) || has_varying_index(operands[0]);
        else
            for (const Id id : ids_in(instruction)) is_varying |= varies(id);
        if (is_varying) vary(instruction.id);
    }

    Variance& variance_;
    const Program& program_;
    const Function* function_ = nullptr;
    std::map<Id, Pointer> pointers_;
    std::vector<std::pair<const Statement*, int>> open_;  // loops, and the depth of their bodies
    int depth_ = 0;                                       // of branches around that only some lanes may take
    int returns_ = 0;                                     // that some lanes do and others do not, so far in the function
    bool is_settled_ = true;
};

Variance::Variance(const Program& program) { Walk(*this, program).run(); }

}  // namespace lab::native
