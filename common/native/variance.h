// Which values, variables and loops differ between lanes, invocations that run at once. Without lanes none does.
#pragma once
#include "native/program.h"

namespace lab::native {

// A variable, a parameter or a part of it.
struct Pointer {
    Id root = 0, type = 0;  // of what it points to
    std::vector<Id> indices = {};
};

class Variance {
  public:
    Variance() = default;  // nothing varies
    explicit Variance(const Program& program);

    bool varies(Id id) const { return ids_.contains(id); }
    // Whether lanes leave it one by one.
    bool varies(const Statement& loop) const { return loops_.contains(&loop); }
    // How many branches that only some lanes take are around a variable's declaration; `-1` for a global one.
    int depth_of(Id variable, Id function, const Program& program) const {
        if (program.is_global(variable)) return function == program.main ? 0 : -1;
        const auto found = depths_.find(variable);
        return found == depths_.end() ? 0 : found->second;
    }

  private:
    class Walk;
    std::set<Id> ids_;
    std::set<const Statement*> loops_;
    std::map<Id, int> depths_;
};

// Variables in buffers and textures, which all invocations share.
inline bool is_shared(const Program& program, Id root) {
    if (!program.is_global(root)) return false;
    const spv::StorageClass storage = program.storage(root);
    return storage != spv::StorageClassPrivate && storage != spv::StorageClassInput;
}
inline bool is_native(const Program& program, Id function) { return program.name(function).starts_with("native_"); }
// Adds what an instruction points to, if it is an access chain.
inline void note_pointer(std::map<Id, Pointer>& pointers, const Program& program, const Instruction& chain) {
    if (chain.op != spv::OpAccessChain) return;
    Pointer pointer{.root = chain.operands[0], .type = program.pointee(chain.type)};
    if (const auto base = pointers.find(pointer.root); base != pointers.end()) {
        pointer.root = base->second.root;
        pointer.indices = base->second.indices;
    }
    pointer.indices.insert(pointer.indices.end(), chain.operands.begin() + 1, chain.operands.end());
    pointers[chain.id] = std::move(pointer);
}

}  // namespace lab::native
