#include "native/writer.h"

#include <spirv/unified1/GLSL.std.450.h>

namespace lab::native {
namespace {

std::string joined(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
    return all;
}

}  // namespace

// Names.
std::string spelled(const std::string& name) {
    // clang-format off
    static const std::set<std::string> words{
        "_Complex", "alignas", "alignof", "alloca", "and", "and_eq", "asm", "assert", "auto", "bitand", "bitor", "catch", "char",
        "char16_t", "char32_t", "char8_t", "class", "co_await", "co_return", "co_yield", "compl", "concept", "const_cast",
        "consteval", "constexpr", "constinit", "decltype", "defined", "delete", "dynamic_cast", "enum", "errno", "explicit", "export",
        "extern", "friend", "goto", "inline", "long", "main", "mutable", "namespace", "new", "noexcept", "not", "not_eq",
        "nullptr", "offsetof", "operator", "or", "or_eq", "private", "protected", "public", "register", "reinterpret_cast",
        "requires", "Shader", "short", "signed", "sizeof", "static", "static_assert", "static_cast", "stderr", "stdin", "stdout",
        "template", "this", "thread_local", "throw", "try", "typedef", "typeid", "typename", "union", "unsigned", "using",
        "va_arg", "va_copy", "va_end", "va_start", "virtual", "volatile", "wchar_t", "xor", "xor_eq"};
    // clang-format on
    if (name.find("__") != std::string::npos) return "own__" + name;  // GLSL's compiler only warns of it
    return words.contains(name) ? name + "__" : name;
}

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
    return found != pointers_.end() ? found->second : program_.pointer_to(id);
}
std::string Writer::step(const std::string& text, const Pointer& pointer, size_t index) {
    const Id type = pointer.types[index], at = pointer.indices[index];
    if (kind(type) == spv::OpTypeStruct) return text + "." + field(type, program_.number(at));
    return text + "[" + checked_index(type, at) + "]";
}
// GLM does not check the indices of vectors and matrices as arrays do, and glslang has checked constants.
std::string Writer::checked_index(Id type, Id at) {
    const bool has_fixed_size = kind(type) == spv::OpTypeVector || kind(type) == spv::OpTypeMatrix;
    if (program_.is_constant(at) || !has_fixed_size) return value(at);
    return "lab__::within<" + std::to_string(program_.definition(type).operands[1]) + ">(" + value(at) + ")";
}
std::string Writer::place(const Pointer& pointer, size_t end) {
    size_t next = 0;
    std::string text;
    if (const auto table = program_.tables.find(pointer.root); table != program_.tables.end())
        text = constant(table->second);
    else if (block_names_.contains({pointer.root, 0}))
        text = block_names_.at({pointer.root, program_.number(pointer.indices.at(next++))});
    else
        text = names_.at(pointer.root);
    for (; next < std::min(end, pointer.indices.size()); ++next) text = step(text, pointer, next);
    return text;
}

