// Shaders in lanes give what they give one invocation at a time: random programs of everything that may divide lanes.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstdlib>
#include <numeric>
#include <random>
#include <span>

#include "native/module.h"
#include "native_shader.h"
#include "parallel.h"

namespace lab {
namespace {

constexpr uint32_t invocations = 29;  // in the last packet some lanes are idle
constexpr uint32_t group_count = 2;

std::vector<uint32_t> run(const native::Code& code, size_t program_count) {
    std::vector<uint32_t> results(program_count * invocations * group_count), table(16);
    for (uint32_t i = 0; i < 16; ++i) table[i] = i * i * 40503u;
    native::Bindings bindings{};
    const auto bind = [&](size_t index, std::vector<uint32_t>& numbers) {
        bindings.ranges[index] = {reinterpret_cast<std::byte*>(numbers.data()), numbers.size() * sizeof(uint32_t)};
    };
    bind(1, results);
    bind(2, table);
    bind(3, table);  // four pairs
    native::run_groups(code.run, bindings, group_count);
    return results;
}

native::Code load_main(const std::string& body) {
    return native::load(
        compile_glsl("layout(scalar, set = 0, binding = 1) buffer Results { uint results[]; };"
                     "layout(scalar, set = 0, binding = 3) readonly buffer Numbers { uvec4 numbers[]; };\n"
                     "layout(local_size_x = 1) in;\nstruct Named { uint offset, raw; };"
                     "bool set(inout bool b) { b = true; return b; } uint add(uint a, inout uint b) { b += a; return b + 3u; }"
                     "uint count = 1u; uint count_up() { return ++count; } const uint two = 2u, five = 10u / two;"
                     "uint late(uint a) { count = 7u; return a; } uint ahead(); uint call_ahead() { return ahead(); } "
                     "uint ahead() { return count *= 2u; } uint a_switch(int i) { switch (i) { case 0: return 5u; case 1: "
                     "default: break; } return "
                     "7u; }\nvoid main() {\nuint i = gl_GlobalInvocationID.x;\n" +
                     body + "\n}\n"));
}

// The number that a shader writes, and why it runs one by one.
std::pair<uint32_t, std::string> result_and_reason(const std::string& body) {
    const native::Code code = load_main(body);
    return {run(code, 1).front(), code.why_one_by_one};
}

TEST(NativeLanes, KnowFunctionsOfVectorsAndMatrices) {
    EXPECT_EQ(result_and_reason("vec2 n = vec2(0, 1);\nresults[i] = uint(transpose(mat2(1.0, 2.0, 3.0, float(i)))[0].y - "
                                "faceforward(n, vec2(float(i), 1.0), n).y - refract(vec2(float(i), -1.0), n, 1.0).y + "
                                "determinant(mat2(1.0)) - 1.0);"),
              std::pair(5u, std::string()));
}

// Its square would be 0.
TEST(NativeLanes, KnowTheLengthOfOneNumber) {
    EXPECT_EQ(result_and_reason("results[i] = uint(length(float(i) - 1e-30) * 1e31 + distance(float(i), 1e-30) * 1e31 + 0.5);"),
              std::pair(20u, std::string()));
}

TEST(NativeLanes, RunOneByOneWhereAnArrayTakesTheStack) {
    const auto [result, reason] = result_and_reason("float a[40000]; a[i] = 3.0; results[i] = uint(a[i]);");
    EXPECT_EQ(result, 3u);
    EXPECT_PRED_FORMAT2(::testing::IsSubstring, "fits on the stack for one path only", reason);
}

// More than 2^31 words: from 2^27 triangles on, of 64 bytes each.
TEST(NativeLanes, ReachTheEndOfLargeArrays) {
    struct Element {
        uint32_t words[16];
    };
    constexpr size_t count = (size_t{1} << 28) - 1;
    void* const memory =
        mmap(nullptr, count * sizeof(Element), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) GTEST_SKIP() << "no room for addresses";
    const std::span elements(static_cast<Element*>(memory), count);
    const native::Code code = native::load(compile_glsl(R"(
struct Element { uvec3 a; uint b; uvec4 c, d; uint e[4]; };
layout(scalar, set = 0, binding = 1) buffer Elements { Element elements[]; };
layout(local_size_x = 16) in;
void main() {
    uint last = 268435454u - gl_GlobalInvocationID.x;
    elements[last].b = elements[last].a.y + elements[last].c.w + elements[last].e[3] + elements[last].d.x;
})"));
    EXPECT_EQ(code.why_one_by_one, "");
    for (uint32_t i = 0; i < 16; ++i) elements[count - 1 - i] = {{0, 10 + i, 0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 2}};
    native::Bindings bindings{};
    bindings.ranges[1] = {reinterpret_cast<std::byte*>(memory), elements.size_bytes()};
    native::run_groups(code.run, bindings, 1);
    for (uint32_t i = 0; i < 16; ++i) EXPECT_EQ(elements[count - 1 - i].words[3], 15 + i);
    munmap(memory, elements.size_bytes());
}

// Each body gives 5, in lanes and one by one.
template <size_t count>
void expect_fives(const std::string (&bodies)[count]) {
    static_assert(count <= invocations);
    std::string text;
    for (size_t k = 0; k < count; ++k)
        text += "{ uint x = i, r;\n" + bodies[k] + "\nresults[i * " + std::to_string(count) + "u + " + std::to_string(k) +
                "u] = r; }\n";
    for (const native::Mode mode : {native::Mode::fast, native::Mode::debug}) {
        native::set_mode(mode);
        const native::Code code = load_main(text);
        EXPECT_EQ(code.why_one_by_one.empty(), mode == native::Mode::fast) << code.why_one_by_one;
        const std::vector<uint32_t> results = run(code, 1);
        for (size_t k = 0; k < count; ++k) EXPECT_EQ(results[k], 5u) << bodies[k];
    }
    native::set_mode(native::Mode::fast);
}

// As GLSL says: from left to right, and a function's results are copied out when it returns.
TEST(NativeLanes, EvaluateInOrder) {
    const std::string bodies[] = {"r = x++ < 5u && x == 1u ? 5u : 7u;",
                                  "r = x++ > 5u || x == 1u ? 5u : 7u;",
                                  "r = x++ < 5u ^^ x == 1u ? 7u : 5u;",
                                  "r = x++ < 5u ? x + 4u : x;",
                                  "bool b = i > 5u;\nr = b || set(b) && i > 5u ? 7u : 5u;",
                                  "x = 2u; r = x++ + x;",
                                  "uvec2 n = uvec2(2u, x);\nn.y = add(n.x, n.y);\nr = n.y;",
                                  "Named n = Named(2u, x);\nn.raw = x < 5u ? add(n.offset, n.raw) : 7u;\nr = n.raw;",
                                  "Named n = Named(1u, x);\nr = add(n.offset, n.raw) + n.raw;",
                                  "Named n = Named(1u, x);\nr = add(n.offset++, n.raw) + n.raw;",
                                  "r = x + count + count_up() + count;",
                                  "count = five + i;\nr = late((count));",
                                  "r = i > 5u ? 10u / numbers[0].x : 5u;"};
    expect_fives(bodies);
}

TEST(NativeLanes, ComputeWhatGlslSays) {
    const std::string bodies[] = {
        "float f = i > 5u ? 0 : float(add(2u, x)) * 0.5;\nr = uint(f * 2.0);",
        "r = 5u;\nbool b = gl_WorkGroupID.x > 3u && r++ < i;",
        "uint n = 5u;\nbool b = gl_WorkGroupID.x < 3u || n++ < i;\nr = n;",
        "{ uint x = x + 5u;\nr = x; }",
        "r = 0xffffffff < 1 ? 5u : 7u;",
        "r = uint(bitfieldExtract(int(i) - 3, 0, 8) + findMSB(int(i) - 40) + 3);",
        "uvec3 v = uvec3(x);\nv.zyx.x = 2u;\nv.zyx[2] = 3u;\nv.zyx = v;\nr = v.x + v.z;",
        "r = numbers[i].zyx.x == numbers[i].z ? 5u : 7u;",
        "r = 3u + call_ahead();",
        "int n = 2147483647 + int(gl_WorkGroupID.x);\nr = n + 1 > n ? 7u : 5u;",
        "mat3 m = mat3(2.0);\nm[0][0] = float(x);\nmat4 n = mat4(m);\nr = uint(n[0][0] + n[2][2] + 3.0 * n[3][3] + n[3][0]);",
        "uint n = gl_WorkGroupID.x;\nr = i > 5u && n > 0u && numbers[(n - 1u) * 40000000u].x > 0u ? 7u : 5u;",
        "const Named table[2] = Named[2](Named(5u, 2u), Named(7u, 3u));\nr = table[i].offset;",
        "uvec2 v = uvec2(x, 4);\nv++;\nr = v.y;",
        "r = gl_NumWorkGroups.x + 3u;",
        "uint active__ = 5u;\nr = active__;\nif (i > 5u) r = active__ + i;",
        "float zero = -float(gl_WorkGroupID.x / 4u), y = zero;\nif (i > 20u) y = 1.0;\nr = 1.0 / y < 0.0 ? 5u : 7u;",
        "vec2 v = vec2(gl_NumWorkGroups.x), w = mix(v, v + 3.0, bvec2(v.x > 9.0, true));\nr = uint(w.y);",
        "results[50u + i] = 3u;\nr = atomicCompSwap(results[50u + i], 3u, 2u) + atomicCompSwap(results[50u + i], 3u, 7u);",
    };
    expect_fives(bodies);
}

TEST(NativeLanes, KnowCasesStructuresAndArrays) {
    const std::string bodies[] = {
        "r = 2u;\nswitch (x) { case 0u: r = 5u; }",
        "r = 2u;\nswitch (x) { case 3u: r = 7u; default: r = 4u; case 4u: r += 1u; break; case 5u: r = 7u; }",
        "r = 0u;\nfor (uint k = 0u; k < 6u; ++k) { switch (k + x) { case 2u: continue; case 4u: break; default: ++r; } r += k / "
        "4u; } r -= 1u;",
        "uint a[2];\na[0] = 3u;\na[x] = 5u;\nr = a[0];",
        "uint a[2], k = 0u;\na[0] = x;\na[1] = 0u;\na[k++] += 5u;\nr = a[0] + k - 1u;",
        "struct S { uint x, y[2]; };\nS s[2];\ns[1] = S(1u, uint[2](2u, 3u));\ns[x] = S(4u, uint[2](x, 7u));\ns[x].y[x] += "
        "5u;\nr = s[0].y[0];",
        "const bool table[2] = bool[2](true, false);\nr = table[x] ? 5u : 7u;",
        "vec3 v = vec3(1);\nv[x] = 5.0;\nr = uint(v[x] * v.y);",
        "mat3 m = mat3(2.0);\nm[x][x + 1u] = 3.0;\nr = uint((m * 0.5 * vec3(4, 0, 0)).x + (m * m)[x].y - 11.0);",
        "Named a = Named(2u, 3u), b;\nif (x < 5u) b = a;\nr = b.offset + b.raw;",
        "r = x < 5u && a_switch(int(x)) == 5u ? 5u : 7u;",
        "struct S { float W, X, F, T, f, V, fields, column; };\nS s[2];\ns[x].V = 5.0;\nr = uint(s[x].V);",
        "int v[2] = int[2](int(x) + 5, 3), u[2] = int[2](1, 2), w[2] = gl_WorkGroupID.x < 3u ? v : u;\nr = uint(w[0]);",
    };
    expect_fives(bodies);
}

// A loop that all lanes leave from inside of a branch that all take: nothing may be read there.
TEST(NativeLanes, WhoLeavesALoopReadsNothingMore) {
    EXPECT_EQ(result_and_reason("bool flag = numbers[0].x < 7u;\nuint s = 5u, k = flag ? 0x3fffffffu : 0u;\n"
                                "for (uint j = 0u; j < 5u; ++j) {\nif (flag) { if (i < 20u) break; }\ns += numbers[k].x;\n}\n"
                                "results[i] = s;"),
              std::pair(5u, std::string()));
}

TEST(NativeLanes, KnowWhatHasTwoNamesOrSharesOne) {
    const std::string bodies[] = {
        "vec3 v = vec3(float(x), 1, 5);\nv.zyx = v;\nr = uint(v.x);",
        "vec3 v = vec3(float(x), 1, 5);\nif (i < 20u) v.zyx = v;\nr = uint(v.x);",
        "Named Named = Named(x + 5u, 2u);\nr = Named.offset;",
    };
    expect_fives(bodies);
}

TEST(NativeLanes, WhatTheCompilerRefusesRunsOneByOneAndSaysWhy) {
    const TestFolder folder;
    const auto compiler = folder.write(
        "compiler",
        "#!/bin/sh\nif grep -q native/lanes \"$1\"; then echo test.glsl:7:1: error: no vectors; exit 1; fi\nexec c++ \"$@\"\n");
    std::filesystem::permissions(compiler, std::filesystem::perms::owner_all);
    setenv("CXX", compiler.c_str(), 1);
    EXPECT_EQ(result_and_reason("results[i] = 5u;"),
              std::pair(5u, compiler.string() + " does not compile its code: test.glsl:7: no vectors"));
    unsetenv("CXX");
}

}  // namespace
}  // namespace lab
