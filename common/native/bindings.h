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

struct RayPacket;  // packet.h

// Rays by Embree: embree.h and few_triangles.h, which are compiled like a shader.
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
    uint32_t group_count;
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