// Values.
std::string Writer::value(Id id) {
    if (program_.is_constant(id)) return constant(id);
    if (const auto found = pending_.find(id); found != pending_.end()) {
        reads_ |= found->second.reads;
        parentheses_ = std::max(parentheses_, found->second.depth);
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
void Writer::give(const Instruction& instruction, const std::string& text, bool reads, Id root) {
    constexpr int deepest = 30;  // parentheses, which compilers do not like deep
    names_[instruction.id] = "value__" + std::to_string(instruction.id);
    const bool is_short = uses_[instruction.id] == 1 && parentheses_ < deepest;
    pending_[instruction.id] = {text, reads || reads_, parentheses_ + 1, root};
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
void Writer::store(const Pointer& pointer, const std::string& text) {
    const std::string target = place(pointer);
    flush(true);
    out(target + " = " + text + "; ");
}
std::string Writer::atomic(const std::string& name, Id pointer, const std::string& operands) {
    return "lab__::Builtins::" + name + "(" + place(pointer_to(pointer)) + ", " + operands + ")";
}
// Where an image is read: the position, and from texelFetchOffset() what is added to it.
std::string Writer::texel(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    const std::string position = value(operands[1]);
    return operands.size() < 5 ? position : "(" + position + " + " + value(operands[4]) + ")";
}
std::string Writer::fetch(const Instruction& instruction) {
    return "lab__::Builtins::texelFetch(" + place(pointer_to(instruction.operands[0])) + ", " + texel(instruction) + ")";
}
// Statements.
void Writer::execute(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    reads_ = false;
    parentheses_ = 0;
    if (instruction.op == spv::OpAccessChain) {
        note_pointer(pointers_, program_, instruction);
        if (uses_[instruction.id] > 1) flush();  // its indices are read once
        return;
    }
    line(instruction);
    if (instruction.op == spv::OpStore) {
        const Pointer target = pointer_to(operands[0]);
        const auto pending = pending_.find(operands[1]);
        const Id root = pending == pending_.end() ? 0 : pending->second.root;
        const std::string text = value(operands[1]);
        if (root && passed_only_.contains(target.root) &&
            type_name(target.types[0], root) == type_name(target.types[0], target.root)) {
            names_[target.root] = text;
            return;
        }
        if (undeclared_.erase(operands[0]) == 0) return store(target, text);
        flush(true);
        names_[target.root] = fresh_name(program_.name(target.root), target.root);
        return out(type_name(target.types[0], target.root) + " " + names_[target.root] + " = " + text + "; ");
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
        const bool is_fixed =
            !program_.is_global(source.root) && !program_.tables.contains(source.root) &&
            std::all_of(source.indices.begin(), source.indices.end(), [&](Id index) { return program_.is_constant(index); });
        if (kind(source.types.back()) == spv::OpTypeImage)
            pointers_[instruction.id] = source;
        else
            give(instruction, load(source), true, is_fixed ? source.root : 0);
        return;
    }
    if (!instruction.id) program_.fail(instruction, "a function of this line");
    if (instruction.op == spv::OpExtInst && operands[1] == GLSLstd450Modf) {  // its other result goes into a variable
        const std::string name = "modf__" + std::to_string(instruction.id);
        out("const auto " + name + " = " + value(operands[2]) + "; ");
        store(pointer_to(operands[3]), "lab__::Builtins::trunc(" + name + ")");
        return give(instruction, "lab__::Builtins::rest(" + name + ")", false);
    }
    const bool changes_memory = is_atomic(instruction.op);
    const std::string text = operation(instruction);
    if (changes_memory) flush(true);
    give(instruction, text, changes_memory || instruction.op == spv::OpImageFetch);
    if (changes_memory) flush();
}
// Whether glslang has made a variable for an argument that the function only reads: it need not be a copy of what it gets.
bool Writer::is_passed_only(Id variable, const Sequence& sequence) const {
    bool is_set = false, is_passed = false;
    for (const Statement& statement : sequence.statements) {
        const Instruction& instruction = statement.instruction;
        size_t uses = 0;
        for_each_use(statement, [&](Id id) { uses += id == variable ? 1 : 0; });
        const bool is_call = instruction.op == spv::OpFunctionCall;
        if (!is_set) {
            is_set = uses > 0;
        } else if (is_passed || (uses > 0 && !is_call)) {
            if (uses > 0) return false;
        } else if (uses > 0) {
            is_passed = true;
            const auto& parameters = program_.functions.at(instruction.operands[0]).parameters;
            for (size_t i = 0; i < parameters.size(); ++i)
                if (instruction.operands[i + 1] == variable && (uses > 1 || written_.contains(parameters[i].id))) return false;
        } else {  // nothing in between may change what it gets
            const bool is_store = instruction.op == spv::OpStore && program_.is_argument(instruction.operands[0]);
            const bool has_effects = !instruction.id || is_call || instruction.op == spv::OpExtInst;
            if (statement.kind != Statement::Kind::instruction || (has_effects && !is_store)) return false;
        }
    }
    return is_passed && program_.is_argument(variable);
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
            if (is_passed_only(variable, sequence)) passed_only_.insert(variable);
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
                for (const uint32_t literal : statement.literals[i]) out("case " + std::to_string(literal) + "u: ");
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
        const Instruction& instruction = statement.instruction;
        for (const Id used : ids_in(instruction)) ++uses_[used];
        note_pointer(pointers_, program_, instruction);
        const bool is_call = instruction.op == spv::OpFunctionCall;
        if (is_call || instruction.op == spv::OpStore || instruction.op == spv::OpExtInst || is_atomic(instruction.op))
            for (const Id used : ids_in(instruction))
                if (used != instruction.operands.back() || instruction.op != spv::OpStore)
                    written_.insert(pointers_.contains(used) ? pointers_.at(used).root : used);
        if (statement.instruction.op == spv::OpFunctionCall) reach(statement.instruction.operands[0]);
        for (const Sequence& part : statement.parts)
            for (const Statement& inner : part.statements) self(self, inner);
    };
    for (const Statement& statement : program_.functions.at(id).body.statements) visit(visit, statement);
}
std::string Writer::prologue() const { return "#include \"native/glsl.h\"\nnamespace lab__ = lab::native;\n"; }
std::string Writer::write() {
    std::string globals, code;
    for (const Id id : program_.globals) globals += global(id);
    reach(program_.main);
    for (const Id id : reached_) code += function(program_.functions.at(id));
    std::string macros;                                 // of C's headers, whose names shaders may use
    for (const std::string& name : program_.names()) {  // and those of files
        const std::string word = name.substr(0, name.find('('));
        const bool is_word = std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
        if (is_word && spelled(word) == word && !std::isdigit(static_cast<unsigned char>(word[0])))
            macros += "#undef " + word + "\n";
    }
    return prologue() + macros +
           "namespace lab::native {\nstruct Shader : lab__::ShaderBase {\nstatic constexpr lab__::uint local_size__ = " +
           std::to_string(program_.local_size) + ";\n" + globals + code +
           "\n};\n}\nextern \"C\" __attribute__((visibility(\"default\"))) const int lab_invocations_at_once = "
           "lab__::invocations_at_once;\n"
           "extern \"C\" __attribute__((visibility(\"default\"))) lab::native::Outcome lab_run_group(\n"
           "    const lab::native::Bindings& bindings, uint32_t group, char* error, size_t size) {\n"
           "    return lab__::run_group<lab::native::Shader>(bindings, group, error, size);\n}\n";
}

}  // namespace lab::native
