// Which variables differ between lanes, invocations that run at once. It follows from the whole program, so that the translator
// repeats itself until it finds nothing new. Without lanes none does.
#pragma once
#include <map>

#include "native/tokens.h"

namespace lab::native {

struct Expression {
    std::string text = {};
    std::string root = {};          // the variable that it is a part of
    std::string lvalue = {};        // of a swizzle or its component, which `text` reads
    Names reads = {}, writes = {};  // variables; it writes those that it passes as `out` arguments
    bool is_varying = false;        // whether it differs between lanes
    bool is_masked = false;         // whether it has to know which lanes are active
    std::string place = {};         // of memory at an index that varies, which `text` loads
    bool is_picked = false;         // whether lanes cannot assign to it: at such an index of something else

    void add_effects(const Expression& part) {
        reads.insert(part.reads.begin(), part.reads.end());
        writes.insert(part.writes.begin(), part.writes.end());
    }
    void add(const Expression& part) {
        text += part.text;
        add_effects(part);
        is_varying |= part.is_varying;
        is_masked |= part.is_masked;
    }
    std::string assignable() const {
        if (!place.empty()) return place;
        return lvalue.empty() ? text : lvalue;
    }
};

inline bool overlap(const Names& a, const Names& b) {
    return std::any_of(a.begin(), a.end(), [&](const auto& name) { return b.contains(name); });
}
// Whether the order of evaluation matters: C++ leaves it open.
inline bool depend(const Expression& a, const Expression& b) {
    return overlap(a.writes, b.reads) || overlap(b.writes, a.reads) || overlap(a.writes, b.writes);
}

struct Parameter {
    bool is_out;
    size_t token = 0;  // its name's
};
using Parameters = std::vector<Parameter>;

class Variance {
  public:
    explicit Variance(bool has_lanes) : has_lanes_(has_lanes) {}
    bool has_lanes() const { return has_lanes_; }
    bool is_settled() const { return is_settled_; }
    // What the shader uses that lanes lack, after its line; empty if there is nothing.
    const std::string& refusal() const { return refusal_; }
    // For another pass.
    Variance next() const {
        Variance same(has_lanes_);
        same.varying_ = varying_;
        same.written_ = written_;
        same.varying_functions_ = varying_functions_;
        return same;
    }

  protected:
    void refuse(const std::string& place, const std::string& what) {
        if (refusal_.empty()) refusal_ = place + ": lanes lack " + what;
    }

    struct Variable {
        size_t token;  // that declares it
        int depth;     // of branches around it that only some lanes may take; -1 outside of a function
        bool is_memory;
        bool is_type = false;  // a structure, not a variable
    };
    void declare_type(const std::string& name) {
        scopes_.back().insert_or_assign(name, Variable{.token = 0, .depth = -1, .is_memory = false, .is_type = true});
    }
    void declare(const std::string& name, size_t token, int depth, bool is_memory = false) {
        scopes_.back().insert_or_assign(name, Variable{token, depth, is_memory});
    }
    const Variable* find(const std::string& name) const {
        for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
            if (const auto found = scope->find(name); found != scope->end()) return &found->second;
        return nullptr;
    }
    bool varies(const std::string& name) const {
        const Variable* variable = find(name);
        if (variable) return varying_.contains(variable->token);
        return has_lanes_ && name.starts_with("gl_") && name != "gl_WorkGroupID";
    }
    bool varies(size_t token) const { return varying_.contains(token); }
    void vary(size_t token) {
        if (has_lanes_ && token != 0) is_settled_ &= !varying_.insert(token).second;
    }
    bool is_written(size_t token) const { return written_.contains(token); }
    bool is_varying_function(const std::string& signature) const { return varying_functions_.contains(signature); }
    void vary_function(const std::string& signature) { is_settled_ &= !varying_functions_.insert(signature).second; }

    // Notes that a variable changes. Where it varies, lanes may still change it together.
    enum class Change { uniform, of_all_lanes, of_some_lanes, refused };
    Change note_change(const Expression& target, bool is_varying) {
        if (!has_lanes_) return Change::uniform;
        const Variable* variable = find(target.root);
        if (target.is_picked || !variable || (variable->is_memory && target.place.empty())) return Change::refused;
        if (variable->is_memory) return Change::of_some_lanes;
        is_settled_ &= !written_.insert(variable->token).second;
        if (is_varying || !target.place.empty() || depth_ > variable->depth) vary(variable->token);
        if (!varies(variable->token)) return Change::uniform;
        return depth_ > variable->depth ? Change::of_some_lanes : Change::of_all_lanes;
    }
    static bool asks_for_mask(const std::string& function) {
        return function.starts_with("native_") || function.starts_with("atomic") || function == "texelFetch";
    }

    int depth_ = 0;
    std::vector<std::map<std::string, Variable, std::less<>>> scopes_{1};
    Names globals_;

  private:
    bool has_lanes_, is_settled_ = true;
    std::string refusal_;
    std::set<size_t> varying_, written_;  // tokens
    Names varying_functions_;             // name/number of arguments
};

}  // namespace lab::native
