// How many invocations run at once where lanes run a shader, and the rays that they trace together. Only what is compiled for
// this computer's CPU includes it: the lab's programs do not know the width of its vectors.
#pragma once
#include <cstdint>

namespace lab::native {

#ifdef __AVX512DQ__
inline constexpr int lane_count = 16;
#else
inline constexpr int lane_count = 8;
#endif

// A ray for each lane. The first numbers are those of Embree's RTCRayHit8 or RTCRayHit16.
struct alignas(64) RayPacket {
    float origin[3][lane_count], t_min[lane_count], direction[3][lane_count], time[lane_count];
    float t_max[lane_count];  // then the distance of the hit
    uint32_t mask[lane_count], id[lane_count], flags[lane_count];
    float normal[3][lane_count], barycentrics[2][lane_count];
    uint32_t primitive[lane_count], geometry[lane_count], unused[4][lane_count];
    uint32_t instance[lane_count], triangle[lane_count];
    int32_t is_active[lane_count];  // 0 or -1; then whether it hits something
};

}  // namespace lab::native
