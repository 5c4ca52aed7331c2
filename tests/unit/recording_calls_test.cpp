// Where a recording build of a shader tells of its variables.
#include "inside/recording_calls.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lab {
namespace {

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
    expect_edit(
        "throughput.r *= /* ; */ a *  // ;\n b;",
        "{ throughput.r *= /* ; */ a *  // ;\n b; record_throughput(EVENT_THROUGHPUT, throughput); }");
    expect_edit("vec3 throughput = vec3(1.0);",
                "vec3 throughput = vec3(1.0); record_throughput(EVENT_THROUGHPUT_STARTS, throughput);");
    expect_edit("float survival_probability = 0.5;",
                "float survival_probability = 0.5; record_survival(survival_probability);");
}

TEST(RecordingCalls, TellTheVariablesNamedRadianceApart) {
    expect_edit("{vec3 radiance = a; radiance += b;}\nvec3 radiance = c;\nfor (;;) radiance += d;",
                "{vec3 radiance = a; record_radiance(EVENT_RADIANCE_STARTS, radiance, 1u); "
                "{ radiance += b; record_radiance(EVENT_RADIANCE, radiance, 1u); }}\n"
                "vec3 radiance = c; record_radiance(EVENT_RADIANCE_STARTS, radiance, 2u);\n"
                "for (;;) { radiance += d; record_radiance(EVENT_RADIANCE, radiance, 2u); }");
}

TEST(RecordingCalls, FollowMembers) {
    expect_edit("path.throughput *= a;",
                "{ path.throughput *= a; record_throughput(EVENT_THROUGHPUT, path.throughput); }");
    expect_edit("if (b) path.radiance.r += c;",
                "if (b) { path.radiance.r += c; record_radiance(EVENT_RADIANCE, path.radiance, 0u); }");
    expect_edit("vec3 radiance = path.radiance;\npath.radiance = radiance;",
                "vec3 radiance = path.radiance; record_radiance(EVENT_RADIANCE_STARTS, radiance, 1u);\n"
                "{ path.radiance = radiance; record_radiance(EVENT_RADIANCE, path.radiance, 0u); }");
}

TEST(RecordingCalls, LeaveEverythingElseAlone) {
    expect_no_edit("// throughput *= a;\n/* throughput *= a; */\n#define X throughput *= a;");
    expect_no_edit(
        "x = throughput * a; stack[0].throughput = b; f(throughput); throughputs *= 2; my_throughput = c;");
    expect_no_edit("for (uint i = 0u; throughput.x > 0.1; throughput *= 0.5) ++i;");
    expect_no_edit("radiance += somebody_elses;");
    expect_no_edit("path.radiance_scale /= a; path.survival_probability = b; f.throughput_of(c);");
    expect_no_edit("return b ? throughput : radiance;");
    const std::string at_file_scope = "vec3 throughput = vec3(1.0);\nstruct S { vec3 throughput; };\n";
    EXPECT_EQ(add_recording_calls(at_file_scope), at_file_scope);
    for (const std::string broken : {"void f() { throughput *= a", "void f() { throughput",
                                     "void f() { path.", "/*", "void f() { /*", "("})
        EXPECT_EQ(add_recording_calls(broken), broken);
}

}  // namespace
}  // namespace lab
