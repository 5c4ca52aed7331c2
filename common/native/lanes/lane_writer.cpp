#include "native/lanes/lane_writer.h"

namespace lab::native {

std::string LaneWriter::prologue() const {
    return "#include \"native/lanes/builtins.h\"\nnamespace lab__ = lab::native::lanes;\n";
}
std::string LaneWriter::type_name(Id type, Id of) const {
    const bool is_structure = kind(type) == spv::OpTypeStruct;
    const std::string plain = plain_type(type);
    if (variance_.varies(of)) return is_structure ? plain + "_of<lab__::V>" : "lab__::V<" + plain + ">";
    return plain;
}
// A template: its numbers are the same in all lanes, or differ.
std::string LaneWriter::structure(Id type) const {
    const auto& members = program_.definition(type).operands;
    const std::string name = program_.name(type) + "__" + std::to_string(type);
    std::string declared, names, visits;
    for (uint32_t i = 0; i < members.size(); ++i) {
        declared += " W__<" + plain_type(members[i]) + "> " + field(type, i) + ";";
        names += (i > 0 ? ", " : "") + field(type, i);
        visits += " f__(x__." + field(type, i) + "...);";
    }
    return "template <template <typename> class W__> struct " + name + "_of {" + declared + " using VaryingStruct__ = " + name +
           "_of<lab__::V>; template <template <typename> class X__> operator " + name + "_of<X__>() const { return {" + names +
           "}; } template <typename F__, typename... T__> static void fields__(const F__& f__, T__&&... x__) {" + visits +
           " } }; using " + name + " = " + name + "_of<lab__::Uniform>;\n";
}

// Variables and memory.
size_t LaneWriter::first_varying(const Pointer& pointer) const {
    const auto found = std::find_if(pointer.indices.begin(), pointer.indices.end(), [&](Id id) { return variance_.varies(id); });
    return static_cast<size_t>(found - pointer.indices.begin());
}
// Whether each lane has to read or write what is at an address of its own.
bool LaneWriter::is_memory(const Pointer& pointer) const {
    return !variance_.varies(pointer.root) && !has_kind(pointer.types.back(), spv::OpTypeBool) &&
           first_varying(pointer) < pointer.indices.size();
}
std::string LaneWriter::reference(const Pointer& pointer) {
    if (!is_memory(pointer)) return "lab__::ref_to(" + place(pointer) + ", 0)";
    const size_t first = first_varying(pointer);
    std::string text = place(pointer, first);
    for (size_t i = first; i < pointer.indices.size(); ++i)
        text = kind(pointer.types[i]) == spv::OpTypeStruct
                   ? "lab__::field(" + text + ", [](auto& x__) -> auto& { return " + step("x__", pointer, i) + "; })"
                   : "lab__::at(" + text + ", " + value(pointer.indices[i]) + ")";
    return text;
}
std::string LaneWriter::load(const Pointer& pointer) {
    const size_t first = first_varying(pointer);
    if (first == pointer.indices.size()) return place(pointer);
    if (is_memory(pointer)) return "lab__::load(active__, " + reference(pointer) + ")";
    std::string text = "lab__::varying(" + place(pointer, first) + ")";
    for (size_t i = first; i < pointer.indices.size(); ++i)
        text = variance_.varies(pointer.indices[i]) ? "lab__::pick(" + text + ", " + value(pointer.indices[i]) + ")"
                                                    : step(text, pointer, i);
    return text;
}
// Assigns to an element that is another one in each lane.
std::string LaneWriter::change(const std::string& container, const Pointer& pointer, size_t next, const std::string& text) {
    if (next == pointer.indices.size()) return "lab__::assign(active__, " + container + ", " + text + ");";
    if (!variance_.varies(pointer.indices[next])) return change(step(container, pointer, next), pointer, next + 1, text);
    return "lab__::put(active__, " + container + ", " + value(pointer.indices[next]) +
           ", [&](auto& x__, lab__::Mask active__) { " + change("x__", pointer, next + 1, text) + " });";
}
void LaneWriter::assign(const std::string& target, Id variable, const std::string& text) {
    const bool is_of_some = variance_.varies(variable) &&
                            variance_.is_of_some_lanes(variable, program_.functions.at(function_), program_, depth_, returns_);
    flush(true);
    out(is_of_some ? "lab__::assign(active__, " + target + ", " + text + "); " : target + " = " + text + "; ");
}
void LaneWriter::store(const Pointer& pointer, const std::string& text) {
    if (is_shared(program_, pointer.root)) {
        const std::string target = reference(pointer);
        flush(true);
        return out("lab__::store(active__, " + target + ", " + text + "); ");
    }
    if (first_varying(pointer) == pointer.indices.size()) return assign(place(pointer), pointer.root, text);
    const std::string code = change(place(pointer, 0), pointer, 0, text);
    flush(true);
    out(code + " ");
}
std::string LaneWriter::atomic(const std::string& name, Id pointer, const std::string& operands) {
    return "lab__::Builtins::" + name + "(active__, " + reference(pointer_to(pointer)) + ", " + operands + ")";
}
std::string LaneWriter::fetch(const Instruction& instruction) {
    const Pointer texture = pointer_to(instruction.operands[0]);
    const std::string text = is_memory(texture) ? reference(texture) : place(texture);
    return "lab__::Builtins::texelFetch(active__, " + text + ", " + texel(instruction) + ")";
}
std::string LaneWriter::operation(const Instruction& instruction) {
    if (instruction.op == spv::OpVectorExtractDynamic && variance_.varies(instruction.operands[1])) {
        const std::string vector = value(instruction.operands[0]);
        return "lab__::pick(lab__::varying(" + vector + "), " + value(instruction.operands[1]) + ")";
    }
    return Writer::operation(instruction);
}

// Statements.
std::string LaneWriter::part(const Sequence& part, int depth) {
    depth_ += depth;
    std::string text = sequence(part);
    depth_ -= depth;
    return text;
}
std::string LaneWriter::function(const Function& function) {
    depth_ = returns_ = jumps_ = 0;
    return Writer::function(function);
}
std::string LaneWriter::returned(const Function& function, const std::string& body) {
    if (kind(function.type) == spv::OpTypeVoid) return body;
    return "{ " + type_name(function.type, function.id) + " result__; " + body + " return result__; }";
}
void LaneWriter::branch(const Statement& statement) {
    const auto& [first, second] = std::tie(statement.parts[0], statement.parts[1]);
    const auto leaves = [](const Sequence& sequence) {
        return sequence.statements.size() == 1 && sequence.statements[0].kind == Statement::Kind::leave_loop;
    };
    const bool is_exit = !open_.empty() && open_.back().is_varying && open_.back().depth == depth_ &&
                         ((leaves(first) && second.statements.empty()) || (leaves(second) && first.statements.empty()));
    if (!is_exit && !variance_.varies(statement.value)) return Writer::statement(statement);
    const std::string condition = value(statement.value);
    flush();
    if (is_exit) {
        out("if (loop__.goes_on(" + std::string(leaves(first) ? "!" : "") + "lab__::Mask(" + condition + "))) { ");
        ends_ += "} ";
        ++jumps_;  // for the blocks around, if there are some
        return;
    }
    out("{ lab__::Branch branch__(active__, " + condition + "); ");
    if (!first.statements.empty()) out("if (branch__.begins()) " + part(first, 1));
    if (!second.statements.empty()) out(" if (branch__.turns()) " + part(second, 1));
    out(" branch__.ends(); } ");
}
// A loop that lanes may leave one by one goes on until none is left. One that they leave together stays a loop of C++.
void LaneWriter::loop(const Statement& statement) {
    const int jumps = jumps_;
    const bool is_varying = variance_.varies(statement);
    open_.push_back({is_varying, depth_ + (is_varying ? 1 : 0)});
    flush();
    if (is_varying) {
        out("{ lab__::Loop loop__(active__); while (lab__::any(active__)) { " + stop() + part(statement.parts[0], 1));
        out(" loop__.next(); if (lab__::any(active__)) " + part(statement.parts[1], 1) + " } loop__.ends(); } ");
    } else {
        Writer::statement(statement);
    }
    open_.pop_back();
    jumps_ = jumps;
}
void LaneWriter::cases(const Statement& statement) {
    const auto list = [&](size_t only) {
        std::string all;
        for (size_t i = 0; i < statement.literals.size(); ++i)
            for (const uint32_t literal : statement.literals[i])
                if (i == only || statement.literals[only].empty()) all += std::to_string(literal) + "u, ";
        return "{" + all + "}";
    };
    const std::string selector = value(statement.value);
    flush();
    out("{ const lab__::Lanes<lab__::uint> selector__ = " + selector + "; lab__::Cases cases__(active__); ");
    for (size_t i = 0; i < statement.parts.size(); ++i) {
        out("cases__.enter(" + std::string(statement.literals[i].empty() ? "!" : "") + "lab__::is_one_of(selector__, " + list(i) +
            ")); if (lab__::any(active__)) ");
        out(part(statement.parts[i], 1) + " ");
    }
    out("cases__.ends(); } ");
}
void LaneWriter::give_back(const Statement& statement) {
    const std::string text = statement.value ? value(statement.value) : "";
    flush();
    if (depth_ == 0 && returns_ == 0) return out("return " + text + "; ");
    if (!text.empty()) out("lab__::assign(active__, result__, " + text + "); ");
    if (depth_ == 0) return out(text.empty() ? "return; " : "return result__; ");
    ++returns_;
    out("active__ = false; ");
}
void LaneWriter::statement(const Statement& statement) {
    using Kind = Statement::Kind;
    const int before = returns_ + jumps_;
    if (statement.kind != Kind::instruction) line(statement.instruction);
    switch (statement.kind) {
        case Kind::instruction:
            return Writer::statement(statement);
        case Kind::merge:
            return assign(value(statement.variable), statement.variable, value(statement.value));
        case Kind::branch:
            branch(statement);
            break;
        case Kind::loop:
            loop(statement);
            break;
        case Kind::cases:
            cases(statement);
            break;
        case Kind::leave_loop:
        case Kind::next_turn:
            flush();
            if (!open_.back().is_varying) return Writer::statement(statement);
            ++jumps_;
            out(statement.kind == Kind::leave_loop ? "loop__.leave(); " : "loop__.skip(); ");
            return;
        case Kind::leave_cases:
            flush();
            ++jumps_;
            return out("cases__.leave(); ");
        case Kind::give_back:
            give_back(statement);
    }
    if (returns_ + jumps_ == before) return;
    out("if (lab__::any(active__)) { ");  // some lanes have left
    ends_ += "} ";
}

}  // namespace lab::native
