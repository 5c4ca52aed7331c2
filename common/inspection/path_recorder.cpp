#include "inspection/path_recorder.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

#include "files/project_folder.h"
#include "inspection/recording_calls.h"
#include "tracing/limited_loops.h"

namespace lab {
namespace {

constexpr uint32_t max_events = 4096;
constexpr float no_limit = std::numeric_limits<float>::max();  // the shaders' NO_LIMIT

// The head of the buffer; the events follow.
struct Header {
    uint32_t pixel;
    uint32_t sample;
    uint32_t event_count;
};

bool has_flight(const RecordedEvent& event) { return event.kind == EVENT_RAY && event.flight != NO_FLIGHT; }
bool is_ray(const RecordedEvent& event) { return event.kind == EVENT_RAY || event.kind == EVENT_SHADOW_RAY; }

// Turns events into vertices.
class PathBuilder {
  public:
    explicit PathBuilder(std::span<const RecordedEvent> events)
        : events_(events), has_flights_(std::ranges::any_of(events, has_flight)) {}

    RecordedPath build() {
        for (next_ = 0; next_ < events_.size();) {
            const RecordedEvent& event = events_[next_++];
            switch (event.kind) {
                case EVENT_RAY:
                    if (looks_for_boundaries(event))
                        add_light_sample(event);
                    else
                        add_vertex(event);
                    break;
                case EVENT_SHADOW_RAY:
                    add_light_sample(event);
                    break;
                case EVENT_THROUGHPUT_STARTS:
                    end_roulette();
                    start_branch();
                    [[fallthrough]];
                case EVENT_THROUGHPUT:
                    throughput_ = event.value;
                    path_.has_throughput = true;
                    break;
                case EVENT_RADIANCE_STARTS:
                case EVENT_RADIANCE:
                    add_radiance(event);
                    break;
                case EVENT_SPLAT:
                    add_splat(event);
                    break;
                case EVENT_SURVIVAL:
                    end_roulette();
                    survival_probability_ = event.value.x;
                    break;
                case EVENT_RESULT:
                    path_.radiance = event.value;
                    break;
                default:  // EVENT_START
                    break;
            }
        }
        end_roulette();
        return std::move(path_);
    }

  private:
    // The vertex that a ray starts from. Rays start only a few ulps off the surface, so it is the nearest one, and the latest of
    // several in one place.
    int vertex_at(const vec3& origin) const {
        int nearest = -1;
        float smallest = std::numeric_limits<float>::infinity();
        for (size_t i = path_.vertices.size(); i-- > 0;) {
            const PathVertex& vertex = path_.vertices[i];
            if (!vertex.is_in_scene()) continue;
            const float distance = glm::length(vertex.position - origin);
            if (distance < smallest) {
                smallest = distance;
                nearest = static_cast<int>(i);
            }
        }
        return nearest;
    }

    // In media, rays of a path have a flight. The others look for boundaries: from the camera, or on a light sample's way.
    bool looks_for_boundaries(const RecordedEvent& event) const { return has_flights_ && !has_flight(event); }

    void add_vertex(const RecordedEvent& event) {
        PathVertex vertex{.parent = vertex_at(event.origin),
                          .origin = event.origin,
                          .direction = glm::normalize(event.direction),
                          .is_hit = event.is_hit != 0,
                          .instance = event.instance,
                          .triangle = event.triangle,
                          .barycentrics = event.barycentrics,
                          .position = event.position,
                          .normal = event.normal,
                          .throughput = throughput_,
                          .survival_probability = survival_probability_,
                          .light_samples = {},
                          .lost_roulettes = {}};
        survival_probability_.reset();
        constexpr float shortened = 1 - 0x1p-18f;  // as chapter 13 does: flights that end close to a surface end there
        const float t_max = vertex.is_hit ? shortened * glm::distance(vertex.position, vertex.origin) : no_limit;
        if (has_flight(event) && event.flight < t_max) {
            vertex.is_hit = false;
            vertex.is_collision = true;
            vertex.position = event.origin + event.flight * event.direction;  // not quite a unit vector on some drivers
            vertex.normal = vec3(0);
        }
        path_.vertices.push_back(std::move(vertex));
        site_ = static_cast<int>(path_.vertices.size()) - 1;
        is_light_sampled_ = false;
    }

    // Whether a ray goes on behind the boundary that ended the ray before.
    bool goes_on(const RecordedEvent& event) const {
        if (next_ < 2 || event.kind != EVENT_RAY) return false;
        const RecordedEvent& before = events_[next_ - 2];
        if (before.kind != EVENT_RAY || !looks_for_boundaries(before) || before.is_hit == 0) return false;
        const float size = glm::length(event.origin) + glm::distance(before.origin, before.position);
        return glm::distance(before.position, event.origin) <= 1e-4f * size;
    }

    void add_light_sample(const RecordedEvent& event) {
        if (goes_on(event)) {
            if (is_light_sampled_) site().light_samples.back().is_visible = event.is_hit == 0;
            return;
        }
        site_ = vertex_at(event.origin);
        is_light_sampled_ = site_ >= 0;
        if (!is_light_sampled_) return;
        LightSample light{
            .start = event.origin, .direction = glm::normalize(event.direction), .point = {}, .is_visible = event.is_hit == 0};
        if (event.end < no_limit) light.point = event.origin + event.end * event.direction;
        site().light_samples.push_back(light);
    }

