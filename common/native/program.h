// A shader as SPIR-V, taken apart: its types, constants and variables by their ids, and its functions as trees of statements.
#pragma once
#define SPV_ENABLE_UTILITY_CODE
#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <spirv/unified1/spirv.hpp>
#include <string>
#include <utility>
#include <vector>

#include "error.h"

namespace lab::native {

using Id = uint32_t;

struct Instruction {
    spv::Op op = spv::OpNop;
    Id type = 0, id = 0;  // of the result, or 0
    std::vector<uint32_t> operands = {};
    Id file = 0;  // where it is in the shader's text
    uint32_t line = 0;
};

// What is executed from top to bottom, with the variables of functions that it declares.
struct Statement;
struct Sequence {
    std::vector<Statement> statements = {};
    std::vector<Id> variables = {};
};
struct Statement {
    enum class Kind {
        instruction,
        merge,       // sets a variable that has the value of an OpPhi
        branch,      // with two parts
        loop,        // with a part and what precedes the next turn
        cases,       // with a part for each case; one without a jump goes on with the next
        leave_loop,  // `break`
        next_turn,   // `continue`
        leave_cases,
        give_back,  // `return`
    };
    Kind kind = Kind::instruction;
    Instruction instruction = {};
    Id variable = 0, value = 0;  // what a merge sets; a condition, a selector or what a function returns
    std::vector<Sequence> parts = {};
    std::vector<std::vector<uint32_t>> literals = {};  // of cases; the default has none
};

struct Function {
    Id id = 0, type = 0;
    uint32_t line = 0;
    Id file = 0;
    std::vector<Instruction> parameters = {};
    Sequence body = {};

    bool has_parameter(Id parameter_id) const {
        return std::any_of(parameters.begin(), parameters.end(),
                           [&](const Instruction& parameter) { return parameter.id == parameter_id; });
    }
};

// A variable, a parameter or a part of it. The types are those before each index, and of what it leads to.
struct Pointer {
    Id root = 0;
    std::vector<Id> indices = {}, types = {};
};

class Program {
  public:
    using Blocks = std::map<Id, std::vector<Instruction>>;  // of a function, by their labels

    // `words` come from glslang, not optimised and with lines.
    explicit Program(const std::vector<uint32_t>& words);

    uint32_t local_size = 1;
    Id main = 0;
    std::map<Id, Function> functions;
    std::map<Id, Id> tables;  // variables of functions that are another name for a constant
    std::vector<Id> globals;  // constants and variables, each after those that it uses

