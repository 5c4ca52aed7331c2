// Writes a program as C++: a compute shader becomes a struct whose globals are members. Each value has a name of its own or, if
// it is used once and at once, is a part of what uses it, so that the C++ resembles the GLSL. Names with two underscores, which
// GLSL keeps for itself, belong to the translation.
#pragma once
#include "native/lanes/variance.h"

namespace lab::native {

class Writer {
  public:
    explicit Writer(const Program& program) : program_(program) {}
    virtual ~Writer() = default;
    std::string write();

  protected:
    // What lanes do in another way: lane_writer.cpp.
    virtual std::string prologue() const;
    virtual std::string structure(Id type) const;
    virtual std::string type_name(Id type, Id /*of*/) const { return plain_type(type); }
    virtual std::string operation(const Instruction& instruction);
    virtual std::string load(const Pointer& pointer);
    virtual void store(const Pointer& pointer, const std::string& value);
    virtual std::string atomic(const std::string& name, Id pointer, const std::string& operands);
    virtual std::string fetch(const Instruction& instruction);
    virtual std::string mask(bool /*has_more*/) const { return ""; }  // what functions get first
    virtual std::string returned(const Function&, const std::string& body) { return body; }
    virtual void statement(const Statement& statement);
    virtual std::string function(const Function& function);

    std::string sequence(const Sequence& sequence);

    std::string plain_type(Id type) const;
    std::string value(Id id);
    Pointer pointer_to(Id id) const;
    // What a pointer leads to, up to an index.
    std::string place(const Pointer& pointer, size_t end = SIZE_MAX);
    // A pointer's next step, at an index, from what `text` is.
    std::string step(const std::string& text, const Pointer& pointer, size_t index);
    std::string checked_index(Id type, Id at);
    std::string texel(const Instruction& instruction);
    std::string field(Id structure, uint32_t member) const;
    std::string constant(Id id) const;
    Id type_of(Id id) const { return program_.type_of(id); }
    spv::Op kind(Id type) const { return program_.kind(type); }
    bool has_kind(Id type, spv::Op op) const;  // itself or a part of it
    void out(const std::string& text) { text_ += text; }
    void line(const Instruction& at);
    void flush(bool only_reads = false);
    static std::string stop() {  // what loops ask
        return "if (lab__::ShaderBase::bindings.must_stop()) [[unlikely]] throw lab__::Stopped(); ";
    }
    // Calls `write` and returns what it has written.
    template <typename F>
    std::string written_by(const F& write) {
        std::string before = std::exchange(text_, "");
        write();
        return std::exchange(text_, std::move(before));
    }

    const Program& program_;
    Id function_ = 0;
    std::string ends_;  // of what statements have opened up to the end of their block

  private:
    struct Pending {  // a value that is not written yet
        std::string text;
        bool reads;   // variables or memory
        int depth;    // of parentheses
        Id root = 0;  // the function's variable that it is, or is a member of
    };
    void execute(const Instruction& instruction);
    void give(const Instruction& instruction, const std::string& text, bool reads, Id root = 0);
    bool is_passed_only(Id variable, const Sequence& sequence) const;
    std::string call(const Instruction& instruction);
    std::string global(Id id);
    std::string resources(Id variable);
    size_t size_in_memory(Id type) const;
    void declare_all(const Sequence& sequence);
    void reach(Id function);
    std::string fresh_name(const std::string& wish, Id id);
    Id same_structure(Id type) const;

    std::string text_;
    std::vector<Id> order_;  // of those that are pending
    std::map<Id, Pending> pending_;
    std::map<Id, std::string> names_;
    std::map<std::pair<Id, uint32_t>, std::string> block_names_;
    std::map<Id, Pointer> pointers_;
    std::map<Id, size_t> uses_;
    std::set<Id> written_;  // parameters
    std::set<Id> passed_only_;
    std::set<Id> undeclared_;                        // variables that their first assignment declares
    std::vector<std::set<std::string>> visible_{1};  // names in the blocks around
    std::vector<Id> reached_;                        // functions
    std::vector<int> labels_;                        // of the loops around
    std::string file_;
    uint32_t line_ = 0;
    int label_count_ = 0, parentheses_ = 0;
    bool reads_ = false;
};

// As C++ spells a name of GLSL, which may be a word of C++ or a macro of its headers.
std::string spelled(const std::string& name);
bool is_atomic(spv::Op op);

}  // namespace lab::native
