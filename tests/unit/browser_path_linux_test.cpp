// The path that a page of the book makes of recorded events, in JavaScript, is that of C++: both get the same events.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "inspection/path_recorder.h"
#include "unit/page_answer.h"
#include "unit/test_files.h"

namespace lab {
namespace {

using nlohmann::json;

json to_json(const vec3& v) { return {v.x, v.y, v.z}; }

json to_json(const RecordedEvent& event) {
    return {{"kind", event.kind},
            {"variable", event.variable},
            {"value", to_json(event.value)},
            {"origin", to_json(event.origin)},
            {"direction", to_json(event.direction)},
            {"end", event.end},
            {"flight", event.flight},
            {"is_hit", event.is_hit},
            {"position", to_json(event.position)},
            {"normal", to_json(event.normal)}};
}

// Any events in any order, as from estimators of any kind. Rays start at the camera or where an earlier one has ended.
std::vector<RecordedEvent> random_events(std::mt19937& random) {
    std::uniform_real_distribution<float> number(-1, 1);
    const auto vector = [&] { return vec3(number(random), number(random), number(random)); };
    const auto choose = [&](uint32_t count) { return static_cast<uint32_t>(random() % count); };
    const bool has_flights = choose(3) == 0;
    std::vector<RecordedEvent> events(2 + choose(30));
    std::vector<vec3> places{vector()};
    for (RecordedEvent& event : events) {
        event = {.kind = choose(3) == 0 ? EVENT_RAY : choose(EVENT_SPLAT + 1),
                 .variable = choose(3),
                 .value = vector(),
                 .origin = places[choose(static_cast<uint32_t>(places.size()))],
                 .direction = vector(),
                 .end = choose(2) == 0 ? 1.5f : std::numeric_limits<float>::max(),
                 .flight = has_flights && choose(2) == 0 ? 2 * std::abs(number(random)) : NO_FLIGHT,
                 .is_hit = choose(4) > 0,
                 .instance = 0,
                 .triangle = 0,
                 .barycentrics = vec2(0),
                 .position = vector(),
                 .normal = vector()};
        if (event.kind == EVENT_RAY) places.push_back(event.position);
    }
    return events;
}

void expect_near(const json& page, const vec3& expected, const char* what) {
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(page[static_cast<size_t>(i)].get<float>(), expected[i], 1e-5f * (1 + std::abs(expected[i]))) << what;
}

void expect_same(const json& page, const LightSample& light) {
    expect_near(page["start"], light.start, "start of a light sample");
    expect_near(page["direction"], light.direction, "direction of a light sample");
    expect_near(page["radiance"], light.radiance, "radiance of a light sample");
    EXPECT_EQ(page["isVisible"], light.is_visible);
    ASSERT_EQ(page["point"].is_null(), !light.point);
    if (light.point) expect_near(page["point"], *light.point, "light");
}

void expect_same(const json& page, const PathVertex& vertex) {
    EXPECT_EQ(page["parent"], vertex.parent);
    EXPECT_EQ(page["isHit"], vertex.is_hit);
    EXPECT_EQ(page["isCollision"], vertex.is_collision);
    expect_near(page["origin"], vertex.origin, "origin");
    expect_near(page["direction"], vertex.direction, "direction");
    expect_near(page["position"], vertex.position, "position");
    expect_near(page["normal"], vertex.normal, "normal");
    expect_near(page["throughput"], vertex.throughput, "throughput");
    expect_near(page["radiance"], vertex.radiance, "radiance");
    ASSERT_EQ(page["survivalProbability"].is_null(), !vertex.survival_probability);
    if (vertex.survival_probability) {
        EXPECT_FLOAT_EQ(page["survivalProbability"].get<float>(), *vertex.survival_probability);
    }
    ASSERT_EQ(page["lostRoulettes"].get<std::vector<float>>(), vertex.lost_roulettes);
    ASSERT_EQ(page["lightSamples"].size(), vertex.light_samples.size());
    for (size_t i = 0; i < vertex.light_samples.size(); ++i) expect_same(page["lightSamples"][i], vertex.light_samples[i]);
}

TEST(BrowserPath, IsThatOfThePrograms) {
    if (!has_node()) GTEST_SKIP() << "node is missing";
    std::mt19937 random(1);
    json task{{"paths", json::array()},
              {"kinds",
               {{"RAY", EVENT_RAY},
                {"SHADOW_RAY", EVENT_SHADOW_RAY},
                {"THROUGHPUT_STARTS", EVENT_THROUGHPUT_STARTS},
                {"THROUGHPUT", EVENT_THROUGHPUT},
                {"RADIANCE_STARTS", EVENT_RADIANCE_STARTS},
                {"RADIANCE", EVENT_RADIANCE},
                {"SURVIVAL", EVENT_SURVIVAL},
                {"RESULT", EVENT_RESULT},
                {"START", EVENT_START},
                {"SPLAT", EVENT_SPLAT}}}};
    std::vector<RecordedPath> expected;
    size_t collisions = 0, light_samples = 0, lost_roulettes = 0, of_light_paths = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::vector<RecordedEvent> events = random_events(random);
        json list = json::array();
        for (const RecordedEvent& event : events) list.push_back(to_json(event));
        task["paths"].push_back(list);
        expected.push_back(path_of(events));
    }
    const json page = answer_of_page("path", task);
    ASSERT_EQ(page.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(page[i]["hasThroughput"], expected[i].has_throughput);
        expect_near(page[i]["radiance"], expected[i].radiance, "radiance of the sample");
        const auto expect_same_vertices = [&](const json& of_page, const std::vector<PathVertex>& vertices) {
            ASSERT_EQ(of_page.size(), vertices.size());
            for (size_t v = 0; v < vertices.size(); ++v) {
                const PathVertex& vertex = vertices[v];
                expect_same(of_page[v], vertex);
                collisions += vertex.is_collision;
                light_samples += vertex.light_samples.size();
                lost_roulettes += vertex.lost_roulettes.size();
            }
        };
        expect_same_vertices(page[i]["vertices"], expected[i].vertices);
        expect_same_vertices(page[i]["lightPath"], expected[i].light_path);
        of_light_paths += expected[i].light_path.size();
    }
    // Or it would say little.
    for (const size_t count : {collisions, light_samples, lost_roulettes, of_light_paths}) EXPECT_GT(count, 100u);
}

}  // namespace
}  // namespace lab
