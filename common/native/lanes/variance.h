// Which values, variables and loops differ between lanes. The rest is computed once for all of them, in ordinary C++.
//
// A value varies if one of those that it is computed from does; the first ones are the numbers of the invocation. A variable
// varies if a varying value is stored in it, or any value where only some lanes come by:
//
//     bool is_lit = true;                        // the same for all,
//     if (is_occluded(ray, 1.0)) is_lit = false; // but no longer: the ray varies, so some lanes keep `true`
//
// And a loop varies if some lanes leave it where others go on. What a loop's end stores reaches its start in the next turn, so
// the walk over the program repeats until it finds nothing new. In chapter 1, RenderParameters and whatever only depends on them
// stay single numbers.
#pragma once
#include "native/program.h"

namespace lab::native {

class Variance {
  public:
    explicit Variance(const Program& program);

    bool varies(Id id) const { return ids_.contains(id); }
    // Whether lanes leave it one by one.
    bool varies(const Statement& loop) const { return loops_.contains(&loop); }
    // Whether a variable may change for some of the lanes alone that have it, where a function is at a depth of branches that
    // only some take, after so many returns of that kind.
    bool is_of_some_lanes(Id variable, const Function& function, const Program& program, int depth, int returns) const {
        return depth > depth_of(variable, function.id, program) || (returns > 0 && function.has_parameter(variable));
    }

  private:
    class Walk;
    std::set<Id> ids_;
    std::set<const Statement*> loops_;
    std::map<Id, int> depths_;

    // How many branches that only some lanes take are around a variable's declaration; `-1` for a global one.
    int depth_of(Id variable, Id function, const Program& program) const {
        if (program.is_global(variable)) return function == program.main ? 0 : -1;
        const auto found = depths_.find(variable);
        return found == depths_.end() ? 0 : found->second;
    }
};

// Variables in buffers and textures, which all invocations share.
inline bool is_shared(const Program& program, Id root) {
    if (!program.is_global(root)) return false;
    const spv::StorageClass storage = program.storage(root);
    return storage != spv::StorageClassPrivate && storage != spv::StorageClassInput;
}
// Functions that ShaderBase has, see shaders/engine/trace_ray/embree.glsl.
inline bool is_native(const Program& program, Id function) {
    const std::string name = program.name(function);
    return name.starts_with("native_closest_hit(") || name.starts_with("native_any_hit(");
}
// Adds what an instruction points to, if it is an access chain.
inline void note_pointer(std::map<Id, Pointer>& pointers, const Program& program, const Instruction& chain) {
    if (chain.op != spv::OpAccessChain) return;
    const auto base = pointers.find(chain.operands[0]);
    Pointer pointer = base != pointers.end() ? base->second : program.pointer_to(chain.operands[0]);
    for (size_t i = 1; i < chain.operands.size(); ++i) {
        pointer.indices.push_back(chain.operands[i]);
        pointer.types.push_back(program.element_type(pointer.types.back(), chain.operands[i]));
    }
    pointers[chain.id] = std::move(pointer);
}

}  // namespace lab::native
