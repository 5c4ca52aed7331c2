#include <gtest/gtest.h>

#include "scene/warnings.h"
#include "test_files.h"

namespace lab {
namespace {

class PrecisionWarnings : public testing::Test {
  protected:
    // The warnings of a scene file with a tetrahedron of size 1 and these keys.
    std::vector<std::string> warnings(const std::string& placement, const std::string& keys = "") const {
        folder_.write("a.mtl", "newmtl m\nKd 1 1 1\nKe 1 1 1\n");
        folder_.write("a.obj",
                      "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                      "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n");
        return load_scene(
                   folder_.write("s.json", R"({"meshes": [{"file": "a.obj")" + placement + "}]" + keys + "}"))
            .warnings;
    }

  private:
    TestFolder folder_;
};

TEST_F(PrecisionWarnings, TellHowFarFromTheOriginASceneIs) {
    EXPECT_TRUE(warnings("").empty());
    EXPECT_TRUE(warnings(R"(, "translation": [1000, 1000, 0])").empty());
    // 8 · 2^-24 (20000 + 1) over the diagonal √3.
    const auto far = warnings(R"(, "translation": [20000, 0, 0])");
    ASSERT_EQ(far.size(), 1u);
    EXPECT_NE(far.front().find("blur 0.55 % of its size"), std::string::npos) << far.front();
    EXPECT_NE(far.front().find("s.json"), std::string::npos);
    // What counts is the distance compared with the size.
    EXPECT_TRUE(warnings(R"(, "scale": 1000, "translation": [20000, 0, 0])").empty());
    EXPECT_EQ(warnings(R"(, "scale": 1e-5, "translation": [1, 0, 0])").size(), 1u);
}

TEST_F(PrecisionWarnings, TellHowNarrowAFieldOfViewIs) {
    const auto with_fov = [&](const std::string& degrees, int height) {
        return warnings(
            "", R"(, "height": )" + std::to_string(height) +
                    R"(, "camera": {"position": [0, 0, 5], "target": [0, 0, 0], "vertical_fov": )" + degrees +
                    "}");
    };
    EXPECT_TRUE(with_fov("0.1", 512).empty());
    EXPECT_TRUE(with_fov("0.0001", 1).empty());
    const auto narrow = with_fov("0.001", 512);
    ASSERT_EQ(narrow.size(), 1u);
    EXPECT_NE(narrow.front().find("rounded to 1.7 of a pixel"), std::string::npos) << narrow.front();
}

}  // namespace
}  // namespace lab
