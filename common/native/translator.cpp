#ifndef _WIN32
#include "native/translator.h"

#include "native/lane_writer.h"

namespace lab::native {

std::string translate(const std::vector<uint32_t>& spirv) {
    const Program program(spirv);
    return Writer(program).write();
}
std::string translate_for_lanes(const std::vector<uint32_t>& spirv) {
    const Program program(spirv);
    return LaneWriter(program).write();
}

}  // namespace lab::native
#endif
