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

typedef float Floats __attribute__((vector_size(4 * lane_count)));
typedef int32_t Integers __attribute__((vector_size(4 * lane_count)));
typedef uint32_t Words __attribute__((vector_size(4 * lane_count)));

// A ray for each lane. The first numbers are those of Embree's RTCRayHit8 or RTCRayHit16.
struct RayPacket {
    Floats origin[3], t_min, direction[3], time;
    Floats t_max;  // then the distance of the hit
    Words mask, id, flags;
    Floats normal[3], barycentrics[2];
    Words primitive, geometry, unused[4];
    Words instance, triangle;
    Integers is_active;  // 0 or -1; then whether it hits something
};

}  // namespace lab::native
