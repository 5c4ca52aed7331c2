// Loops that are ended after very many iterations: the text that is inserted, and where.
#include "tracing/limited_loops.h"

#include <gtest/gtest.h>

#include <regex>

#include "files/project_folder.h"

namespace lab {
namespace {

// Places are file and line in a number: only the line is kept.
std::string with_lines(const std::string& text) {
    std::string result;
    auto at = text.begin();
    const std::regex call(R"(is_loop_stuck\((\d+)u\))");
    for (std::sregex_iterator match(text.begin(), text.end(), call), end; match != end; ++match) {
        result.append(at, (*match)[0].first);
        result += "STUCK" + std::to_string(std::stoul((*match)[1]) % (1 << 16));
        at = (*match)[0].second;
    }
    return result.append(at, text.end());
}

void expect_limited(const std::string& text, const std::string& expected) {
    const std::string in_file = "#line 1 \"/tmp/path_trace.glsl\"\n";
    EXPECT_EQ(with_lines(limit_loops(in_file + text)), in_file + expected);
}

TEST(LimitedLoops, EndLoopsOfAllKinds) {
    expect_limited("for (;;) f();", "for (;;) if (STUCK1) break; else f();");
    expect_limited("for (int i = g(1, (2)), j = 0; i < j; ++i)\n;",
                   "for (int i = g(1, (2)), j = 0; i < j; ++i) if (STUCK1) break; else\n;");
    expect_limited("\nif (a) for (;b;) f(); else g();", "\nif (a) for (;b;) if (STUCK2) break; else f(); else g();");
    expect_limited("while (a, b) f();", "while (!STUCK1 && (a, b)) f();");
    expect_limited("while\n  (a) ;", "while\n  (!STUCK1 && (a)) ;");
    expect_limited("do f(); while (a);", "do f(); while (!STUCK1 && (a));");
    expect_limited("do while (a) f(); while (b);", "do while (!STUCK1 && (a)) f(); while (!STUCK1 && (b));");
    expect_limited("while (bool a = f()) g();", "while (bool a = f()) if (STUCK1) break; else g();");
    expect_limited("for /* ( */ (;; /* ) */ f()) // )\n{}", "for /* ( */ (;; /* ) */ f()) if (STUCK1) break; else // )\n{}");
}

TEST(LimitedLoops, EndLoopsOfMacros) {
    expect_limited("#define EVER(n) for (int i = 0; i < (n); ++i)\nEVER(2) f();",
                   "#define EVER(n) for (int i = 0; i < (n); ++i) if (STUCK1) break; else\nEVER(2) f();");
    expect_limited("#define F \\\n while (a) f();\n", "#define F \\\n while (!STUCK2 && (a)) f();\n");
}

TEST(LimitedLoops, LeaveEverythingElse) {
    for (const char* text :
         {"// for (;;)\n/* while (a) */ before(a); forth(b); a.while_(c);\n", "#if for (\nint before;\n#endif\n",
          "#define OPEN for (int i = 0;\nint a = (1);\n", "for (;;", "while"})
        expect_limited(text, text);
    const std::string shared =
        "#line 1 \"" + (project_folder() / "shaders/world/lights.glsl").generic_string() + "\"\nfor (;;) f();\n";
    EXPECT_EQ(limit_loops(shared), shared);
    EXPECT_EQ(limit_loops("for (;;) f();"), "for (;;) f();") << "the main program";
    EXPECT_EQ(with_lines(limit_loops(shared + "#line 7 \"/tmp/path_trace.glsl\"\nfor (;;);\n" + shared)),
              shared + "#line 7 \"/tmp/path_trace.glsl\"\nfor (;;) if (STUCK7) break; else;\n" + shared);
}

}  // namespace
}  // namespace lab
