// Shaders as C++: compiled and run, the translator's output gives the numbers that GLSL defines.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <future>

#include "error.h"
#include "native/module.h"
#include "native/translator.h"
#include "native_shader.h"

namespace lab {
namespace {

// The numbers that a shader writes to results[]. `code` precedes main(), `body` is inside.
std::vector<float> run_shader(const std::string& code, const std::string& body, native::Texture* texture = nullptr) {
    const std::string glsl =
        code +
        "\nlayout(scalar, set = 0, binding = 1) buffer Results { float results[]; };\n"
        "layout(local_size_x = 1) in;\nint next = 0;\nvoid give(float x) { results[next++] = x; }\nvoid main() {\n" +
        body + "\n}\n";
    std::vector<float> results(16, -1000);
    native::Bindings bindings{};
    bindings.ranges[1] = {reinterpret_cast<std::byte*>(results.data()), results.size() * sizeof(float)};
    bindings.ranges[2] = {reinterpret_cast<std::byte*>(texture), sizeof(native::Texture)};
    native::run_groups(native::load(compile_glsl(glsl)).run, bindings, 1);
    while (!results.empty() && results.back() == -1000) results.pop_back();
    return results;
}

using Numbers = std::vector<float>;

TEST(Native, SwizzlesReadAndWrite) {
    EXPECT_EQ(run_shader(
                  "",
                  "vec4 v = vec4(1, 2, 3, 4); v.zx = v.xy; v.yw += 10.0; v.xy = v.yx; give(v.x); give(v.y); give(v.z); give(v.w);"
                  "give(v.wzyx.xy.x); give(v.rgb.b); vec2 t = v.st; give(t.t); mat3 m = mat3(2.0); m[1].zx = vec2(5, 6); "
                  "give(m[1].x);"),
              (Numbers{12, 2, 1, 14, 14, 1, 2, 6}));
    EXPECT_EQ(run_shader("struct Pair { float st; vec2 xy; };", "Pair p = Pair(3.0, vec2(4, 5)); give(p.st); give(p.xy.y);"),
              (Numbers{3, 5}));
    // The source may be the target.
    EXPECT_EQ(run_shader("",
                         "vec3 v = vec3(1, 2, 3); v.bgr = v; give(v.x); give(v.y); give(v.z);"
                         "mat2 m = mat2(1, 2, 3, 4); m[1].yx = m[1]; give(m[1].x); give(m[1].y);"),
              (Numbers{3, 2, 1, 4, 3}));
}

TEST(Native, NamesAndNumbersMayBeThoseOfCpp) {
    EXPECT_EQ(
        run_shader("float and_eq = 1.0, char8_t = 2.0, static_assert = 3.0, new = 4.0, new_ = 5.0, new__ = 6.0, errno = 7.0;",
                   "give(and_eq); give(char8_t); give(static_assert); give(new); give(new_); give(new__); give(errno);"),
        (Numbers{1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(run_shader("", "int lowest = -2147483648; give(lowest < 0 ? 1.0 : 2.0); give(float(uint(2147483648) >> 31));"),
              (Numbers{1, 1}));
}

TEST(Native, NamesMayBeThoseThatTheTranslationUses) {
    EXPECT_EQ(
        run_shader(
            "struct Array { float x; };\nstruct Shader { float y; };\nstruct Values { float local_size, get; };\n"
            "float lanes = 1.0, glm = 2.0, std = 3.0, native = 4.0, each = 5.0;\nfloat copied(float x) { return x; }\n"
            "float get(float x) { return 2.0 * x; }\nfloat make_array(float x) { return 3.0 * x; }\n"
            "float swizzle(vec2 x) { return x.y; }",
            "give(lanes + glm + std + native + each); give(copied(6.0)); give(get(4.0)); give(make_array(3.0));"
            "vec2 v = vec2(1, 7); give(swizzle(v.xy)); give(Array(8.0).x + Shader(9.0).y); float Span = 5.0;"
            "give(Values(1.0, Span).get); float scalar = float(uint(3.5)); give(scalar); float swizzled[2] = float[2](1, 2);"
            "v.yx = vec2(swizzled[1], 0); give(v.y); float get_array = 4.0; give(get_array);"),
        (Numbers{15, 6, 8, 9, 7, 17, 5, 3, 2, 4}));
    EXPECT_EQ(run_shader("", "float active__ = 1.0, lab__ = 2.0, x__ = float(next); if (active__ > x__) give(active__ + lab__);"),
              Numbers{3});
}

TEST(Native, FunctionsMayHaveAnyName) {
    EXPECT_EQ(
        run_shader("float Shader(float x) { return x; } float native_scale(float x) { return 2.0 * x; }\n"
                   "float offsetof(float x) { return 3.0 * x; } float Builtins(float x) { return 4.0 * x; }\n"
                   "float INFINITY(float x) { return 5.0 * x; }",
                   "give(Shader(1.0)); give(native_scale(1.0)); give(offsetof(1.0)); give(Builtins(1.0)); give(INFINITY(1.0));"
                   "float M_PIf32 = 6.0, defined = 7.0; give(M_PIf32); give(defined);"),
        (Numbers{1, 2, 3, 4, 5, 6, 7}));
}

TEST(Native, BitsOfNegativeNumbersAreThoseOfTheirWords) {
    EXPECT_EQ(run_shader("",
                         "int x = -2; give(float(bitfieldReverse(x))); ivec2 v = bitfieldReverse(ivec2(-1, 1));"
                         "give(float(v.x)); give(v.y < 0 ? 1.0 : 0.0); give(float(bitfieldInsert(-1, 0, 1, 2)));"
                         "give(float(bitfieldInsert(0, -1, 0, 32)));"),
              (Numbers{0x1p31f, -1, 1, -7, -1}));
}

TEST(Native, OutArgumentsAreCopiedInAndOut) {
    const char* const code =
        "float held = 1.0;\n"
        "void add(inout float x, float y) { x += y; x += held; }\n"
        "void halve(inout vec2 v) { v *= 0.5; }\n"
        "void both(inout float a, inout float b) { a += 1.0; b += a; }\n"
        "float split(float x, out float rest) { rest = fract(x); return floor(x); }";
    // The global keeps its value until the call returns: 1 + 2 + 1.
    EXPECT_EQ(run_shader(code, "add(held, 2.0); give(held);"), (Numbers{4}));
    EXPECT_EQ(run_shader(code, "vec3 v = vec3(2, 4, 8); halve(v.zx); give(v.x); give(v.y); give(v.z);"), (Numbers{1, 4, 4}));
    // Neither parameter sees the other one's changes: 1 + 1 or 1 + 2, but not 4.
    const Numbers alias = run_shader(code, "float x = 1.0; both(x, x); give(x);");
    EXPECT_TRUE(alias == Numbers{2} || alias == Numbers{3}) << alias.front();
    EXPECT_EQ(run_shader(code,
                         "float r; give(split(2.75, r)); give(r); uint high, low; umulExtended(0x80000000u, 6u, high, low);"
                         "give(float(high)); give(float(low)); vec2 v; v.y = modf(3.25, v.x); give(v.x); give(v.y);"),
              (Numbers{2, 0.75, 3, 0, 3, 0.25}));
}

TEST(Native, OperandsAreEvaluatedFromLeftToRight) {
    const char* const code =
        "float draw(inout uint seed) { seed += 1u; return float(seed); }\nvec2 pair(float a, float b) { return vec2(a, b); }";
    EXPECT_EQ(run_shader(code,
                         "uint s = 0u; vec2 v = vec2(draw(s), draw(s)); give(v.x); give(v.y); give(draw(s) - 2.0 * draw(s));"
                         "vec2 w = pair(draw(s), draw(s)); give(w.x); give(w.y); give(pair(float(s), draw(s)).x);"),
              (Numbers{1, 2, 3 - 2 * 4, 5, 6, 6}));
    EXPECT_EQ(run_shader(code, "uint s = 0u; float x = false && draw(s) > 0.0 ? draw(s) : 7.0; give(x); give(float(s));"),
              (Numbers{7, 0}));
}

TEST(Native, ArraysAreValues) {
    EXPECT_EQ(run_shader("const float TABLE[3] = float[3](1.0, 2.0, 4.0);\nfloat[2] twice(float[2] a) { a[0] *= 2.0; return a; }",
                         "float a[2] = float[](3.0, 5.0); float b[2] = twice(a); give(a[0]); give(b[0]); give(float(a.length()));"
                         "give(TABLE[2]); vec3 c[2] = {vec3(1), vec3(2)}; give(c[1].y); float[2] d = a, e = b; give(float(d == "
                         "a)); give(float(d == e));"
                         "float m[2][3]; m[1][2] = 9.0; give(m[1][2]); give(float(m.length()) + float(m[0].length()));"),
              (Numbers{3, 6, 2, 4, 2, 1, 0, 9, 5}));
}

TEST(Native, FunctionsMayReturnNewArrays) {
    EXPECT_EQ(run_shader("float[2] pair(float x) { return float[2](x, -x); }", "give(pair(3.0)[1]);"), (Numbers{-3}));
}

TEST(Native, VectorsAreShiftedByNumbersOfAnotherType) {
    EXPECT_EQ(run_shader("",
                         "uvec2 u = uvec2(8, 16); ivec2 i = ivec2(-8, 1); give((u >> 1).y); give((i << 2u).y); give((i >> 1u).x);"
                         "give((u << ivec2(1, 2)).y); i <<= 1u; give(i.y);"),
              (Numbers{8, 4, -4, 64, 2}));
}

TEST(Native, NumbersAreNormalized) { EXPECT_EQ(run_shader("", "give(normalize(-3.0)); give(normalize(2));"), (Numbers{-1, 1})); }

TEST(Native, NumbersAreConverted) {
    EXPECT_EQ(run_shader("",
                         "uvec2 u = uvec2(3, 4); vec2 v = u; give(v.y); give((u * 0.5).x); give((2 * u).y); give(max(v.x, 1)); "
                         "give(vec3(true).z);"
                         "give(float(uint(-1) >> 31)); give(mix(vec2(1), vec2(2), lessThan(v, vec2(3.5))).x); give(clamp(5, 0, "
                         "2)); give(float(vec2(6, 7)));"
                         "give(1e1 + .5 + 2.); give(pow(2, 3)); give(float(0xffu));"),
              (Numbers{4, 1.5, 8, 3, 1, 1, 2, 2, 6, 12.5, 8, 255}));
}

TEST(Native, KnowsTheFunctionsOfGlsl) {
    EXPECT_EQ(
        run_shader(
            "",
            "give(float(any(not(bvec2(true, false))))); give(smoothstep(0.0, 1.0, 0.5)); give((mat2(1, 2, 3, 4) * vec2(1, 1)).x);"
            "give(float(findMSB(8u))); give(float(bitCount(7u))); give(float(bitfieldReverse(1u) >> 31u)); "
            "give(transpose(mat2(1, 2, 3, 4))[0].y);"
            "give(determinant(mat2(1, 2, 3, 4))); give(uintBitsToFloat(floatBitsToUint(1.5))); give(fma(2.0, 3.0, 4.0)); "
            "give(sign(-3.0));"
            "give(length(vec2(3, 4))); give(float(true ^^ true)); give(atan(0.0, 1.0)); give(inversesqrt(4.0)); give(mod(-1.0, "
            "4.0));"),
        (Numbers{1, 0.5, 4, 3, 3, 1, 3, -2, 1.5, 10, -1, 5, 0, 0, 0.5, 3}));
}

TEST(Native, NamesMayBeThoseOfFunctionsAndOfCpp) {
    EXPECT_EQ(run_shader("float area(float x) { return 2.0 * x; }\nfloat floor(int x) { return 1.0; }",
                         "float distance = distance(vec2(0), vec2(3, 4)); give(distance); float area = area(3.0), new = 1.0, "
                         "class_ = 2.0; give(area); give(new + class_);"
                         "float NAN = 4.0; give(NAN); give(floor(2.5)); give(floor(2));"),
              (Numbers{5, 6, 3, 4, 2, 1}));
}

TEST(Native, VariablesMayHaveTheNameOfAStructure) {
    EXPECT_EQ(
        run_shader("struct Pair { float x, y; };\nstruct Both { Pair Pair; float Late; } ;\nstruct Late { float z; };\n"
                   "float sum(Pair Pair, Pair other) { return Pair.x + other.y; }",
                   "give(sum(Pair(1.0, 2.0), Pair(3.0, 4.0))); Both b = Both(Pair(5.0, 6.0), 7.0); give(b.Pair.y); give(b.Late);"
                   "{ Pair Pair = Pair(8.0, 9.0), other = Pair; Pair.x += 2.0; give(Pair.x + other.y);"
                   "  { float Pair = Pair.y; give(-(Pair)); } }"
                   "for (int Pair = 0; Pair < 1; ++Pair) give(float(Pair)); Pair p = Pair(3.0, 4.0); give(p.x);"
                   "{ float Inner = 2.0; { struct Inner { float w; }; Inner i = Inner(5.0); give(i.w); } give(Inner); }"),
        (Numbers{5, 6, 7, 19, -9, 0, 3, 5, 2}));
}

TEST(Native, StatementsAreThoseOfGlsl) {
    EXPECT_EQ(run_shader("float f(int i);\nfloat g(int i) { return f(i) + 1.0; }\nfloat f(int i) { switch (i) { case 0: return "
                         "5.0; case 1: default: break; } return 7.0; }",
                         "give(g(0)); give(g(1)); int n = 0; do { ++n; if (n == 2) continue; } while (n < 4); give(float(n)); "
                         "while (n > 0) n -= 3; give(float(n));"
                         "float sum = 0.0; for (int i = 0, j = 5; i < j; ++i, --j) sum += 1.0; give(sum); struct S { float a, "
                         "b[2]; }; S s = S(1.0, float[2](2.0, 3.0)); give(s.b[1]);"
                         "give(float(s == S(1.0, float[2](2.0, 3.0)))); { float a = 1.0, b = 2.0; a = b = 3.0; give(a); }"),
              (Numbers{6, 8, 4, -2, 3, 3, 1, 3}));
}

TEST(Native, BlocksMayHaveNamesAndHeaders) {
    EXPECT_EQ(
        run_shader("layout(scalar, set = 0, binding = 2) readonly buffer Block { uint count; vec2 size; float rest[]; } block;\n",
                   "give(7.0);"),
        Numbers{7});
    EXPECT_EQ(run_shader("layout(scalar, set = 0, binding = 1) buffer Block { float first; } block;\n"
                         "float raise() { return block.first += 4.0; }",
                         "block.first = 2.0; give(raise() - 2.0);"),
              Numbers{4});
}

TEST(Native, WhatItDoesNotKnowIsOneClearMessage) {
    for (const auto& [glsl, message] : std::initializer_list<std::pair<const char*, const char*>>{
             {"layout(std140, binding = 1) buffer Block { float list[2]; };\nvoid main() { list[0] = 1.0; }",
              "test.glsl:2: the backend native does not know a layout of memory other than layout(scalar)"},
             {"layout(scalar, binding = 1, row_major) buffer Block { mat3 m; };\nvoid main() { m[0] = vec3(1.0); }",
              "a layout of memory other than layout(scalar)"},
             {"layout(constant_id = 3) const int N = 4;\nconst int M = N * 2;\nlayout(scalar, binding = 1) buffer Block { int x; "
              "};\n"
              "void main() { x = M; }",
              "constants that are computed from specialisation constants"},
             {"layout(local_size_x = 8, local_size_y = 8) in;\nvoid main() {}",
              "test.glsl:2: the backend native does not know workgroups of more than one dimension"},
             {"shared float x;\nvoid main() { x = 1.0; }", "test.glsl:2: the backend native does not know shared variables"},
             {"void main() {\n\nbarrier(); }", "test.glsl:3: the backend native does not know a function of this line"},
             {"layout(constant_id = 3) const int N = 4;\nlayout(scalar, binding = 1) buffer Block { int x; };\n"
              "void main() { int list[N * 2]; list[x] = 1; x = list[0]; }",
              "constants that are computed from specialisation constants"},
             {"uniform layout(binding = 2) texture3D t;\nlayout(scalar, binding = 1) buffer Block { float x; };\n"
              "void main() { x = texelFetch(t, ivec3(0), 0).x; }",
              "images of another kind than texture2D"},
             {"uniform layout(binding = 2) texture2D t;\nlayout(scalar, binding = 1) buffer Block { int x; };\n"
              "void main() {\n x = int(texelFetch(t, ivec2(0), x).x); }",
              "test.glsl:4: the backend native does not know another level of an image than 0"},
             {"uniform layout(binding = 2) texture2D t;\nlayout(scalar, binding = 1) buffer Block { int x; };\n"
              "void main() {\n x = textureSize(t, 1).x; }",
              "test.glsl:4: the backend native does not know another level of an image than 0"},
             {"layout(scalar, binding = 1) volatile buffer Block { float x; };\nvoid main() { x = 1.0; }",
              "the qualifier 21 of 'Block'"},
             {"layout(scalar, set = 1, binding = 1) buffer Block { float x; };\nvoid main() { x = 1.0; }",
              "the descriptor set of"},
             {"layout(scalar, binding = 64) buffer Block { float x; };\nvoid main() { x = 1.0; }", "the binding of"},
             {"#extension GL_EXT_debug_printf : require\nvoid main() {\ndebugPrintfEXT(\"hello\"); }",
              "test.glsl:3: the backend native does not know a function of NonSemantic.DebugPrintf"},
             {"layout(scalar, binding = 1) buffer Block { float x; };\nvoid main() { double y = x; x = float(y * y); }",
              "test.glsl:2: the backend native does not know numbers of other than 32 bits"}}) {
        for (const bool for_lanes : {false, true}) {
            try {
                native::translate(compile_glsl(glsl), for_lanes);
                ADD_FAILURE() << glsl;
            } catch (const UserError& error) {
                EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
                EXPECT_NE(std::string(error.what()).find("--backend compute"), std::string::npos) << error.what();
            }
        }
    }
}

TEST(Native, ACopyOfAShaderHasItsOwnLines) {
    const TestFolder folder;
    for (const char* name : {"first.comp", "second.comp"}) {
        const auto file = folder.write(name, "#version 460\nshared float x;\nvoid main() { x = 1.0; }\n");
        try {
            native::translate(compile_shader({.file = file}, true), false);
            ADD_FAILURE();
        } catch (const UserError& error) {
            EXPECT_EQ(std::string(error.what()).find(file.generic_string() + ":3: "), 0u) << error.what();
        }
    }
}

TEST(Native, DeepNestingIsNoCrash) {
    const auto repeat = [](const std::string& text, int count) {
        std::string all;
        while (count-- > 0) all += text;
        return all;
    };
    const auto nested = [&](const std::string& open, const std::string& middle, const std::string& close, int depth) {
        return repeat(open, depth) + middle + repeat(close, depth);
    };
    EXPECT_EQ(run_shader("", "give(" + nested("(", "7.0", ")", 200) + ");" + nested("{", "give(8.0);", "}", 200) +
                                 "float x = 2.0; give(" + nested("abs(", "x", ")", 200) + ");" +
                                 nested("if (x > 1.0) {", "give(9.0);", "}", 200)),
              (Numbers{7, 8, 2, 9}));
    const std::vector<uint32_t> deep = compile_glsl("layout(scalar, binding = 1) buffer Block { float x; };\nvoid main() {\n" +
                                                    nested("if (x > 1.0) {", "x = 2.0;", "}", 300) + "\n}");
    for (const bool for_lanes : {false, true}) {
        try {
            native::translate(deep, for_lanes);
            ADD_FAILURE();
        } catch (const UserError& error) {
            EXPECT_EQ(std::string(error.what()).find("test.glsl:3: more than 256 levels of blocks"), 0u) << error.what();
        }
    }
}

// What the error of a shader says that is checked.
std::string failure_of(const std::string& body) {
    native::set_mode(native::Mode::checked);
    std::string message;
    try {
        run_shader("", body);
    } catch (const DeviceFailure& failure) {
        message = failure.what();
    }
    native::set_mode(native::Mode::fast);
    return message;
}

TEST(Native, CheckedShadersNameTheLineOfAWrongIndex) {
    EXPECT_EQ(failure_of("float a[4];\nfor (int i = 0; i < 4; ++i) a[i] = 1.0;\ngive(a[next + 4]);"),
              "test.glsl:9: index 4 of an array of 4 elements");
    for (const char* access : {"vec3 v = vec3(1.0);\ngive(v[next + 3]);", "vec3 v;\nv[next + 3] = 1.0; give(v.x);",
                               "vec3 v = vec3(1.0); mat3 m = mat3(1.0);\ngive((m[next + 3] + v).x);",
                               "mat2x3 m = mat2x3(1.0);\nm[0][next + 3] = 1.0; give(m[0].x);"})
        EXPECT_EQ(failure_of(access), "test.glsl:8: index 3 of an array of 3 elements") << access;
}

TEST(Native, TexelsAreReadWhereTheyAre) {
    const float texels[] = {1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4};
    native::Texture texture{texels, 2, 2, true};
    const auto read = [&](const std::string& position) {
        return run_shader("layout(set = 0, binding = 2) uniform texture2D t;", "\ngive(" + position + ".x);", &texture);
    };
    EXPECT_EQ(read("texelFetch(t, ivec2(next, 1), 0)"), Numbers{3});
    EXPECT_EQ(read("texelFetchOffset(t, ivec2(next, 1), 0, ivec2(1, -1))"), Numbers{2});
    native::set_mode(native::Mode::checked);
    for (const char* outside : {"texelFetch(t, ivec2(next, 2), 0)", "texelFetchOffset(t, ivec2(next, 1), 0, ivec2(0, 1))"}) {
        try {
            read(outside);
            ADD_FAILURE() << outside;
        } catch (const DeviceFailure& failure) {
            EXPECT_STREQ(failure.what(), "test.glsl:8: texel 0,2 of an image of 2 x 2");
        }
    }
    native::set_mode(native::Mode::fast);
}

TEST(Native, CheckedShadersNameTheLineOfADivisionByZero) {
    EXPECT_EQ(failure_of("int zero = next;\ngive(float(7 / zero));"), "test.glsl:8: a division by 0");
    EXPECT_EQ(failure_of("int zero = next;\ngive((ivec2(7) % zero).x);"), "test.glsl:8: a division by 0");
}

TEST(Native, DivisionsByZeroDoNotEndTheProgram) {
    EXPECT_EQ(run_shader("", "int zero = next;\nint x = 7 / zero + (-7) % zero; give(float(x - x + 3));"), Numbers{3});
}

TEST(Native, ACrashIsAnErrorAndNotTheEndOfTheProgram) {
    EXPECT_THROW(run_shader("", "give(results[100000000 + next]);"), DeviceFailure);
    EXPECT_EQ(run_shader("", "give(1.0);"), Numbers{1});
}

// As the two halves of a comparison do after an edit.
TEST(Native, ThreadsThatWantTheSameShaderAllGetIt) {
    const TestFolder cache;
    setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
    std::vector<std::future<Numbers>> threads(4);
    for (auto& thread : threads) thread = std::async(std::launch::async, [] { return run_shader("", "give(42.0);"); });
    for (auto& thread : threads) EXPECT_NO_THROW(EXPECT_EQ(thread.get(), Numbers{42}));
    unsetenv("XDG_CACHE_HOME");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache.path()))
        EXPECT_EQ(entry.path().extension(), "") << "left behind";
}

}  // namespace
}  // namespace lab
