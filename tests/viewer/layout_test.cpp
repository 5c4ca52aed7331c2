// What is where in the window, at the sizes that screens have.
#include "viewer_fixture.h"

namespace lab {
namespace {

TEST_F(ViewerTest, NothingLiesOnThePictureWhileAPathIsShown_all) {
    open(options_with_reference(), {900, 700});
    const Inspection& inspection = viewer_->inside_panel().inspection();
    // A point of the picture, 0 to 1, as the pointer has it.
    const auto point_of_picture = [&](const vec2& position) {
        const Rectangle where = viewer_->picture_rectangle();
        return vec2(where.corner) + position * vec2(where.size - 1);
    };
    const vec2 floor = point_of_picture({0.4f, 0.85f});
    wait_until("full size", [&] { return session().reduction() == 1 && session().samples() >= 1; });
    click(floor.x, floor.y);
    wait_until("the hemisphere",
               [&] { return inspection.has_hemisphere() && inspection.hemisphere().samples() >= 2; });
    const auto resize = [&](const uvec2& size) {
        glfwSetWindowSize(window_->handle(), static_cast<int>(size.x), static_cast<int>(size.y));
        wait_until("resized", [&] { return viewer_->screen().size() == size; });
        run_frames(2);
    };
    resize({320, 240});  // little room, but the window works
    for (const uvec2 size : {uvec2(900, 700), uvec2(1280, 800)}) {
        resize(size);
        take_screenshot("viewer_path_" + std::to_string(size.x));
        const Rectangle where = viewer_->picture_rectangle();
        EXPECT_GE(std::min(where.size.x, where.size.y), size.y / 2);
        for (const vec2 position : {vec2(0), vec2(1, 0), vec2(0.5f), vec2(0, 1), vec2(1)}) {
            const vec2 point = point_of_picture(position);
            point_at(point.x, point.y);
            run_frames(2);
            EXPECT_FALSE(ImGui::GetIO().WantCaptureMouse)
                << size.x << ": at " << position.x << ", " << position.y;
        }
    }
}

TEST_F(ViewerTest, StepsThroughTheSamplesHoweverLongTheirNumbersAre) {
    write(folder_.path() / "path_trace.glsl",
          "vec3 path_trace(Ray ray, inout uvec2 seed) { return vec3(1.2345e-6, 2.3456e-6, 3.4567e-6); }\n");
    chapter_ = {.name = folder_.path().string(), .title = "Constant"};
    open(make_options(), {900, 700});
    const Rectangle picture = viewer_->picture_rectangle();
    const InsidePanel& panel = viewer_->inside_panel();
    click(static_cast<float>(picture.corner.x + 20), static_cast<float>(picture.corner.y + 20));
    wait_until("a path", [&] { return panel.inspection().path().has_value(); });
    run_frames(3);
    for (const uint32_t sample : {1u, 2u, 3u}) {
        const vec2 button = panel.next_sample_button();
        click(button.x, button.y);
        ASSERT_TRUE(panel.inspection().selection());
        EXPECT_EQ(panel.inspection().selection()->sample, sample);
    }
}

}  // namespace
}  // namespace lab
