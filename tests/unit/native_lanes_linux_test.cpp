// Shaders in lanes give what they give one invocation at a time: random programs of everything that may divide lanes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <random>

#include "native/module.h"
#include "parallel.h"
#include "test_files.h"

namespace lab {
namespace {

// Writes functions of unsigned integers, which wrap around in C++ as well.
class ProgramWriter {
  public:
    explicit ProgramWriter(uint32_t seed) : random_(seed) {}

    std::string function(const std::string& name, bool has_helper) {
        has_helper_ = has_helper;
        next_name_ = 0;
        variables_ = {"x", "y", "v.x", "v.y", "p.first", "p.rest.z"};
        return "uint " + name + "(uint x, inout uint y) {\nuvec2 v = uvec2(x, y);\nPair p = Pair(x + 1u, uvec3(y));\n" +
               statements(2) + "return " + value(2) + ";\n}\n";
    }

  private:
    uint32_t roll(uint32_t count) { return static_cast<uint32_t>(random_() % count); }
    std::string variable() { return variables_[roll(static_cast<uint32_t>(variables_.size()))]; }
    std::string new_name() { return "n" + std::to_string(next_name_++); }
    std::string value(int depth) {
        const auto part = [&] { return value(depth - 1); };
        switch (roll(depth > 0 ? 14 : 3)) {
            case 0:
                return std::to_string(roll(9)) + "u";
            case 1:
            case 2:
                return variable();
            case 3:
                return "(" + part() + " + " + part() + ")";
            case 4:
                return "(" + part() + " * " + part() + ")";
            case 5:
                return "(" + part() + " ^ (" + part() + " >> 3u))";
            case 6:
                return "(" + condition(depth - 1) + " ? " + part() + " : " + part() + ")";
            case 7:
                return "table[" + part() + " & 15u]";
            case 8:
                return "(" + part() + " % (" + part() + " | 1u) + uint(float(" + part() + " & 255u) * 0.25))";
            case 9:
                return "uvec3(" + part() + ", " + part() + ", 7u).zxy.y";
            case 10:
                return is_pure_ ? part() : variable() + "++";
            case 11:
                return "pairs[" + part() + " & 3u].rest.y";
            case 12:
                return "min(" + part() + ", " + part() + ")";
            default:
                return has_helper_ && !is_pure_ ? "helper(" + part() + ", " + variable() + ")" : part();
        }
    }
    std::string condition(int depth) {
        switch (roll(depth > 0 ? 6 : 3)) {
            case 0:
                return "(" + value(depth) + " & 1u) == 0u";
            case 1:
                return value(depth) + " < " + value(depth);
            case 2:
                return "uvec2(" + value(0) + ", 3u) != v";
            case 3:
                return "(" + condition(depth - 1) + " && " + condition(depth - 1) + ")";
            case 4:
                return "(" + condition(depth - 1) + " || " + condition(depth - 1) + ")";
            default:
                return "!(" + condition(depth - 1) + ")";
        }
    }
    std::string statements(int depth) {
        const size_t outer = variables_.size();
        std::string text;
        for (uint32_t i = 1 + roll(4); i > 0; --i) text += statement(depth);
        variables_.resize(outer);
        return text;
    }
    std::string loop_body(int depth) {
        ++loops_;
        const std::string text = statements(depth - 1);
        --loops_;
        return text;
    }
    std::string statement(int depth) {
        const std::string bound = roll(2) ? "(" + value(1) + " & 3u)" : "3u";
        switch (roll(depth > 0 ? 13 : 6)) {
            case 0:
                return variable() + " = " + value(2) + ";\n";
            case 1: {  // GLSL leaves it open which side comes first
                is_pure_ = true;
                const std::string text = variable() + " += " + value(1) + ";\n";
                is_pure_ = false;
                return text;
            }
            case 2:
                return roll(2) ? "v.yx = uvec2(" + value(1) + ", " + value(1) + ");\n" : "p = pairs[" + value(1) + " & 3u];\n";
            case 3:
                return "--" + variable() + ";\n";
            case 4: {
                const std::string name = new_name(), text = "uint " + name + " = " + value(2) + ";\n";
                variables_.push_back(name);
                return text;
            }
            case 5:
                return jump();
            case 6:
            case 7:
                return "if (" + condition(2) + ") {\n" + statements(depth - 1) + "}\n";
            case 8:
                return "if (" + condition(1) + ") {\n" + statements(depth - 1) + "} else {\n" + statements(depth - 1) + "}\n";
            case 9:
            case 10: {
                const std::string i = new_name();
                return "for (uint " + i + " = 0u; " + i + " < " + bound + "; ++" + i + ") {\n" + loop_body(depth) + "}\n";
            }
            case 11: {
                const std::string i = new_name();
                return "uint " + i + " = 0u;\nwhile (" + i + " < " + bound + " && " + condition(1) + ") {\n++" + i + ";\n" +
                       loop_body(depth) + "}\n";
            }
            default: {
                const std::string i = new_name();
                return "uint " + i + " = 0u;\ndo {\n++" + i + ";\n" + loop_body(depth) + "} while (" + i + " < " + bound + ");\n";
            }
        }
    }
    std::string jump() {
        const std::string guard = roll(8) ? "if (" + condition(1) + ") " : "";
        switch (roll(loops_ > 0 ? 3 : 1)) {
            case 1:
                return guard + "break;\n";
            case 2:
                return guard + "continue;\n";
            default:
                return "if (" + condition(1) + ") return " + value(1) + ";\n";
        }
    }

