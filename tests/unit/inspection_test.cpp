// Projecting paths into the picture, and instrumenting a shader to record its variables.
#include <gtest/gtest.h>

#include <algorithm>

#include "inspection/projection.h"
#include "inspection/recording_calls.h"
#include "scene/scene.h"

namespace lab {
namespace {

const Camera camera = make_camera({.position = {1, 2, 5}, .target = {1, 2, 0}, .up = {0, 1, 0}, .vertical_fov = 90}, 200, 100);

void expect_at(const std::optional<vec2>& position, float x, float y) {
    ASSERT_TRUE(position);
    EXPECT_NEAR(position->x, x, 1e-5f);
    EXPECT_NEAR(position->y, y, 1e-5f);
}

TEST(Projection, IsTheInverseOfTheCamerasRays) {
    // As in shaders/world/camera.glsl.
    for (const vec2 image : {vec2(0, 0), vec2(1, 1), vec2(0.3f, 0.8f), vec2(-0.5f, 1.5f)}) {
        const vec2 p = 2.0f * image - 1.0f;
        const vec3 direction = camera.forward + p.x * camera.right - p.y * camera.up;
        expect_at(project(camera, camera.position + 3.7f * direction), image.x, image.y);
    }
    expect_at(project(camera, {1, 7, 0}), 0.5f, 0);  // 45 degrees up
    EXPECT_FALSE(project(camera, {1, 2, 6}));
    EXPECT_FALSE(project(camera, camera.position));
}

TEST(Projection, CutsSegmentsThatReachBehindTheCamera) {
    const auto whole = project_segment(camera, {1, 2, 0}, {1, 7, 0});
    ASSERT_TRUE(whole);
    expect_at((*whole)[0], 0.5f, 0.5f);
    expect_at((*whole)[1], 0.5f, 0);
    const auto cut = project_segment(camera, {1, 3, 0}, {1, 3, 20});
    ASSERT_TRUE(cut);
    expect_at((*cut)[0], 0.5f, 0.4f);
    EXPECT_NEAR((*cut)[1].x, 0.5f, 1e-4f);
    EXPECT_LT((*cut)[1].y, -10);  // far above the picture
    const auto reversed = project_segment(camera, {1, 3, 20}, {1, 3, 0});
    ASSERT_TRUE(reversed);
    EXPECT_EQ((*reversed)[1], (*cut)[0]);
    EXPECT_FALSE(project_segment(camera, {1, 3, 8}, {1, 3, 20}));
}

std::string in_function(const std::string& body) { return "void f() {\n" + body + "\n}\n"; }

void expect_edit(const std::string& body, const std::string& edited) {
    EXPECT_EQ(add_recording_calls(in_function(body)), in_function(edited));
}
void expect_no_edit(const std::string& body) { expect_edit(body, body); }

TEST(RecordingCalls, FollowAssignmentsAndDeclarations) {
    expect_edit("throughput *= a;", "{ throughput *= a; record_throughput(EVENT_THROUGHPUT, throughput); }");
    expect_edit("if (b) throughput /= q;\nelse throughput = c;",
                "if (b) { throughput /= q; record_throughput(EVENT_THROUGHPUT, throughput); }\n"
                "else { throughput = c; record_throughput(EVENT_THROUGHPUT, throughput); }");
    expect_edit("throughput.r *= /* ; */ a *  // ;\n b;",
                "{ throughput.r *= /* ; */ a *  // ;\n b; record_throughput(EVENT_THROUGHPUT, throughput); }");
    expect_edit("vec3 throughput = vec3(1.0);",
                "vec3 throughput = vec3(1.0); record_throughput(EVENT_THROUGHPUT_STARTS, throughput);");
    expect_edit("float survival_probability = 0.5;", "float survival_probability = 0.5; record_survival(survival_probability);");
    expect_edit("float flight = f(path.medium, seed);", "float flight = f(path.medium, seed); record_flight(flight);");
    expect_edit("float flight = F; if (a) flight = b; else flight = c;",
                "float flight = F; record_flight(flight); if (a) { flight = b; record_flight(flight); } "
                "else { flight = c; record_flight(flight); }");
}

TEST(RecordingCalls, TellTheVariablesNamedRadianceApart) {
    expect_edit("{vec3 radiance = a; radiance += b;}\nvec3 radiance = c;\nfor (;;) radiance += d;",
                "{vec3 radiance = a; record_radiance(EVENT_RADIANCE_STARTS, radiance, 1u); "
                "{ radiance += b; record_radiance(EVENT_RADIANCE, radiance, 1u); }}\n"
                "vec3 radiance = c; record_radiance(EVENT_RADIANCE_STARTS, radiance, 2u);\n"
                "for (;;) { radiance += d; record_radiance(EVENT_RADIANCE, radiance, 2u); }");
}

TEST(RecordingCalls, FollowMembers) {
    expect_edit("path.throughput *= a;", "{ path.throughput *= a; record_throughput(EVENT_THROUGHPUT, path.throughput); }");
    expect_edit("if (b) path.radiance.r += c;",
                "if (b) { path.radiance.r += c; record_radiance(EVENT_RADIANCE, path.radiance, 0u); }");
    expect_edit("vec3 radiance = path.radiance;\npath.radiance = radiance;",
                "vec3 radiance = path.radiance; record_radiance(EVENT_RADIANCE_STARTS, radiance, 1u);\n"
                "{ path.radiance = radiance; record_radiance(EVENT_RADIANCE, path.radiance, 0u); }");
}

TEST(RecordingCalls, LeaveEverythingElseAlone) {
    expect_no_edit("// throughput *= a;\n/* throughput *= a; */\n#define X throughput *= a;");
    expect_no_edit("x = throughput * a; stack[0].throughput = b; f(throughput); throughputs *= 2; my_throughput = c;");
    expect_no_edit("for (uint i = 0u; throughput.x > 0.1; throughput *= 0.5) ++i;");
    expect_no_edit("radiance += somebody_elses;");
    expect_no_edit("path.radiance_scale /= a; path.survival_probability = b; f.throughput_of(c); flight = d; path.flight = e;");
    expect_no_edit("return b ? throughput : radiance;");
    const std::string at_file_scope = "vec3 throughput = vec3(1.0);\nstruct S { vec3 throughput; };\n";
    EXPECT_EQ(add_recording_calls(at_file_scope), at_file_scope);
    for (const std::string broken :
         {"void f() { throughput *= a", "void f() { throughput", "void f() { path.", "/*", "void f() { /*", "("})
        EXPECT_EQ(add_recording_calls(broken), broken);
}

}  // namespace
}  // namespace lab