    // What follows happens at the origin of the branch's first ray, and a light sample before it adds nothing there.
    void start_branch() {
        is_light_sampled_ = false;
        const auto ray = std::find_if(events_.begin() + static_cast<std::ptrdiff_t>(next_), events_.end(), is_ray);
        if (ray != events_.end()) site_ = vertex_at(ray->origin);
    }

    void add_radiance(const RecordedEvent& event) {
        const vec3 before = event.kind == EVENT_RADIANCE_STARTS ? vec3(0) : radiances_[event.variable];
        // A sum over branches repeats what was added within them.
        const bool is_sum = event.kind == EVENT_RADIANCE && event.variable != latest_variable_;
        radiances_[event.variable] = event.value;
        latest_variable_ = event.variable;
        if (is_sum || site_ < 0) return;
        site().radiance += event.value - before;
        if (is_light_sampled_) site().light_samples.back().radiance = event.value - before;
        is_light_sampled_ = false;
    }

    // What the latest light sample adds, even if no variable `radiance` has said so before.
    void add_splat(const RecordedEvent& event) {
        if (site_ < 0 || site().light_samples.empty()) return;
        vec3& radiance = site().light_samples.back().radiance;
        site().radiance += event.value - radiance;
        radiance = event.value;
    }

    // No ray followed this survival probability: the path has ended.
    void end_roulette() {
        if (survival_probability_ && site_ >= 0) site().lost_roulettes.push_back(*survival_probability_);
        survival_probability_.reset();
    }

    PathVertex& site() { return path_.vertices[static_cast<size_t>(site_)]; }

    std::span<const RecordedEvent> events_;
    bool has_flights_;  // the scene has media
    size_t next_ = 0;
    RecordedPath path_;
    int site_ = -1;  // the vertex of the current events
    vec3 throughput_{1};
    std::optional<float> survival_probability_;
    std::map<uint32_t, vec3> radiances_;  // of each variable of that name
    uint32_t latest_variable_ = 0;
    bool is_light_sampled_ = false;  // and not added yet
};

}  // namespace

RecordedPath path_of(std::span<const RecordedEvent> events) {
    const auto is_start = [](const RecordedEvent& event) { return event.kind == EVENT_START; };
    const auto begin = std::find_if(events.rbegin(), events.rend(), is_start).base();
    RecordedPath path = PathBuilder({begin, events.end()}).build();
    path.light_path = PathBuilder({events.begin(), begin}).build().vertices;
    return path;
}

Estimator recording(const Estimator& estimator) {
    return {.file = project_folder() / "shaders" / "observation" / "record_path" / "path_trace.glsl",
            .defines = estimator.defines,
            .observed = estimator.file,
            .edit = [further = estimator.edit](const std::string& text) {
                const std::string recorded = add_recording_calls(text);
                return further ? further(recorded) : recorded;
            }};
}

PathRecorder::PathRecorder(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator,
                           const RenderParameters& parameters)
    : estimator_(estimator),
      // The samples go into a single row of blocks, wherever the pixel is in the image.
      film_(device, parameters.image_size.x, BLOCK_HEIGHT),
      parameters_(device, sizeof(RenderParameters), vk::BufferUsageFlagBits::eUniformBuffer),
      ray_counters_(device, ray_counters_size, vk::BufferUsageFlagBits::eStorageBuffer, Buffer::Location::host),
      events_(device, sizeof(Header) + max_events * sizeof(RecordedEvent), vk::BufferUsageFlagBits::eStorageBuffer) {
    std::vector<Binding> bindings = film_.bindings();
    bindings.push_back(uniform_binding(BINDING_RENDER_PARAMETERS, parameters_));
    bindings.push_back(storage_binding(BINDING_RAY_COUNTERS, ray_counters_));
    bindings.push_back(storage_binding(BINDING_RECORDED_PATH, events_));
    Estimator configured = recording(estimator);
    if (parameters.splat_unit > 0) configured.defines.emplace_back("SPLATS");
    tracer_ = scene_backend.make_tracer(configured, bindings);
}

RecordedPath PathRecorder::record(const RenderParameters& parameters, uvec2 pixel, uint32_t sample) {
    RenderParameters of_sample = parameters;
    of_sample.first_sample = sample;
    parameters_.write(&of_sample, sizeof of_sample);
    film_.clear();
    const std::span<uint32_t> counters = ray_counters_.mapped<uint32_t>();
    std::fill(counters.begin(), counters.end(), 0);
    const Header header{pixel.y * film_.width() + pixel.x, sample, 0};
    events_.write(&header, sizeof header);

    const uint32_t row = pixel.y / BLOCK_HEIGHT;
    const uint32_t block = row * count_blocks({film_.width(), 1}) + pixel.x / BLOCK_WIDTH;
    const DispatchParameters step{block, 1, 1, 1, row * BLOCK_HEIGHT * film_.width()};
    tracer_->trace(std::span(&step, 1), 1, 0);
    check_loops(counters, estimator_);

    std::vector<std::byte> bytes(events_.size());
    events_.read(bytes.data(), bytes.size());
    Header result;
    std::memcpy(&result, bytes.data(), sizeof result);
    std::vector<RecordedEvent> events(std::min(result.event_count, max_events));
    std::memcpy(events.data(), bytes.data() + sizeof result, events.size() * sizeof(RecordedEvent));
    RecordedPath path = path_of(events);
    path.is_complete = result.event_count <= max_events;
    return path;
}

}  // namespace lab