    std::mt19937 random_;
    std::vector<std::string> variables_;
    bool has_helper_ = false, is_pure_ = false;
    int next_name_ = 0, loops_ = 0;
};

constexpr uint32_t invocations = 13;  // in the second packet some lanes are idle
constexpr uint32_t group_count = 2;

std::string shader_of(const std::vector<uint32_t>& seeds) {
    std::string functions, calls;
    for (size_t i = 0; i < seeds.size(); ++i) {
        ProgramWriter writer(seeds[i]);
        const std::string name = std::to_string(i), helper = "helper_" + name;
        std::string text = writer.function(helper, false) + writer.function("program_" + name, true);
        for (size_t at = 0; (at = text.find("helper(", at)) != std::string::npos; at += helper.size())
            text.replace(at, 6, helper);
        functions += text;
        calls += "y = place * 7u;\nresults[" + name + "u * " + std::to_string(invocations * group_count) +
                 "u + place] = program_" + name + "(place * 2654435761u >> (place & 15u), y) ^ y;\n";
    }
    return "#line 1 \"random.glsl\"\nstruct Pair { uint first; uvec3 rest; };\n"
           "layout(scalar, set = 0, binding = 1) buffer Results { uint results[]; };\n"
           "layout(scalar, set = 0, binding = 2) readonly buffer Table { uint table[]; };\n"
           "layout(scalar, set = 0, binding = 3) readonly buffer Pairs { Pair pairs[]; };\n"
           "layout(local_size_x = " +
           std::to_string(invocations) + ") in;\n" + functions + "void main() {\nuint place = gl_GlobalInvocationID.x, y;\n" +
           calls + "}\n";
}

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
    native::run_groups(code.run, bindings, 0, group_count);
    return results;
}

// Runs 50 programs of each batch in lanes and one by one.
void expect_equal_results(uint32_t first_seed, uint32_t batch_count) {
    constexpr uint32_t count = 50;
    const auto seed_of = [&](size_t batch, size_t program) {
        return first_seed + static_cast<uint32_t>(batch * count + program);
    };
    const auto load_all = [&](native::Mode mode) {  // on all cores
        native::set_mode(mode);
        std::vector<native::Code> codes(batch_count);
        in_parallel(batch_count, 1, [&](size_t batch, size_t) {
            std::vector<uint32_t> seeds(count);
            std::iota(seeds.begin(), seeds.end(), seed_of(batch, 0));
            codes[batch] = native::load(shader_of(seeds));
        });
        native::set_mode(native::Mode::fast);
        return codes;
    };
    const std::vector<native::Code> lanes = load_all(native::Mode::fast), scalar = load_all(native::Mode::debug);
    for (size_t batch = 0; batch < batch_count; ++batch) {
        ASSERT_EQ(lanes[batch].why_one_by_one, "");
        ASSERT_NE(scalar[batch].why_one_by_one, "");
        const std::vector<uint32_t> in_lanes = run(lanes[batch], count), one_by_one = run(scalar[batch], count);
        for (size_t i = 0; i < in_lanes.size(); ++i) {
            if (in_lanes[i] != one_by_one[i]) {
                const uint32_t seed = seed_of(batch, i / (invocations * group_count));
                FAIL() << "seed " << seed << ", invocation " << i % (invocations * group_count) << ": " << in_lanes[i]
                       << " in lanes, " << one_by_one[i] << " one by one, in\n"
                       << shader_of({seed});
            }
        }
    }
}

native::Code load_main(const std::string& body) {
    return native::load(
        "#line 1 \"test.glsl\"\nlayout(scalar, set = 0, binding = 1) buffer Results { uint results[]; };"
        "layout(scalar, set = 0, binding = 3) readonly buffer Numbers { uvec4 numbers[]; };\n"
        "layout(local_size_x = 1) in;\nstruct Named { uint offset, raw; };"
        "bool set(inout bool b) { b = true; return b; } uint add(uint a, inout uint b) { b += a; return b + 3u; }"
        "uint count = 1u; uint count_up() { return ++count; } const uint two = 2u, five = 10u / two;"
        "uint late(uint a) { count = 7u; return a; } uint first(uint a, uint b) { return a; } uint ahead(); uint call_ahead() { "
        "return first(count, ahead()); } "
        "uint ahead() { return count *= 2u; }\nvoid main() {\nuint i = gl_GlobalInvocationID.x;\n" +
        body + "\n}\n");
}

// The number that a shader writes, and why it runs one by one.
std::pair<uint32_t, std::string> result_and_reason(const std::string& body) {
    const native::Code code = load_main(body);
    return {run(code, 1).front(), code.why_one_by_one};
}

TEST(NativeLanes, WhatTheyLackRunsOneByOneAndSaysWhere) {
    const std::pair<const char*, const char*> cases[] = {
        {"uint x = 2u;\nswitch (i) { case 0: x = 5u; }\nresults[i] = x;", "test.glsl:7: lanes lack 'switch'"},
        {"uint a[2];\na[0] = 3u;\na[i] = 5u;\nresults[i] = a[0];",
         "test.glsl:8: lanes lack assignments to 'a' as it is indexed here"},
        {"uint a[2], k = 0u;\na[0] = i;\na[k++] += 5u;\nresults[i] = a[0];",
         "test.glsl:8: lanes lack '+=' where the index changes a variable, too"},
        {"struct S { uint x; };\nS s = S(5u);\nresults[i] = s.x;", "test.glsl:6: lanes lack structures inside of a function"}};
    for (const auto& [body, reason] : cases) EXPECT_EQ(result_and_reason(body), std::pair(5u, std::string(reason)));
    const auto [result, reason] =
        result_and_reason("const bool table[2] = bool[2](true, false);\nresults[i] = table[i] ? 5u : 7u;");
    EXPECT_EQ(result, 5u);
    EXPECT_NE(reason.find("lanes lack bools in memory"), std::string::npos) << reason;
    // Names are free, even those of what lanes are made of.
    EXPECT_EQ(result_and_reason("Named a = Named(2u, 3u), b;\nif (i < 5u) b = a;\nresults[i] = b.offset + b.raw;"),
              std::pair(5u, std::string()));
}

TEST(NativeLanes, KnowFunctionsOfVectorsAndMatrices) {
    EXPECT_EQ(result_and_reason("vec2 n = vec2(0, 1);\nresults[i] = uint(transpose(mat2(1.0, 2.0, 3.0, float(i)))[0].y - "
                                "faceforward(n, vec2(float(i), 1.0), n).y - refract(vec2(float(i), -1.0), n, 1.0).y + "
                                "determinant(mat2(1.0)) - 1.0);"),
              std::pair(5u, std::string()));
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
        "r = 4u + call_ahead();",
        "int n = 2147483647 + int(gl_WorkGroupID.x);\nr = n + 1 > n ? 7u : 5u;",
        "mat3 m = mat3(2.0);\nm[0][0] = float(x);\nmat4 n = mat4(m);\nr = uint(n[0][0] + n[2][2] + 3.0 * n[3][3] + n[3][0]);",
        "uint n = gl_WorkGroupID.x;\nr = i > 5u && n > 0u && numbers[(n - 1u) * 40000000u].x > 0u ? 7u : 5u;",
        "const Named table[2] = Named[2](Named(5u, 2u), Named(7u, 3u));\nr = table[i].offset;",
    };
    expect_fives(bodies);
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
        "#!/bin/sh\nif grep -q lane_ \"$1\"; then echo test.glsl:7:1: error: no vectors; exit 1; fi\nexec c++ \"$@\"\n");
    std::filesystem::permissions(compiler, std::filesystem::perms::owner_all);
    setenv("CXX", compiler.c_str(), 1);
    EXPECT_EQ(result_and_reason("results[i] = 5u;"),
              std::pair(5u, compiler.string() + " does not compile its code: test.glsl:7: no vectors"));
    unsetenv("CXX");
}

TEST(NativeLanes, RandomProgramsGiveWhatTheyGiveOneByOne) { expect_equal_results(0, 1); }
TEST(NativeLanes, TenThousandRandomProgramsGiveWhatTheyGiveOneByOne_all) { expect_equal_results(1000, 200); }

}  // namespace
}  // namespace lab
