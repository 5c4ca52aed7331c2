#include "native/translator.h"

#include "native/lanes/lane_writer.h"

namespace lab::native {

std::string translate(const std::vector<uint32_t>& spirv, bool for_lanes) {
    const Program program(spirv);
    return for_lanes ? LaneWriter(program).write() : Writer(program).write();
}

}  // namespace lab::native
