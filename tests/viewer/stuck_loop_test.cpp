// A shader with a loop that does not end: the window ends the loop, says where it is, and goes on once the file is mended.
#include "tracing/limited_loops.h"
#include "viewer_fixture.h"

namespace lab {
namespace {

const std::string head = "vec3 path_trace(Ray ray, inout uvec2 seed) {\n    vec3 radiance = vec3(0.5);\n    ";
const std::string tail = "\n    return radiance;\n}\n";
const std::string good = head + tail;

class StuckLoopTest : public ViewerTest {
  protected:
    void open_with(const std::string& text, const std::string& backend, const std::function<void(Options&)>& edit = {}) {
        write(shader_, text);
        chapter_.name = folder_.path().string();
        Options options = make_options();
        options.run.backend = backend;
        if (edit) edit(options);
        open(options);
    }
    void expect_stuck_in_line(int line) {
        wait_until("stuck", [&] { return session().is_stuck(); });
        EXPECT_NE(session().message().find("path_trace.glsl:" + std::to_string(line) + ": this loop"), std::string::npos)
            << session().message();
        EXPECT_EQ(session().samples(), 0) << "wrong samples are thrown away";
        run_frames(3);
    }
    void expect_mended() {
        write(shader_, good);
        wait_until("mended", [&] { return session().message().empty() && session().samples() >= 2; });
        const double green = saved_film("mended.exr").mean_radiance()[1];
        EXPECT_NEAR(green, 0.5, 1e-6);
    }

    const fs::path shader_ = folder_.path() / "path_trace.glsl";
};

TEST_F(StuckLoopTest, EveryKindOfLoopEndsAndTheWindowGoesOnOnceItIsMended) {
    open_with(good, "compute");
    wait_until("samples", [&] { return session().samples() >= 2; });
    struct Loop {
        std::string text;
        int line = 3;
    };
    for (const auto& [text, line] :
         {Loop{"for (;;) radiance *= 0.999;"}, Loop{"while (radiance.x >= 0.0) radiance *= 0.999;"},
          Loop{"do { radiance *= 0.999; } while (radiance.x >= 0.0);"},
          Loop{"for (;;)\n        for (int i = 0, j = 3; i < j; ++i) radiance *= 0.999;"},
          Loop{"for (;;) {\n        Hit hit;\n        if (!trace_ray(ray, NO_LIMIT, hit)) continue;\n        "
               "ray = get_ray_from_surface(get_shading_data(hit, ray.direction), -ray.direction);\n    }"},
          Loop{"\n#define FOREVER for (;;)\n    FOREVER radiance *= 0.999;", 4},
          Loop{"while (ray.direction.x > 0.1 && ray.direction.y < -0.1) radiance *= 0.999;"}}) {
        SCOPED_TRACE(text);
        write(shader_, head + text + tail);
        expect_stuck_in_line(line);
        expect_mended();
    }
}

// Paths that never end, in a chapter with a loop of its own over samples, and samples that never do.
TEST_F(StuckLoopTest, LoopsOverSamplesEnd) {
    const std::string own = "struct Path { vec3 radiance; };\n" + good +
                            "Path start_path(Ray ray) { return Path(vec3(0.5)); }\n"
                            "bool extend_path(inout Path path, inout uvec2 seed) { return ";
    const std::string loop = text_of(project_folder() / "chapters" / chapter_named("path_regeneration") / "sample_loop.glsl");
    const size_t step = loop.find("i += step;");
    ASSERT_NE(step, std::string::npos);
    write(folder_.path() / "sample_loop.glsl", loop);
    open_with(own + "false; }\n", "compute");
    wait_until("samples", [&] { return session().samples() >= 2; });
    write(shader_, own + "path.radiance.x > 0.0; }\n");
    wait_until("stuck", [&] { return session().is_stuck(); });
    EXPECT_NE(session().message().find("sample_loop.glsl:6: this loop"), std::string::npos) << session().message();
    write(shader_, own + "false; }\n");
    wait_until("mended", [&] { return session().samples() >= 2; });
    write(folder_.path() / "sample_loop.glsl", std::string(loop).replace(step, 10, ""));
    wait_until("stuck", [&] { return session().is_stuck(); });
    write(folder_.path() / "sample_loop.glsl", loop);
    wait_until("mended", [&] { return session().message().empty() && session().samples() >= 2; });
}

TEST_F(StuckLoopTest, AChosenBackendStartsWithALoopThatDoesNotEnd) {
    open_with(head + "for (;;) radiance *= 0.999;" + tail, "auto");
    expect_stuck_in_line(3);
    expect_mended();
}

TEST_F(StuckLoopTest, NativeStartsWithALoopThatDoesNotEnd) {
    open_with(head + "for (;;) radiance *= 0.999;" + tail, "native");
    expect_stuck_in_line(3);
    expect_mended();
}

TEST_F(StuckLoopTest, ThePipelineStartsWithALoopThatDoesNotEnd) {
    open_with(head + "for (;;) radiance *= 0.999;" + tail, "pipeline");
    expect_stuck_in_line(3);
    expect_mended();
}

TEST_F(StuckLoopTest, AnotherSettingIsTriedAndTheOtherHalfGoesOn) {
    open_with(head + "for (uint i = 0u; i != 3u; i += parameters.splitting_factor) radiance *= 0.999;" + tail, "compute",
              [](Options& options) { options.samples.chapter_values[0] = 1; });
    wait_until("samples", [&] { return session().samples() >= 2; });
    Options options = session().options();
    options.samples.chapter_values[0] = 2;  // steps over 3
    session().change(options);
    expect_stuck_in_line(3);
    viewer_->comparison().start(session(), chapter_named("russian_roulette"));
    wait_until("compared", [&] { return viewer_->comparison().is_active() && viewer_->comparison().second().samples() >= 4; });
    viewer_->comparison().stop();
    options.samples.chapter_values[0] = 3;
    session().change(options);
    wait_until("samples", [&] { return session().samples() >= 2; });
    EXPECT_EQ(session().message(), "");
}

// The path of a sample, which is recorded by another shader.
TEST_F(StuckLoopTest, APathThatDoesNotEndIsNotFollowed) {
    open_with(head + "uvec2 first = random_start_state(0u, 9u, parameters.seed_key);\n    get_random_numbers(first);\n    " +
                  "while (seed == first) radiance *= 0.999;" + tail,
              "compute", [](Options& options) { options.appearance.sample_count = 4; });
    wait_until("samples", [&] { return session().samples() >= 4; });
    const Inspection& inspection = viewer_->inspection_panel().inspection();
    auto& selection = const_cast<Inspection&>(inspection).selection();
    selection = Inspection::Selection{{0, 0}, 9, 0};
    wait_until("a message", [&] { return !inspection.message().empty(); });
    EXPECT_NE(inspection.message().find("path_trace.glsl:5: this loop"), std::string::npos) << inspection.message();
    selection->sample = 8;
    wait_until("a path", [&] { return inspection.path().has_value(); });
    EXPECT_EQ(inspection.message(), "");
}

}  // namespace
}  // namespace lab
