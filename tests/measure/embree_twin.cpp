#include "measure/embree_twin.h"

#if EMBREE_VERSION == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <pmmintrin.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <limits>
#include <numbers>

namespace lab {
namespace {

#include "ceiling_light.h"

constexpr float pi = std::numbers::pi_v<float>;

// The functions below correspond to random.glsl, frame.glsl, camera.glsl, shading_data.glsl and path_trace.glsl.
void advance_random_state(uvec2& seed) {
    seed = 1664525u * seed + 1013904223u;
    seed.x += 1664525u * seed.y;
    seed.y += 1664525u * seed.x;
    seed ^= seed >> 16u;
    seed.x += 1664525u * seed.y;
    seed.y += 1664525u * seed.x;
    seed ^= seed >> 16u;
}

uvec2 random_start_state(uint32_t pixel_index, uint32_t sample_index, uvec2 key) {
    uvec2 seed(pixel_index, sample_index);
    advance_random_state(seed);
    seed ^= key;
    advance_random_state(seed);
    return seed;
}

vec2 get_random_numbers(uvec2& seed) {
    advance_random_state(seed);
    return vec2(seed >> 8u) * (1.0f / 16777216.0f);
}

mat3 get_shading_space(const vec3& normal) {
    const float s = normal.z >= 0 ? 1.0f : -1.0f;
    const float a = -1.0f / (s + normal.z);
    const float b = normal.x * normal.y * a;
    return {vec3(1 + s * normal.x * normal.x * a, s * b, -s * normal.x), vec3(b, s + normal.y * normal.y * a, -normal.y), normal};
}

struct Ray {
    vec3 origin;
    vec3 direction;
};

Ray get_camera_ray(const Camera& camera, const vec2& image_position) {
    const vec2 position = 2.0f * image_position - 1.0f;
    return {camera.position, glm::normalize(camera.forward + position.x * camera.right - position.y * camera.up)};
}

struct ShadingData {
    vec3 position;
    vec3 normal;
    float offset;
    vec3 emission;
    vec3 diffuse_albedo;
};

Ray get_ray_from_surface(const ShadingData& s, const vec3& direction) {
    const float side = glm::dot(s.normal, direction) < 0 ? -1.0f : 1.0f;
    return {s.position + side * s.offset * s.normal, direction};
}

void set_ray(RTCRay& target, const Ray& ray, float t_max) {
    target.org_x = ray.origin.x, target.org_y = ray.origin.y, target.org_z = ray.origin.z;
    target.dir_x = ray.direction.x, target.dir_y = ray.direction.y, target.dir_z = ray.direction.z;
    target.tnear = 0;
    target.tfar = t_max;
    target.time = 0;
    target.mask = ~0u;
    target.flags = 0;
}

}  // namespace

struct EmbreeTwin::Implementation {
    const Scene& scene;
    const RenderParameters parameters;
    uint32_t samples = 0;
    glm::dvec3 sum{0};
    RTCDevice device = rtcNewDevice("threads=2");
    RTCScene embree_scene = rtcNewScene(device);

    Implementation(const Scene& source, const RenderParameters& render_parameters)
        : scene(source), parameters(render_parameters) {
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        const auto copy = [&](RTCBufferType type, RTCFormat format, const auto& data) {
            auto* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(data[0]), data.size());
            std::copy(data.begin(), data.end(), static_cast<std::remove_cvref_t<decltype(data[0])>*>(buffer));
        };
        copy(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, scene.positions);
        copy(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, scene.triangles);
        rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(embree_scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcSetSceneFlags(embree_scene, RTC_SCENE_FLAG_NONE);
        rtcSetSceneBuildQuality(embree_scene, RTC_BUILD_QUALITY_HIGH);
        rtcCommitScene(embree_scene);
    }
    ~Implementation() {
        rtcReleaseScene(embree_scene);
        rtcReleaseDevice(device);
    }

    bool trace_ray(const Ray& ray, RTCRayHit& hit) const {
        set_ray(hit.ray, ray, std::numeric_limits<float>::infinity());
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if EMBREE_VERSION == 4
        rtcIntersect1(embree_scene, &hit);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(embree_scene, &context, &hit);
#endif
        return hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }

    bool is_occluded(const Ray& ray, float t_max) const {
        RTCRay shadow_ray;
        set_ray(shadow_ray, ray, t_max);
#if EMBREE_VERSION == 4
        rtcOccluded1(embree_scene, &shadow_ray);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(embree_scene, &context, &shadow_ray);
#endif
        return shadow_ray.tfar < 0;
    }

