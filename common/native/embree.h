// Embree for translated shaders. It is no part of the lab's programs: like a shader it is compiled on the computer that runs it,
// after the header of Embree 3 or 4 that this one has.
#pragma once
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

#include "native/bindings.h"
#include "native/lanes/packet.h"

namespace lab::native {

class EmbreeTracer : public RayTracer {
  public:
    EmbreeTracer(const Triangle* triangles, size_t count) : unit_(unit_for(triangles, count)) {
        device_.reset(rtcNewDevice(nullptr));
        rtcSetDeviceMemoryMonitorFunction(
            device_.get(),
            [](void* bytes, ssize_t change, bool) {
                *static_cast<std::atomic<size_t>*>(bytes) += static_cast<size_t>(change);
                return true;
            },
            &bytes_);
        scene_.reset(rtcNewScene(device_.get()));
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        const auto buffer = [&](RTCBufferType type, RTCFormat format, size_t elements) {
            return rtcSetNewGeometryBuffer(geometry, type, 0, format, 3 * sizeof(float), elements);
        };
        auto* corner = static_cast<float*>(buffer(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3 * count));
        auto* index = static_cast<uint32_t*>(buffer(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, count));
        if (count > 0 && (!corner || !index)) throw std::bad_alloc();
        places_.resize(std::max<size_t>(count, 1));  // rays that hit nothing read the first
        for (size_t i = 0; i < count; ++i) {
            const auto& [x, y, z] = triangles[i];
            places_[i] = {x.id, y.id};
            for (size_t j = 0; j < 3; ++j) {
                for (const auto& row : {x, y, z}) *corner++ = row.corners[j] * unit_;
                *index++ = static_cast<uint32_t>(3 * i + j);
            }
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_.get(), geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_.get());
        if (rtcGetDeviceError(device_.get()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    }

    bool trace(const float* origin, const float* direction, float t_max, RayHit* hit) const override {
        RTCRayHit query;
        query.ray = {.org_x = origin[0] * unit_,
                     .org_y = origin[1] * unit_,
                     .org_z = origin[2] * unit_,
                     .tnear = 0,
                     .dir_x = direction[0],
                     .dir_y = direction[1],
                     .dir_z = direction[2],
                     .time = 0,
                     .tfar = t_max * unit_,
                     .mask = ~0u,
                     .id = 0,
                     .flags = 0};
        if (!hit) {
            occluded(query.ray);
            return query.ray.tfar < 0;
        }
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersect(query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        const Place& place = places_[query.hit.primID];
        *hit = {place.instance, place.triangle, {query.hit.u, query.hit.v}, query.ray.tfar / unit_};
        return true;
    }
    void find_closest_hits(RayPacket& packet) const override {
        static_assert(sizeof(RayHits) <= offsetof(RayPacket, instance));
        static_assert(offsetof(RayHits, hit.primID) == offsetof(RayPacket, primitive));
        packet.geometry = Words{} + RTC_INVALID_GEOMETRY_ID;
        to_units(packet);
        intersect(reinterpret_cast<const int*>(&packet.is_active), *reinterpret_cast<RayHits*>(&packet));
        packet.is_active &= packet.geometry != RTC_INVALID_GEOMETRY_ID;
        to_scene(packet);
    }
    void find_any_hits(RayPacket& packet) const override {
        to_units(packet);
        occluded(reinterpret_cast<const int*>(&packet.is_active), *reinterpret_cast<Rays*>(&packet));
        packet.is_active &= packet.t_max < 0;
    }
    size_t bytes() const override { return bytes_ + places_.size() * sizeof(Place); }

  protected:
    // From the scene to what Embree knows, and back.
    void to_units(RayPacket& packet) const {
        for (Floats& coordinates : packet.origin) coordinates *= unit_;
        packet.t_max *= unit_;
    }
    void to_scene(RayPacket& packet) const {
        for (int i = 0; i < lane_count; ++i) {
            const Place& place = places_[packet.primitive[i] & static_cast<uint32_t>(packet.is_active[i])];
            packet.instance[i] = place.instance;
            packet.triangle[i] = place.triangle;
        }
        packet.t_max *= 1 / unit_;
    }
    const float unit_;  // length of the scene's unit in Embree

  private:
    // Embree multiplies three lengths, which must neither overflow nor underflow: it gets a scene whose coordinates are up to
    // 2^36, so that their products stay below 2^127 and triangles may be smaller by twenty powers of ten. As a power of two, this
    // factor changes no digit.
    static float unit_for(const Triangle* triangles, size_t count) {
        float largest = 0;
        for (size_t i = 0; i < count; ++i)
            for (const auto& row : {triangles[i].x, triangles[i].y, triangles[i].z})
                for (const float coordinate : row.corners) largest = std::max(largest, std::abs(coordinate));
        int exponent = 0;
        std::frexp(largest, &exponent);
        return std::ldexp(1.0f, std::clamp(36 - exponent, -126, 126));
    }

#ifdef __AVX512DQ__
    using Rays = RTCRay16;
    using RayHits = RTCRayHit16;
    static constexpr auto occluded_lanes = rtcOccluded16;
    static constexpr auto intersect_lanes = rtcIntersect16;
#else
    using Rays = RTCRay8;
    using RayHits = RTCRayHit8;
    static constexpr auto occluded_lanes = rtcOccluded8;
    static constexpr auto intersect_lanes = rtcIntersect8;
#endif
    // No rays are announced as coherent: Embree is three times as slow with those that are not, such as a single one.
#if RTC_VERSION_MAJOR >= 4
    void occluded(RTCRay& ray) const { rtcOccluded1(scene_.get(), &ray); }
    void intersect(RTCRayHit& query) const { rtcIntersect1(scene_.get(), &query); }
    void occluded(const int* valid, Rays& rays) const { occluded_lanes(valid, scene_.get(), &rays, nullptr); }
    void intersect(const int* valid, RayHits& query) const { intersect_lanes(valid, scene_.get(), &query, nullptr); }
#else
    struct Context : RTCIntersectContext {
        Context() { rtcInitIntersectContext(this); }
    };
    void occluded(RTCRay& ray) const {
        Context context;
        rtcOccluded1(scene_.get(), &context, &ray);
    }
    void intersect(RTCRayHit& query) const {
        Context context;
        rtcIntersect1(scene_.get(), &context, &query);
    }
    void occluded(const int* valid, Rays& rays) const {
        Context context;
        occluded_lanes(valid, scene_.get(), &context, &rays);
    }
    void intersect(const int* valid, RayHits& query) const {
        Context context;
        intersect_lanes(valid, scene_.get(), &context, &query);
    }
#endif

    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    struct Place {  // of a triangle in the scene
        uint32_t instance, triangle;
    };
    std::vector<Place> places_;
    std::atomic<size_t> bytes_ = 0;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
};

}  // namespace lab::native
