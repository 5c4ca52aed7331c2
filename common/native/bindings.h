// What a translated shader gets from the program that runs it. Both are compiled with this header.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lab::native {

// An image. Its texels have four channels, of bytes that stand for [0,1] or of floats.
struct Texture {
    const void* texels;
    int width, height;
    bool is_float;
};

struct RayHit {
    uint32_t instance, triangle;
    float barycentrics[2];
    float distance;
};

// How many invocations run at once where lanes run a shader.
inline constexpr int lane_count = 8;

// A ray for each lane. The first numbers are those of Embree's RTCRayHit8.
struct alignas(64) RayPacket {
    float origin[3][lane_count], t_min[lane_count], direction[3][lane_count], time[lane_count];
    float t_max[lane_count];  // then the distance of the hit
    uint32_t mask[lane_count], id[lane_count], flags[lane_count];
    float normal[3][lane_count], barycentrics[2][lane_count];
    uint32_t primitive[lane_count], geometry[lane_count], unused[4][lane_count];
    uint32_t instance[lane_count], triangle[lane_count];
    int32_t is_active[lane_count];  // 0 or -1; then whether it hits something
    bool is_coherent;               // whether all start at one point
};

// Rays by Embree: embree.h, which is compiled like a shader.
class RayTracer {
  public:
    struct Triangle {  // of the world; the last number of a row is instance, triangle and nothing
        struct {
            float corners[3];
            uint32_t id;
        } x, y, z;
    };
    virtual ~RayTracer() = default;
    // The closest hit nearer than t_max, or with a null `hit` whether there is any.
    virtual bool trace(const float* origin, const float* direction, float t_max, RayHit* hit) const = 0;
    // The same for rays that lanes trace together.
    virtual void find_closest_hits(RayPacket& packet) const = 0;
    virtual void find_any_hits(RayPacket& packet) const = 0;
    virtual size_t bytes() const = 0;
};
using MakeRayTracer = RayTracer* (*)(const RayTracer::Triangle* triangles, size_t count);

struct Bindings {
    // By the shaders' binding number: an array, or the `Texture`s of images.
    struct Range {
        std::byte* data;
        size_t bytes;
    } ranges[64];
    std::byte* push_constants;
    const bool* is_stopped;  // loops of the shader end where this is true; other threads write it

    const RayTracer* rays;  // where shaders are compiled with BACKEND_EMBREE

    bool must_stop() const { return __atomic_load_n(is_stopped, __ATOMIC_RELAXED); }
};

// How a workgroup has ended.
enum class Outcome { finished, stopped, failed };
// Runs a workgroup. On an error, writes one line of text to `error`.
using RunGroup = Outcome (*)(const Bindings& bindings, uint32_t group, char* error, size_t error_size);

// What ends a shader early: an interrupt, or what a checked shader finds.
struct Stopped {};
struct Failed {
    char text[512];
};

}  // namespace lab::native