    ShadingData get_shading_data(const RTCHit& hit, const vec3& ray_direction) const {
        const vec3 w(1 - hit.u - hit.v, hit.u, hit.v);
        const uvec3 corners = scene.triangles[hit.primID];
        const vec3 x_0 = scene.positions[corners.x], x_1 = scene.positions[corners.y], x_2 = scene.positions[corners.z];
        const vec3 position = w.x * x_0 + w.y * x_1 + w.z * x_2;
        const vec3 magnitude = w.x * glm::abs(x_0) + w.y * glm::abs(x_1) + w.z * glm::abs(x_2);
        const vec3 normal = glm::normalize(glm::cross(x_1 - x_0, x_2 - x_0));
        const float offset = 8 * 5.9604645e-8f * (magnitude.x + magnitude.y + magnitude.z);
        const Material& material = scene.materials[scene.triangle_materials[hit.primID]];
        const bool is_front = glm::dot(normal, ray_direction) < 0;
        return {position, is_front ? normal : -normal, offset, is_front ? material.emission : vec3(0), material.diffuse_albedo};
    }

    vec3 path_trace(Ray ray, uvec2& seed) const {
        vec3 radiance(0);
        vec3 throughput(1);
        for (uint32_t k = 0;; ++k) {
            RTCRayHit hit;
            if (!trace_ray(ray, hit)) break;
            const ShadingData s = get_shading_data(hit.hit, ray.direction);
            if (k == 0) radiance += s.emission;
            if (k == parameters.max_path_length) break;

            vec2 u = get_random_numbers(seed);
            throughput *= s.diffuse_albedo;
            const vec3 to_light = LIGHT_CORNER + u.x * LIGHT_EDGE_1 + u.y * LIGHT_EDGE_2 - s.position;
            const float cosines =
                std::max(0.0f, glm::dot(s.normal, to_light)) * std::max(0.0f, -glm::dot(LIGHT_NORMAL, to_light));
            if (cosines > 0 && !is_occluded(get_ray_from_surface(s, to_light), 0.9999f)) {
                const float squared_distance = glm::dot(to_light, to_light);
                const float form_factor = cosines * LIGHT_AREA / (pi * squared_distance * squared_distance);
                radiance += throughput * LIGHT_RADIANCE * form_factor;
            }

            const float survival = std::min(SURVIVAL_CAP, std::max({throughput.r, throughput.g, throughput.b}));
            if (get_random_numbers(seed).x >= survival) break;
            throughput /= survival;
            u = get_random_numbers(seed);
            const float radius = std::sqrt(u.x), angle = 2 * pi * u.y;
            const vec3 direction(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - u.x));
            ray = get_ray_from_surface(s, get_shading_space(s.normal) * direction);
        }
        return radiance;
    }

    // Sums the samples from `samples` to target_samples of all pixels in tiles that no other thread has taken.
    glm::dvec3 render_tiles(std::atomic<uint32_t>& next_tile, uint32_t target_samples) const {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
        constexpr uint32_t tile_size = 16;
        const uvec2 size = parameters.image_size;
        const uvec2 tiles = (size + tile_size - 1u) / tile_size;
        glm::dvec3 tile_sum(0);
        for (uint32_t tile = next_tile++; tile < tiles.x * tiles.y; tile = next_tile++) {
            const uvec2 low = tile_size * uvec2(tile % tiles.x, tile / tiles.x);
            const uvec2 high = glm::min(low + tile_size, size);
            for (uint32_t y = low.y; y < high.y; ++y)
                for (uint32_t x = low.x; x < high.x; ++x)
                    for (uint32_t k = samples; k < target_samples; ++k) {
                        uvec2 seed = random_start_state(y * size.x + x, k, parameters.seed_key);
                        const vec2 position = (vec2(x, y) + get_random_numbers(seed)) / vec2(size);
                        tile_sum += path_trace(get_camera_ray(parameters.camera, position), seed);
                    }
        }
        return tile_sum;
    }

    void advance(uint32_t target_samples) {
        std::atomic<uint32_t> next_tile = 0;
        const auto work = [&] { return render_tiles(next_tile, target_samples); };
        auto other = std::async(std::launch::async, work);
        auto own = std::async(std::launch::async, work);
        sum += own.get() + other.get();
        samples = target_samples;
    }
};

EmbreeTwin::EmbreeTwin(const Scene& scene, const RenderParameters& parameters)
    : implementation_(std::make_unique<Implementation>(scene, parameters)) {}
EmbreeTwin::~EmbreeTwin() = default;

void EmbreeTwin::advance(uint32_t target_samples) { implementation_->advance(target_samples); }

glm::dvec3 EmbreeTwin::mean() const {
    const uvec2 size = implementation_->parameters.image_size;
    return implementation_->sum / (static_cast<double>(size.x) * size.y * implementation_->samples);
}

}  // namespace lab
