// Shaders as machine code for the CPU: translated to C++, compiled by the system's compiler, and loaded.
#pragma once
#include <string>
#include <vector>

#include "native/bindings.h"

namespace lab::native {

// What this computer lacks for that, as --list-devices says it. With LAB_WITHOUT_NATIVE in the environment it
// reports missing permission, so that strangers' shaders never run as native code.
std::vector<std::string> missing_tools();

enum class Mode {
    fast,
    debug,    // for a debugger
    checked,  // stops at indices outside of their arrays, and reports other undefined behaviour
};

// How all shaders are compiled that are loaded from now on; `fast` without a call.
void set_mode(Mode mode);
Mode get_mode();

// A compute shader as code, which stays loaded.
struct Code {
    RunGroup run;
    int invocations_at_once;
    // Empty where several invocations run at once. They do on CPUs with AVX2, unless LAB_LANES=0 is in the environment or the
    // compiler refuses what lanes are made of. With LAB_LANES=8 there, CPUs with AVX-512 take eight of sixteen lanes.
    std::string why_one_by_one;
};
// It comes from the cache if possible. Throws UserError if the compiler refuses what translate() makes of it.
Code load(const std::vector<uint32_t>& spirv);

// Rays by Embree, compiled and cached in the same way. Null where Embree or its headers are missing.
MakeRayTracer load_embree();
// What traces rays, as --list-devices says it: Embree with its version, or our own tree.
std::string ray_tracer_name();

// Runs workgroups on all processors. Interrupts of the program stop them. Throws DeviceFailure for what a checked shader finds,
// and if the code crashes.
void run_groups(RunGroup run, Bindings bindings, uint32_t count);

}  // namespace lab::native
