// Shaders as C++, in lanes and one by one, give what the device gives: random programs of everything that may divide lanes.
#include <numeric>
#include <random>

#include "files/file.h"
#include "native/module.h"
#include "parallel.h"
#include "support/gpu_test.h"
#include "support/temporary_folder.h"

namespace lab {
namespace {

// Writes functions of unsigned integers, which wrap around in C++ as well.
class ProgramWriter {
  public:
    explicit ProgramWriter(uint32_t seed) : random_(seed) {}

    std::string function(const std::string& name, bool has_helper) {
        has_helper_ = has_helper;
        next_name_ = 0;
        variables_ = {"x", "y", "v.x", "v.y", "p.first", "p.rest.z", "list[1]", "q[1].rest.x", "global"};
        return "uint " + name + "(uint x, inout uint y) {\nuvec2 v = uvec2(x, y);\nPair p = Pair(x + 1u, uvec3(y));\n" +
               "uint list[4] = uint[](x, 2u, y, 7u);\nPair q[2] = Pair[](p, Pair(y, uvec3(3u, x, 5u)));\nbool flag = x < y;\n" +
               statements(2) + "return " + value(2) + ";\n}\n";
    }

  private:
    uint32_t roll(uint32_t count) { return static_cast<uint32_t>(random_() % count); }
    std::string variable() { return variables_[roll(static_cast<uint32_t>(variables_.size()))]; }
    std::string new_name() { return "n" + std::to_string(next_name_++); }
    std::string value(int depth) {
        const auto part = [&] { return value(depth - 1); };
        switch (roll(depth > 0 ? 21 : 3)) {
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
            case 13:
                return "list[" + part() + " & 3u]";
            case 14:
                return "q[" + part() + " & 1u].rest[" + part() + " % 3u]";
            case 15:
                return "uint(int(" + part() + ") >> (" + part() + " & 31u))";
            case 16:
                return "(" + part() + " << int(" + part() + " & 31u))";
            case 17:
                return "bitfieldInsert(" + part() + ", " + part() + ", int(" + part() + " & 15u), int(" + part() + " & 15u))";
            case 18:
                return "uint(bitfieldExtract(int(" + part() + "), int(" + part() + " & 15u), 9) + findMSB(int(" + part() + ")))";
            case 19:
                return "uint(int(" + part() + ") / (int(" + part() + " & 63u) + 1) + bitCount(" + part() + "))";
            default:
                return has_helper_ && !is_pure_ ? "helper(" + part() + ", " + variable() + ")" : part();
        }
    }
    std::string condition(int depth) {
        switch (roll(depth > 0 ? 8 : 4)) {
            case 0:
                return "(" + value(depth) + " & 1u) == 0u";
            case 1:
                return value(depth) + " < " + value(depth);
            case 2:
                return "uvec2(" + value(0) + ", 3u) != v";
            case 3:
                return "flag";
            case 4:
                return "(" + condition(depth - 1) + " && " + condition(depth - 1) + ")";
            case 5:
                return "(" + condition(depth - 1) + " || " + condition(depth - 1) + ")";
            case 6:
                return "(" + value(depth - 1) + " < 9u ? flag : " + condition(depth - 1) + ")";
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
        switch (roll(depth > 0 ? 16 : 8)) {
            case 0:
                return variable() + " = " + value(2) + ";\n";
            case 1: {  // GLSL leaves it open which side comes first
                is_pure_ = true;
                const std::string text = variable() + " += " + value(1) + ";\n";
                is_pure_ = false;
                return text;
            }
            case 2:
                return swizzle();
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
                return element();
            case 7:
                return "flag = " + condition(2) + ";\n";
            case 8:
            case 9:
                return "if (" + condition(2) + ") {\n" + statements(depth - 1) + "}\n";
            case 10:
                return "if (" + condition(1) + ") {\n" + statements(depth - 1) + "} else {\n" + statements(depth - 1) + "}\n";
            case 11:
            case 12: {
                const std::string i = new_name();
                return "for (uint " + i + " = 0u; " + i + " < " + bound + "; ++" + i + ") {\n" + loop_body(depth) + "}\n";
            }
            case 13:
                return cases(depth);
            case 14: {
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
    std::string cases(int depth) {  // the default may be in the middle, and cases may go on with the next one
        std::string text = "switch (" + value(1) + " & 3u) {\n";
        const uint32_t last = roll(5);
        for (uint32_t i = 0; i < 4; ++i) {
            text += (i == last ? "default:\n" : "case " + std::to_string(i) + "u:\n") + statements(depth - 1);
            if (roll(2)) text += "break;\n";
        }
        return text + "}\n";
    }
    std::string element() {  // of arrays and of vectors, in each lane another one
        const std::string at = "[" + value(1) + " & 1u]";
        switch (roll(6)) {
            case 0:
                return "list" + at + " = " + value(1) + ";\n";
            case 1:
                return "q" + at + ".rest.zx = v;\n";
            case 2:
                return "q" + at + " = p;\n";
            case 3:
                return "v" + at + "++;\n";
            case 4:
                return "swap(list" + at + ", q" + at + ".rest.y);\n";
            default:
                return "--p.rest;\n";
        }
    }
    std::string swizzle() {  // or all of a structure
        switch (roll(4)) {
            case 0:
                return "v.yx = uvec2(" + value(1) + ", " + value(1) + ");\n";
            case 1:
                return "v.yx = v;\n";
            case 2:
                return "p.rest.zxy = p.rest;\n";
            default:
                return "p = pairs[" + value(1) + " & 3u];\n";
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

constexpr uint32_t invocations = 29;  // in the last packet some lanes are idle
constexpr uint32_t group_count = 2;
constexpr uint32_t program_count = 10;  // of a shader

std::string shader_of(const std::vector<uint32_t>& seeds) {
    std::string functions, calls;
    for (size_t i = 0; i < seeds.size(); ++i) {
        ProgramWriter writer(seeds[i]);
        const std::string name = std::to_string(i), helper = "helper_" + name;
        std::string text = writer.function(helper, false) + writer.function("program_" + name, true);
        for (size_t at = 0; (at = text.find("helper(", at)) != std::string::npos; at += helper.size())
            text.replace(at, 6, helper);
        functions += text;
        calls += "global = y = place * 7u;\nresults[" + name + "u * " + std::to_string(invocations * group_count) +
                 "u + place] = program_" + name + "(place * 2654435761u >> (place & 15u), y) ^ y;\n";
    }
    return "#version 460\n#extension GL_EXT_scalar_block_layout : require\n#line 1 \"test.glsl\"\n"
           "struct Pair { uint first; uvec3 rest; };\n"
           "layout(scalar, set = 0, binding = 1) buffer Results { uint results[]; };\n"
           "layout(scalar, set = 0, binding = 2) readonly buffer Table { uint table[]; };\n"
           "layout(scalar, set = 0, binding = 3) readonly buffer Pairs { Pair pairs[]; };\n"
           "layout(local_size_x = " +
           std::to_string(invocations) +
           ") in;\nuint global;\nvoid swap(inout uint a, inout uint b) {\nuint c = a;\na = b;\nb = c;\n++global;\n}\n" +
           functions + "void main() {\nuint place = gl_GlobalInvocationID.x, y;\n" + calls + "}\n";
}

std::vector<uint32_t> table() {
    std::vector<uint32_t> numbers(16);
    for (uint32_t i = 0; i < 16; ++i) numbers[i] = i * i * 40503u;
    return numbers;
}

// Each shader gives count numbers an invocation.
std::vector<uint32_t> run_natively(const native::Code& code, uint32_t count) {
    std::vector<uint32_t> results(count * invocations * group_count), numbers = table();
    native::Bindings bindings{};
    const auto bind = [&](size_t index, std::vector<uint32_t>& words) {
        bindings.ranges[index] = {reinterpret_cast<std::byte*>(words.data()), words.size() * sizeof(uint32_t)};
    };
    bind(1, results);
    bind(2, numbers);
    bind(3, numbers);  // four pairs
    native::run_groups(code.run, bindings, group_count);
    return results;
}

std::vector<uint32_t> run_on_device(const ShaderSource& source, uint32_t count) {
    std::vector<uint32_t> results(count * invocations * group_count);
    Buffer result_buffer(test_device(), results.size() * sizeof(uint32_t), vk::BufferUsageFlagBits::eStorageBuffer);
    const std::vector<uint32_t> words = table();
    const Buffer numbers(test_device(), std::span(words), vk::BufferUsageFlagBits::eStorageBuffer);
    const std::vector<Binding> bindings{storage_binding(1, result_buffer), storage_binding(2, numbers),
                                        storage_binding(3, numbers)};
    const ComputeKernel kernel(test_device(), source, bindings, 0);
    test_device().submit([&](const vk::raii::CommandBuffer& commands) { kernel.record(commands, nullptr, group_count); });
    result_buffer.read(results.data(), results.size() * sizeof(uint32_t));
    return results;
}

// Compares programs on the device with the same programs in lanes, in eight lanes as CPUs without AVX-512 have them, and one by
// one.
void expect_equal_results(uint32_t first_seed, uint32_t shader_count) {
    const TemporaryFolder folder;
    const auto seed_of = [&](size_t shader, size_t program) {
        return first_seed + static_cast<uint32_t>(shader * program_count + program);
    };
    std::vector<ShaderSource> sources(shader_count);
    for (size_t i = 0; i < shader_count; ++i) {
        std::vector<uint32_t> seeds(program_count);
        std::iota(seeds.begin(), seeds.end(), seed_of(i, 0));
        sources[i].file = folder.path() / (std::to_string(i) + ".comp");
        write_file(sources[i].file, shader_of(seeds));
    }
    const auto load_all = [&](native::Mode mode) {  // on all cores
        native::set_mode(mode);
        std::vector<native::Code> codes(shader_count);
        in_parallel(shader_count, 1, [&](size_t i, size_t) { codes[i] = native::load(compile_shader(sources[i], true)); });
        native::set_mode(native::Mode::fast);
        return codes;
    };
    const std::vector<native::Code> lanes = load_all(native::Mode::fast), scalar = load_all(native::Mode::debug);
    setenv("LAB_LANES", "8", 1);
    const std::vector<native::Code> eight = load_all(native::Mode::fast);
    unsetenv("LAB_LANES");
    for (size_t shader = 0; shader < shader_count; ++shader) {
        ASSERT_EQ(lanes[shader].why_one_by_one, "");
        ASSERT_EQ(eight[shader].invocations_at_once, 8);
        ASSERT_EQ(scalar[shader].invocations_at_once, 1);
        const std::vector<uint32_t> expected = run_on_device(sources[shader], program_count);
        for (const auto& [code, how] : {std::pair(lanes[shader], "in lanes"), std::pair(eight[shader], "in eight lanes"),
                                        std::pair(scalar[shader], "one by one")}) {
            const std::vector<uint32_t> results = run_natively(code, program_count);
            const auto wrong = std::mismatch(results.begin(), results.end(), expected.begin());
            if (wrong.first == results.end()) continue;
            const auto i = static_cast<size_t>(wrong.first - results.begin());
            const uint32_t seed = seed_of(shader, i / (invocations * group_count));
            FAIL() << "seed " << seed << ", invocation " << i % (invocations * group_count) << ": " << *wrong.first << " " << how
                   << ", " << *wrong.second << " on the device, in\n"
                   << shader_of({seed});
        }
    }
}

// GLSL leaves the order open in which products are added, and native follows lavapipe's.
TEST(NativePrograms, AddInTheDevicesOrder) {
    const TemporaryFolder folder;
    ShaderSource source{.file = folder.path() / "sums.comp"};
    const std::vector<std::string> sums{"distance(a.x, b.x)", "dot(a, x2())", "dot(b, x3())", "dot(c, x4())", "length(c)",
                                        "(m * a).x",          "(n * b).x",    "(o * c).x",    "(a * m).x",    "(b * n).x",
                                        "(c * o).x",          "(m * m)[0].x", "(n * n)[0].x", "(o * o)[0].x"};
    std::string statements;
    for (size_t i = 0; i < sums.size(); ++i)
        statements += "results[" + std::to_string(i * invocations * group_count) +
                      "u + gl_GlobalInvocationID.x] = floatBitsToUint(" + sums[i] + ");\n";
    write_file(source.file,
               "#version 460\n#extension GL_EXT_scalar_block_layout : require\n"
               "layout(scalar, set = 0, binding = 1) buffer Results { uint results[]; };\n"
               "layout(scalar, set = 0, binding = 2) readonly buffer Table { uint table[]; };\n"
               "layout(local_size_x = " +
                   std::to_string(invocations) +
                   ") in;\nuint next = 0u;\n"
                   "float x() { uint i = next++; return (i % 3u == 0u ? -1.0 : 1.0) * float(1u + i + (table[i & 15u] ^ "
                   "gl_GlobalInvocationID.x)); }\n"
                   "vec2 x2() { float a = x(); return vec2(a, x()); }\nvec3 x3() { vec2 a = x2(); return vec3(a, x()); }\n"
                   "vec4 x4() { vec2 a = x2(); return vec4(a, x2()); }\n"
                   "void main() {\nvec2 a = x2(); vec3 b = x3(); vec4 c = x4();\nmat2 m = mat2(x2(), x2()); "
                   "mat3 n = mat3(x3(), x3(), x3()); mat4 o = mat4(x4(), x4(), x4(), x4());\n" +
                   statements + "}\n");
    const auto count = static_cast<uint32_t>(sums.size());
    const std::vector<uint32_t> expected = run_on_device(source, count);
    for (const native::Mode mode : {native::Mode::fast, native::Mode::debug}) {
        native::set_mode(mode);
        const std::vector<uint32_t> results = run_natively(native::load(compile_shader(source, true)), count);
        for (size_t i = 0; i < results.size(); ++i)
            ASSERT_EQ(results[i], expected[i])
                << "number " << i / (invocations * group_count) << ", mode " << static_cast<int>(mode);
    }
    native::set_mode(native::Mode::fast);
}

TEST(NativePrograms, GiveWhatTheDeviceGives) { expect_equal_results(test_seed(0), 1); }

// Ten thousand programs, in tests that two cores end in time.
class ThousandNativePrograms : public testing::TestWithParam<uint32_t> {};
TEST_P(ThousandNativePrograms, GiveWhatTheDeviceGives) { expect_equal_results(test_seed(1000 * GetParam()), 100); }
INSTANTIATE_TEST_SUITE_P(Seeds, ThousandNativePrograms, testing::Range(1u, 11u),
                         [](const auto& info) { return instance_name(std::to_string(info.param), Run::with_all); });

}  // namespace
}  // namespace lab