    const Instruction& definition(Id id) const { return definitions_.at(id); }
    bool is_global(Id id) const { return definitions_.contains(id); }
    bool is_constant(Id id) const {
        const auto found = definitions_.find(id);
        return found != definitions_.end() && found->second.op >= spv::OpConstantTrue && found->second.op <= spv::OpConstantNull;
    }
    uint32_t number(Id constant) const {
        const Instruction& found = definition(constant);
        if (found.op != spv::OpConstant && found.op != spv::OpSpecConstant)
            fail(found, "constants that are computed from specialisation constants");
        return found.operands.at(0);
    }
    // The type of a value, a variable or a parameter, and what a pointer points to.
    Id type_of(Id id) const { return types_.at(id); }
    Id pointee(Id pointer_type) const { return definition(pointer_type).operands.at(1); }
    spv::Op kind(Id type) const { return definition(type).op; }
    // Of an array, a vector, a matrix or a structure, of which `index` is a constant.
    Id element_type(Id type, Id index) const {
        return definition(type).operands[kind(type) == spv::OpTypeStruct ? number(index) : 0];
    }
    Pointer pointer_to(Id variable) const { return {.root = variable, .types = {pointee(type_of(variable))}}; }
    bool is_pointer(Id type) const { return definition(type).op == spv::OpTypePointer; }
    spv::StorageClass storage(Id variable) const {
        return static_cast<spv::StorageClass>(definition(type_of(variable)).operands.at(0));
    }
    std::string name(Id id) const {
        const auto found = names_.find(id);
        return found == names_.end() ? "" : found->second;
    }
    std::string member_name(Id structure, uint32_t member) const {
        const auto found = member_names_.find({structure, member});
        return found == member_names_.end() ? "" : found->second;
    }
    // The first operand of a decoration, of a member if there is one; -1 without it.
    int64_t decoration(Id id, spv::Decoration decoration, int64_t member = -1) const {
        const auto found = decorations_.find({id, member, decoration});
        return found == decorations_.end() ? -1 : found->second;
    }
    // Variables that glslang makes for arguments. No others are passed to functions.
    bool is_argument(Id variable) const { return arguments_.contains(variable); }
    bool is_block(Id structure) const { return decoration(structure, spv::DecorationBlock) >= 0; }
    std::set<std::string> names() const {
        std::set<std::string> all;
        for (const auto& [id, name] : names_) all.insert(name);
        for (const auto& [member, name] : member_names_) all.insert(name);
        all.erase("");
        return all;
    }
    // The line of the text. Declarations have none in SPIR-V: theirs is where they are used first.
    std::string place(const Instruction& at) const;
    [[noreturn]] void fail(const Instruction& at, const std::string& what) const {
        throw UserError(place(at) + ": the backend native does not know " + what + ": use another one, --backend compute");
    }

  private:
    void read(Instruction& instruction, Function*& function, Blocks& blocks, Id& block);
    void check(const Instruction& instruction) const;
    void check_declarations() const;
    enum class Access { none, set, read };
    Access first_access(const Sequence& sequence, Id variable) const;
    void move_inwards(Sequence& sequence) const;
    std::string first_use(Id declared) const;
    static std::string text_of(std::span<const uint32_t> words) {
        return {reinterpret_cast<const char*>(words.data()),
                strnlen(reinterpret_cast<const char*>(words.data()), 4 * words.size())};
    }

    std::map<Id, Instruction> definitions_;
    std::map<Id, Id> types_;
    std::map<Id, std::string> names_;
    std::map<std::pair<Id, uint32_t>, std::string> member_names_;
    std::map<std::tuple<Id, int64_t, spv::Decoration>, int64_t> decorations_;
    std::map<Id, Instruction> first_uses_;  // in functions
    std::set<Id> arguments_;
    bool has_unknown_mode_ = false;
    Id file_ = 0;
    uint32_t line_ = 0;
};

// The ids among an instruction's operands, of those that functions have.
inline std::vector<Id> ids_in(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    const auto from = [&](size_t first, size_t end) {
        return std::vector<Id>(operands.begin() + static_cast<std::ptrdiff_t>(std::min(first, operands.size())),
                               operands.begin() + static_cast<std::ptrdiff_t>(std::min(end, operands.size())));
    };
    switch (instruction.op) {
        case spv::OpVariable:
        case spv::OpExtInst:
            return instruction.op == spv::OpVariable ? from(1, 2) : from(2, SIZE_MAX);
        case spv::OpFunctionCall:
            return from(1, SIZE_MAX);
        case spv::OpCompositeExtract:
        case spv::OpArrayLength:
        case spv::OpLoad:
            return from(0, 1);
        case spv::OpCompositeInsert:
        case spv::OpVectorShuffle:
        case spv::OpStore:
        case spv::OpImageFetch:
            return from(0, 2);
        default:
            return operands;
    }
}
// Calls `f` for each id that a statement uses, those of its parts included.
template <typename F>
void for_each_use(const Statement& statement, const F& f) {
    if (statement.variable) f(statement.variable);
    if (statement.value) f(statement.value);
    for (const Id id : ids_in(statement.instruction)) f(id);
    for (const Sequence& part : statement.parts)
        for (const Statement& inner : part.statements) for_each_use(inner, f);
}

}  // namespace lab::native
