// The panels that look inside the render: live verdict, path at a pixel, overlays.
#include <thread>

#include "files/project_folder.h"
#include "viewer/comparison_panel.h"
#include "viewer_fixture.h"

namespace lab {
namespace {

class InspectionTest : public ViewerTest {
  protected:
    const Inspection& inspection() const { return viewer_->inspection_panel().inspection(); }
    void wait_for_verdict() {
        wait_until("a verdict", [&] { return session().latest_verdict() != nullptr; });
    }
    void wait_for_full_size() {
        wait_until("full size", [&] { return session().reduction() == 1 && session().samples() >= 1; });
    }
    // Opens a chapter with a shipped scene in a small picture, and waits for its first sample.
    void open_small(const std::string& chapter, const char* scene, uvec2 size) {
        chapter_ = load_chapter(chapter_named(chapter));
        Options options = make_options();
        options.scene.file = scenes / scene;
        options.image.width = size.x;
        options.image.height = size.y;
        open(options);
        wait_for_full_size();
    }
    // Pixels of the last screenshot for whose red, green and blue, each up to 255, is_counted() is true.
    template <typename IsCounted>
    size_t count_pixels(const IsCounted& is_counted) {
        const std::vector<uint8_t>& pixels = viewer_->screen().captured().pixels;
        size_t count = 0;
        for (size_t i = 0; i < pixels.size(); i += 4) count += is_counted(pixels[i], pixels[i + 1], pixels[i + 2]);
        return count;
    }
};

TEST_F(InspectionTest, TheVerdictFollowsTheShader_all) {
    // A private chapter, so that the sources stay untouched.
    const fs::path shader = folder_.path() / "path_trace.glsl";
    const std::string good = text_of(project_folder() / "chapters" / chapter_.name / "path_trace.glsl");
    const std::string mistaken_line = "throughput /= survival_probability;";
    const size_t at = good.find(mistaken_line);
    ASSERT_NE(at, std::string::npos);
    write(shader, good);
    chapter_.name = folder_.path().string();
    open(options_with_reference());
    wait_for_verdict();
    EXPECT_FALSE(session().latest_verdict()->is_biased) << session().verdict_text();

    EXPECT_EQ(session().verdict_state(), VerdictState::agrees);

    // While the shader does not compile, the previous one is rendered.
    write(shader, "x" + good);
    wait_until("an error", [&] { return !session().message().empty(); });
    EXPECT_EQ(session().verdict_state(), VerdictState::outdated);
    EXPECT_EQ(session().verdict_text().find("before the mistake: agrees"), 0u) << session().verdict_text();
    write(shader, good);
    wait_until("no error", [&] { return session().message().empty(); });
    EXPECT_EQ(session().verdict_state(), VerdictState::agrees);

    write(shader, std::string(good).erase(at, mistaken_line.size()));
    wait_until("biased", [&] { return session().latest_verdict() && session().latest_verdict()->is_biased; });
    EXPECT_LT(session().latest_verdict()->differences[1].value, 0);
    EXPECT_EQ(session().verdict_state(), VerdictState::biased);
    // Where it is too dark the tiles are blue.
    hold(GLFW_KEY_T);
    take_screenshot("viewer_biased");
    const auto blue_pixels = [&] {
        const Texture& shown = viewer_->screen().captured();
        size_t count = 0;  // in a part of the picture
        for (uint32_t y = 0; y < shown.height; ++y)
            for (uint32_t x = 360; x < 550; ++x) {
                const uint8_t* pixel = &shown.pixels[4 * (size_t{y} * shown.width + x)];
                count += pixel[2] > pixel[0] + 40;
            }
        return count;
    };
    EXPECT_GT(blue_pixels(), 1000u);
    for (const char* tiles : {"percent", "noise", "samples", "none"}) {
        hold(GLFW_KEY_T);
        take_screenshot(std::string("viewer_tiles_") + tiles);
        if (std::string(tiles) == "percent") {
            EXPECT_GT(blue_pixels(), 1000u);
        }
    }
    EXPECT_LT(blue_pixels(), 10u);

    write(shader, good);
    wait_until("unbiased", [&] { return session().latest_verdict() && !session().latest_verdict()->is_biased; });
}

TEST_F(InspectionTest, WhereThereIsNoReferenceItSaysWhy_all) {
    open(options_with_reference());
    wait_for_verdict();
    hold(GLFW_KEY_W, 2);
    wait_for_full_size();
    EXPECT_EQ(session().verdict(), nullptr);
    EXPECT_EQ(session().verdict_text(), "no verdict: the camera has changed");
    EXPECT_TRUE(session().has_moved());

    hold(GLFW_KEY_F);
    EXPECT_FALSE(session().has_moved());
    wait_for_verdict();
}

TEST_F(InspectionTest, AClickFollowsAPathAndADragDoesNot_all) {
    open(options_with_reference());
    wait_for_full_size();
    drag({500, 400}, {520, 400});
    EXPECT_FALSE(inspection().selection());
    click(500, 450);
    ASSERT_TRUE(inspection().selection());
    wait_until("a path", [&] { return inspection().path().has_value() && inspection().has_hemisphere(); });
    const RecordedPath path = *inspection().path();
    ASSERT_FALSE(path.vertices.empty());
    EXPECT_EQ(path.vertices.front().origin, session().camera().position);

    // The recorded path is the sample that the render has added.
    Options options = session().options();
    options.appearance.sample_count = 1;
    session().change(options);
    session().restart();
    run_frames(1);
    wait_until("one sample", [&] { return session().reduction() == 1 && session().samples() == 1; });
    wait_until("a path", [&] { return inspection().path().has_value(); });
    const uvec2 pixel = inspection().selection()->pixel;
    EXPECT_EQ(saved_film("one.exr").pixels[pixel.y * 128 + pixel.x].sum, inspection().path()->radiance);
    options.appearance.sample_count.reset();
    session().change(options);
    wait_until("many samples", [&] { return session().samples() >= 8 && inspection().has_hemisphere(); });
    wait_until("the hemisphere", [&] { return inspection().hemisphere().samples() >= 2; });
}

// The camera ray of a lens starts at a point of its aperture; focused, it meets the pinhole's ray where it hits.
TEST_F(InspectionTest, AClickedPointCanBeFocused_all) {
    chapter_ = load_chapter(chapter_named("lens"));
    Options options = make_options();
    options.scene.file = scenes / "focus.json";
    options.image.width = 180;
    options.image.height = 120;
    open(options, {900, 1000});
    wait_for_full_size();
    click(630, 524);  // a ball
    wait_until("a path", [&] { return inspection().path().has_value() && inspection().path()->vertices.front().is_hit; });
    take_screenshot("viewer_lens");
    const CameraPose before = session().camera();
    const PathVertex first = inspection().path()->vertices.front();
    EXPECT_NE(first.origin, before.position);
    EXPECT_LE(glm::distance(first.origin, before.position), 0.5001f * before.aperture_diameter);

    session().focus_on(first.position);
    run_frames(1);
    EXPECT_NE(session().camera().focus_distance, before.focus_distance);
    wait_for_full_size();
    wait_until("a path", [&] { return inspection().path().has_value(); });
    take_screenshot("viewer_focused");
    const Camera& camera = inspection().parameters().camera;
    EXPECT_NEAR(glm::dot(inspection().path()->vertices.front().position - before.position, camera.forward), camera.focus_distance,
                0.05f * camera.focus_distance);

    const float focused = session().camera().focus_distance;
    const vec2 field = viewer_->controls().focus_field();
    drag(field, field + vec2(30, 0));
    EXPECT_GT(session().camera().focus_distance, 1.1f * focused);
}

// A point in fog has no surface to look from.
TEST_F(InspectionTest, CollisionsInFogAreGreen_all) {
    open_small("media", "fog.json", {96, 64});
    size_t paths_with_green = 0;
    for (float x = 500; x < 800; x += 30) {
        click(x, 200);
        wait_until("a path", [&] { return inspection().path().has_value(); });
        const auto& vertices = inspection().path()->vertices;
        EXPECT_NE(vertices.front().is_collision, inspection().has_hemisphere());
        take_screenshot("viewer_fog");
        const size_t green = count_pixels([](int r, int g, int b) { return r == 120 && g == 255 && b == 120; });
        paths_with_green += green > 20;
        if (std::ranges::none_of(vertices, &PathVertex::is_collision)) {
            EXPECT_EQ(green, 0u);
        }
    }
    EXPECT_GT(paths_with_green, 2u);
}

// The nodes above the lamp of a light sample are green, and only if it was chosen by the tree.
TEST_F(InspectionTest, TheBranchOfALightSampleIsShown_all) {
    chapter_ = load_chapter(chapter_named("many_lights"));
    Options options = make_options();
    options.scene.file = scenes / "heart_light.json";
    options.light.max_path_length = 2;
    const auto green_pixels = [&](const char* screenshot) {
        wait_until("a path", [&] { return inspection().path().has_value() && !inspection().path()->vertices.empty(); });
        take_screenshot(screenshot);
        return count_pixels([](int r, int g, int b) { return g > r + 60 && g > b + 60; });
    };
    open(options);
    wait_for_full_size();
    click(640, 500);  // the floor
    const size_t by_tree = green_pixels("viewer_branch");
    const auto& lights = inspection().path()->vertices.front().light_samples;
    ASSERT_EQ(lights.size(), 1u);
    ASSERT_GE(lights[0].branch.size(), 4u);
    const Sphere& lamp = lights[0].branch.back();
    EXPECT_LE(glm::distance(lamp.centre, *lights[0].point), 1.001f * lamp.radius);
    EXPECT_LT(lamp.radius, 0.1f * lights[0].branch.front().radius);

    options.estimator.choices["--light-choice"] = 1;
    session().change(options);
    run_frames(1);
    wait_until("by power", [&] { return !session().is_building() && session().samples() >= 1; });
    const size_t by_power = green_pixels("viewer_branch_by_power");
    EXPECT_GT(by_tree, by_power + 300);
    for (const PathVertex& vertex : inspection().path()->vertices)
        for (const LightSample& light : vertex.light_samples) EXPECT_TRUE(light.branch.empty());
}

// The path from the lamp that belongs to the same sample.
TEST_F(InspectionTest, LightPathsAreOrange_all) {
    open_small("light_paths", "caustics.json", {90, 60});
    size_t most = 0;
    for (const float x : {500.0f, 560.0f, 640.0f, 720.0f}) {
        click(x, 300);
        wait_until("a path", [&] { return inspection().path().has_value() && !inspection().path()->light_path.empty(); });
        take_screenshot("viewer_light_path");
        most = std::max(most, count_pixels([](int r, int g, int b) { return r == 255 && g == 140 && b == 40; }));
    }
    EXPECT_GT(most, 50u);
}

TEST_F(InspectionTest, PathAndHemisphereFollowTheOptionsThatTheShaderIsCompiledFor_all) {
    chapter_ = load_chapter(chapter_named("multiple_importance_sampling"));
    Options options = options_with_reference();
    options.appearance.sample_count = 1;
    open(options);
    Inspection inspection(*device_);
    inspection.select({64, 100});
    vec3 before(0);
    const auto expect_the_sample_of_the_render = [&](const char* what) {
        session().change(options);
        run_frames(1);
        wait_until(what, [&] {
            inspection.update(session(), 0.01);
            return !session().is_building() && session().samples() == 1 && inspection.has_hemisphere();
        });
        const uvec2 pixel = inspection.selection()->pixel;
        const vec3 rendered = saved_film("one.exr").pixels[pixel.y * 128 + pixel.x].sum;
        EXPECT_EQ(rendered, inspection.path()->radiance) << what;
        EXPECT_NE(rendered, before) << what;
        before = rendered;
    };
    expect_the_sample_of_the_render("both strategies");
    options.estimator.strategy = Strategy::light;
    expect_the_sample_of_the_render("light samples");
    options.light.background = vec3(1);
    expect_the_sample_of_the_render("a background");
}

TEST_F(InspectionTest, TwoChaptersBesideEachOtherShowTheSameImage_all) {
    open(options_with_reference());
    Comparison& comparison = viewer_->comparison();
    comparison.start(session(), chapter_named("next_event_estimation"));
    comparison.equal = Equal::samples;
    wait_until("both", [&] { return comparison.is_active(); });
    EXPECT_EQ(comparison.message(), "");
    EXPECT_EQ(half_label(session(), comparison.second()), "05 russian roulette");
    EXPECT_EQ(half_label(comparison.second(), session()), "03 next event estimation");
    wait_until("samples", [&] { return comparison.second().samples() >= 32 && session().samples() >= 32; });
    EXPECT_NEAR(session().samples(), comparison.second().samples(), 4);
    const auto difference = comparison.difference(session());
    ASSERT_TRUE(difference);
    EXPECT_LT(difference->standard_error, 0.01);
    EXPECT_LT(std::abs(difference->z()), 5) << difference->value;
    ASSERT_TRUE(comparison.speedup(session()));

    // The second render follows the camera, and equal time means equal time.
    comparison.equal = Equal::time;
    CameraPose pose = session().camera();
    pose.position.z += 1;
    session().set_camera(pose);
    run_frames(1);
    wait_until("time", [&] { return session().reduction() == 1 && session().seconds() > 1; });
    EXPECT_EQ(comparison.second().camera().position, pose.position);
    EXPECT_NEAR(comparison.second().seconds(), session().seconds(), 0.6);
    comparison.stop();
    run_frames(2);
    EXPECT_FALSE(session().waits);
}

TEST_F(InspectionTest, AClickFollowsAPathOfTheRenderThatIsShownThere) {
    open(options_with_reference());
    Comparison& comparison = viewer_->comparison();
    comparison.start(session(), chapter_named("uniform_sampling"));
    wait_until("both", [&] { return comparison.is_active() && session().samples() >= 1 && comparison.second().samples() >= 1; });
    const auto takes_light_samples = [&](float x) {
        click(x, 300);
        run_frames(1);
        wait_until("a path", [&] { return inspection().path().has_value() && !inspection().is_building(); });
        const auto& vertices = inspection().path()->vertices;
        return std::any_of(vertices.begin(), vertices.end(),
                           [](const PathVertex& vertex) { return !vertex.light_samples.empty(); });
    };
    EXPECT_TRUE(takes_light_samples(500));
    EXPECT_FALSE(takes_light_samples(760));
    EXPECT_TRUE(takes_light_samples(500));
    click(760, 300);
    comparison.stop();
    wait_until("the path of the render that is left", [&] { return inspection().path().has_value(); });
}

TEST_F(InspectionTest, AChapterThatCannotRenderTheSceneIsRefused) {
    Options options = make_options();
    options.scene.file = scenes / "glass.json";
    chapter_ = load_chapter(chapter_named("dielectrics"));
    open(options);
    viewer_->comparison().start(session(), chapter_named("next_event_estimation"));
    wait_until("refused", [&] { return !viewer_->comparison().message().empty(); });
    EXPECT_NE(viewer_->comparison().message().find("dielectric"), std::string::npos);
    EXPECT_FALSE(viewer_->comparison().is_active());
    viewer_->comparison().start(session(), chapter_named("dielectrics"));
    wait_until("both", [&] { return viewer_->comparison().is_active(); });
}

// At common screen sizes.
TEST_F(InspectionTest, NothingLiesOnThePictureWhileAPathIsShown_all) {
    open(options_with_reference(), {900, 700});
    // A point of the picture, 0 to 1, in pointer coordinates.
    const auto point_of_picture = [&](const vec2& position) {
        const Rectangle where = viewer_->picture_rectangle();
        return vec2(where.corner) + position * vec2(where.size - 1);
    };
    const vec2 floor = point_of_picture({0.4f, 0.85f});
    wait_for_full_size();
    click(floor.x, floor.y);
    wait_until("the hemisphere", [&] { return inspection().has_hemisphere() && inspection().hemisphere().samples() >= 2; });
    const auto resize = [&](const uvec2& size) {
        glfwSetWindowSize(window_->handle(), static_cast<int>(size.x), static_cast<int>(size.y));
        wait_until("resized", [&] { return viewer_->screen().size() == size; });
        run_frames(2);
    };
    resize({320, 240});  // cramped, but the window works
    for (const uvec2 size : {uvec2(900, 700), uvec2(1280, 800)}) {
        resize(size);
        take_screenshot("viewer_path_" + std::to_string(size.x));
        const Rectangle where = viewer_->picture_rectangle();
        EXPECT_GE(std::min(where.size.x, where.size.y), size.y / 2);
        for (const vec2 position : {vec2(0), vec2(1, 0), vec2(0.5f), vec2(0, 1), vec2(1)}) {
            const vec2 point = point_of_picture(position);
            point_at(point.x, point.y);
            run_frames(2);
            EXPECT_FALSE(ImGui::GetIO().WantCaptureMouse) << size.x << ": at " << position.x << ", " << position.y;
        }
    }
}

}  // namespace
}  // namespace lab
