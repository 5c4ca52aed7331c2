// Writes a program for several invocations at once: what differs between them has another type, and a mask, `active__`, says
// which ones execute a statement. Where the mask stays the same for all, so does the C++.
//
// An early exit is the hard part. After
//
//     if (throughput == vec3(0.0)) return radiance;
//
// some lanes have left and others have not. The former keep their result in `result__` and are out of the mask for the rest of
// the function. That rest stands in `if (any(active__)) { ... }`, which ends where the block ends: if all have left, none of it
// runs.
#pragma once
#include "native/writer.h"

namespace lab::native {

class LaneWriter : public Writer {
  public:
    explicit LaneWriter(const Program& program) : Writer(program), variance_(program) {}

  protected:
    std::string prologue() const override;
    std::string structure(Id type) const override;
    std::string type_name(Id type, Id of) const override;
    std::string operation(const Instruction& instruction) override;
    std::string load(const Pointer& pointer) override;
    void store(const Pointer& pointer, const std::string& value) override;
    std::string atomic(const std::string& name, Id pointer, const std::string& operands) override;
    std::string fetch(const Instruction& instruction) override;
    std::string mask(bool has_more) const override { return has_more ? "active__, " : "active__"; }
    std::string returned(const Function& function, const std::string& body) override;
    void statement(const Statement& statement) override;
    std::string function(const Function& function) override;

  private:
    size_t first_varying(const Pointer& pointer) const;
    bool is_memory(const Pointer& pointer) const;
    std::string reference(const Pointer& pointer);
    std::string change(const std::string& container, const Pointer& pointer, size_t next, const std::string& text);
    void assign(const std::string& target, Id variable, const std::string& value);
    void branch(const Statement& statement);
    void loop(const Statement& statement);
    void cases(const Statement& statement);
    void give_back(const Statement& statement);
    std::string part(const Sequence& sequence, int depth);

    const Variance variance_;
    int depth_ = 0;    // of branches around that only some lanes may take
    int returns_ = 0;  // that some lanes do and others do not, so far in the function
    int jumps_ = 0;    // of that kind, so far in the loop or in the cases
    struct Open {      // a loop
        bool is_varying;
        int depth;
    };
    std::vector<Open> open_;
};

}  // namespace lab::native
