// The window: what it shows, saves and does in response to input.
#include <thread>

#include "error.h"
#include "files/project_folder.h"
#include "viewer_fixture.h"

namespace lab {
namespace {

TEST_F(ViewerTest, SavesWhatARunWithoutAWindowSaves) {
    Options options = make_options();
    options.appearance.sample_count = 24;
    options.samples.seed = 7;
    open(options);
    // Nothing that happens in between may matter in the end.
    glfwSetWindowSize(window_->handle(), 1000, 500);
    hold(GLFW_KEY_W, 3);
    session().change(options);
    wait_until("all samples", [&] { return session().samples() >= 24 && session().reduction() == 1; });
    const fs::path saved = folder_.path() / "window.exr", expected = folder_.path() / "headless.exr";
    session().save({saved});

    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / chapter_.name;
    const std::string command = program.string() +
                                " cornell_box --headless --quiet --backend=compute --width=48 --height=40 --seed=7 "
                                "--samples=24 --output=" +
                                expected.string();
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    const FilmFile a = read_film(saved), b = read_film(expected);
    ASSERT_EQ(a.image.pixels.size(), b.image.pixels.size());
    EXPECT_EQ(std::memcmp(a.image.pixels.data(), b.image.pixels.data(), a.image.pixels.size() * sizeof(FilmPixel)), 0);
    EXPECT_NO_THROW(require_same_render(a, b, "window", "headless"));
    EXPECT_EQ(a.header.backend, b.header.backend);
    EXPECT_EQ(a.header.estimator_hash, b.header.estimator_hash);
    EXPECT_EQ(a.header.rays, b.header.rays);
}

TEST_F(ViewerTest, KeysMoveTheCameraAndRestartWithinAFrame) {
    Options options = make_options();
    options.image.width = options.image.height = 512;  // too large to finish while the camera moves
    open(options);
    wait_until("samples", [&] { return session().samples() > 0.2; });
    const vec3 before = session().camera().position;
    press(GLFW_KEY_W);
    run_frames(1);
    EXPECT_NE(session().camera().position, before);
    const bool is_slow = device_->description().kind == "CPU";
    EXPECT_GE(session().reduction(), is_slow ? 2u : 1u) << "the picture of a moving camera has to be reduced";
    EXPECT_EQ(session().build().renderer->film().width(), 512 / session().reduction());
    const auto start = Clock::now();
    run_frames(20);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    RecordProperty("frames_per_second_while_moving", std::to_string(20 / seconds));
    EXPECT_GE(session().reduction(), is_slow ? 2u : 1u);
    press(GLFW_KEY_W, false);
    wait_until("full size", [&] { return session().reduction() == 1 && session().samples() > 0; });
    EXPECT_EQ(session().build().renderer->film().width(), 512u);
}

TEST_F(ViewerTest, DraggingThePictureTurnsTheCameraButDraggingTheControlsDoesNot) {
    open(make_options());
    const vec3 before = session().camera().target;
    drag({600, 300}, {700, 300});
    const vec3 turned = session().camera().target;
    EXPECT_GT(glm::distance(turned, before), 0.1f);
    drag({100, 20}, {250, 20});  // the title bar of the controls
    EXPECT_EQ(session().camera().target, turned);
}

TEST_F(ViewerTest, TypingIntoAFieldDoesNotMoveTheCamera) {
    open(make_options());
    const CameraPose before = session().camera();
    EXPECT_FALSE(ImGui::GetIO().WantTextInput) << "no field has the focus at first";
    click_until([&] { return viewer_->controls().seed_field(); }, [] { return ImGui::GetIO().WantTextInput; });
    hold(GLFW_KEY_W, 3);
    run_frames(1);
    EXPECT_EQ(session().camera().position, before.position);
    click(650, 300);
    hold(GLFW_KEY_W, 3);
    EXPECT_NE(session().camera().position, before.position) << "a click beside the field gives the keys back";
}

TEST_F(ViewerTest, ANarrowWindowHasTheControlsBelowThePicture) {
    open(make_options());
    for (const uvec2 size : {uvec2(400, 600), uvec2(599, 500), uvec2(600, 500), uvec2(1280, 720)}) {
        glfwSetWindowSize(window_->handle(), static_cast<int>(size.x), static_cast<int>(size.y));
        wait_until("resized", [&] { return viewer_->screen().size() == size; });
        const Rectangle picture = viewer_->picture_rectangle(), controls = viewer_->controls_rectangle();
        const bool is_below = picture.corner.y + picture.size.y <= controls.corner.y;
        EXPECT_EQ(is_below, size.x < 600);
        EXPECT_TRUE(is_below || picture.corner.x >= controls.corner.x + controls.size.x) << size.x;
        EXPECT_GE(picture.size.x * picture.size.y, 30000) << "too small to be seen";
        EXPECT_GE(controls.size.x, controls.corner.x + 360);
        // What is there can be clicked.
        const vec2 middle = vec2(picture.corner) + 0.5f * vec2(picture.size);
        click(middle.x, middle.y);
        EXPECT_TRUE(viewer_->inspection_panel().inspection().selection());
        const Rectangle path = viewer_->path_rectangle();
        EXPECT_GE(path.size.x, 200);
        EXPECT_LE(viewer_->picture_rectangle().corner.y + viewer_->picture_rectangle().size.y, path.corner.y);
        take_screenshot("viewer_" + std::to_string(size.x));
        const_cast<Inspection&>(viewer_->inspection_panel().inspection()).deselect();
        run_frames(1);
    }
}

TEST_F(ViewerTest, LobesAreShownAsOnWhereTheSceneHasThem) {
    Options options = make_options();
    open(options);
    // Check marks are blue.
    const auto is_checked = [&] {
        take_screenshot("viewer_lobes");
        const Texture& shown = viewer_->screen().captured();
        const uvec2 at(viewer_->controls().lobes_box());
        size_t blue = 0;
        for (uint32_t y = at.y - 4; y < at.y + 4; ++y)
            for (uint32_t x = at.x - 4; x < at.x + 4; ++x) blue += shown.pixels[4 * (size_t{y} * shown.width + x) + 2] > 150;
        return blue > 2;
    };
    const auto box = [&] { return viewer_->controls().lobes_box(); };
    const auto switch_lobes = [&](bool on) {
        click_until(box, [&] { return session().options().scene.specular == on; });
        finish_build();
    };
    wait_until("samples", [&] { return session().samples() >= 1 && session().reduction() == 1; });
    EXPECT_FALSE(is_checked());
    switch_lobes(true);
    EXPECT_TRUE(is_checked());
    switch_lobes(false);

    session().open_scene(scenes / "glossy.json");
    finish_build();
    wait_until("samples", [&] { return session().samples() >= 1 && session().reduction() == 1; });
    EXPECT_TRUE(is_checked());
    click_at_rest(box);
    finish_build();
    EXPECT_FALSE(session().options().scene.specular) << "the scene's own lobes cannot be switched";
    EXPECT_TRUE(is_checked());
}

TEST_F(ViewerTest, AButtonSetsWhatTheReferenceHas_all) {
    Options options = make_options();
    options.scene.file = scenes / "plates.json";
    options.image.width = 300;
    options.image.height = 200;
    open(options);
    wait_until("why not", [&] { return session().settings_for_verdict().has_value(); });
    EXPECT_EQ(session().verdict(), nullptr);
    session().change_for_verdict();
    finish_build();
    wait_until("a verdict", [&] { return session().latest_verdict() != nullptr; });
    EXPECT_FALSE(session().settings_for_verdict());
    EXPECT_EQ(session().build().job.parameters.image_size, uvec2(288, 192));
    hold(GLFW_KEY_W, 2);
    wait_until("full size", [&] { return session().reduction() == 1 && session().samples() >= 1; });
    EXPECT_FALSE(session().settings_for_verdict()) << "the camera has changed";
}

TEST_F(ViewerTest, EveryOptionTakesEffect) {
    open(make_options());
    const auto parameters = [&] { return session().build().job.parameters; };
    const auto change = [&](const std::function<void(Options&)>& edit) {
        Options options = session().options();
        edit(options);
        session().change(options);
        finish_build();
        run_frames(1);
        EXPECT_EQ(session().message(), "");
        return saved_film("option.exr").mean_radiance()[1];
    };
    for (size_t i = 0; i < chapter_.options.size(); ++i) {
        const RenderParameters before = parameters();
        change([&](Options& options) { options.samples.chapter_values[i] = chapter_.options[i].low; });
        EXPECT_NE(std::memcmp(&before, &session().build().job.parameters, sizeof before), 0) << chapter_.options[i].name;
        EXPECT_NE(session().build().job.header.settings.find(chapter_.options[i].name), std::string::npos);
    }
    change([](Options& options) { options.samples.chapter_values.assign(3, std::nullopt); });
    change([](Options& options) { options.samples.seed = 99; });
    EXPECT_EQ(parameters().seed_key, seed_key(99));
    const double all = change([](Options& options) { options.light.max_path_length = 4; });
    const double one = change([](Options& options) { options.light.only_path_length = 2; });
    EXPECT_EQ(parameters().only_path_length, 2);
    EXPECT_LT(one, all);
    change([](Options& options) { options.light.only_path_length.reset(); });
    change([](Options& options) { options.estimator.strategy = Strategy::bounces; });
    EXPECT_NE(session().build().job.header.settings.find("--strategy bounces"), std::string::npos);
    const double black_sky = change([](Options& options) { options.estimator.strategy.reset(), options.scene.specular = true; });
    const double sky = change([](Options& options) { options.light.background = {1, 2, 3}; });
    EXPECT_EQ(parameters().background, vec3(1, 2, 3));
    EXPECT_GT(sky, 1.2 * black_sky);
    change([](Options& options) { options.image.width = 33; });
    EXPECT_EQ(session().build().display->picture().width(), 33u);
    for (const View& view : views()) {
        change([&](Options& options) { options.image.view = &view; });
        EXPECT_EQ(session().build().job.options.image.view, &view);
    }
    change([](Options& options) { options.image.view = nullptr; });
}

TEST_F(ViewerTest, EveryChoiceTakesEffect) {
    chapter_ = load_chapter(chapter_named("microfacets"));
    Options options = make_options();
    options.scene.file = scenes / "microfacets.json";
    open(options);
    for (const ChapterChoice& choice : chapter_.choices)
        for (size_t i = 0; i < choice.values.size(); ++i) {
            options = session().options();
            options.estimator.choices[choice.name] = i;
            session().change(options);
            finish_build();
            EXPECT_EQ(session().message(), "");
            const auto& job = session().build().job;
            const std::string said = choice.name + " " + choice.values[i].first,
                              define = choice.define() + " " + choice.values[i].second;
            EXPECT_EQ(job.header.settings.find(said) != std::string::npos, i > 0) << said;
            EXPECT_EQ(std::ranges::count(job.estimator.defines, define), i > 0) << define;
        }
}

TEST_F(ViewerTest, ScenesDroppedInAreShownAndBadOnesAreRefused) {
    open(make_options());
    drop(scenes / "furnace.json");
    finish_build();
    EXPECT_EQ(session().build().job.scene->file.stem(), "furnace");
    EXPECT_EQ(session().camera().position, session().build().job.scene->camera.position);
    const CameraPose camera = session().camera();

    write(folder_.path() / "bad.json", "{\"meshes\": [{\"file\": \"missing.obj\"}]}");
    write(folder_.path() / "picture.txt", "no scene");
    for (const char* name : {"bad.json", "picture.txt"}) {
        drop(folder_.path() / name);
        finish_build();
        EXPECT_NE(session().message().find(name), std::string::npos) << session().message();
        EXPECT_EQ(session().build().job.scene->file.stem(), "furnace");
        EXPECT_EQ(session().options().scene.file, session().build().job.options.scene.file);
        EXPECT_EQ(session().camera().position, camera.position);
    }
    const double samples = session().samples();
    run_frames(3);
    EXPECT_GT(session().samples(), samples) << "the last scene goes on";

    write(folder_.path() / "triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    drop(folder_.path() / "triangle.obj");
    finish_build();
    EXPECT_EQ(session().message(), "");
    EXPECT_EQ(session().build().job.scene->file.stem(), "triangle");
}

TEST_F(ViewerTest, AChangedShaderIsShownAndABrokenOneReported) {
    // A private chapter, so that the sources stay untouched.
    const fs::path shader = folder_.path() / "path_trace.glsl";
    chapter_ = {.name = folder_.path().string(), .title = "Reload"};
    const auto constant = [](const char* colour) {
        return std::string("#include \"colour.glsl\"\nvec3 path_trace(Ray ray, inout uvec2 seed) {\n    return ") + colour +
               ";\n}\n";
    };
    write(folder_.path() / "colour.glsl", "const vec3 included = vec3(0.0, 0.0, 1.0);\n");
    write(shader, constant("vec3(1.0, 0.0, 0.0)"));
    open(make_options());
    const auto shows = [&](double red, double green, double blue) {
        return session().samples() >= 1 && saved_film("shown.exr").mean_radiance() == std::array{red, green, blue};
    };
    EXPECT_TRUE(shows(1, 0, 0));

    auto start = Clock::now();
    write(shader, constant("vec3(0.0, 1.0, 0.0)"));
    wait_until("green", [&] { return shows(0, 1, 0); });
    RecordProperty("reload_seconds", std::to_string(std::chrono::duration<double>(Clock::now() - start).count()));

    write(shader, constant("missing_colour"));
    wait_until("an error", [&] { return !session().message().empty(); });
    EXPECT_NE(session().message().find("path_trace.glsl:3: "), std::string::npos) << session().message();
    EXPECT_NE(session().message().find("missing_colour"), std::string::npos) << session().message();
    EXPECT_TRUE(shows(0, 1, 0)) << "the last good picture stays";
    run_frames(3);
    EXPECT_NE(session().message(), "") << "the message stays as long as the mistake does";

    write(shader, constant("included"));
    wait_until("blue", [&] { return shows(0, 0, 1); });
    EXPECT_EQ(session().message(), "");
    write(folder_.path() / "colour.glsl", "const vec3 included = vec3(0.5);\n");
    wait_until("the changed include", [&] { return shows(0.5, 0.5, 0.5); });

    // A new file, written after the line that includes it.
    write(shader, "#include \"new.glsl\"\n" + constant("added"));
    wait_until("an error", [&] { return !session().message().empty(); });
    write(folder_.path() / "new.glsl", "const vec3 added = vec3(0.25);\n");
    wait_until("the new include", [&] { return shows(0.25, 0.25, 0.25); });

    // Restoring the text that is already running ends the complaint.
    const std::string good = text_of(shader);
    write(shader, "broken");
    wait_until("an error", [&] { return !session().message().empty(); });
    write(shader, good);
    wait_until("no error", [&] { return session().message().empty(); });
}

TEST_F(ViewerTest, ShowsThePictureAlsoWhileTheShaderIsBroken_all) {
    // A copy of the chapter, in a place that reads well in the documentation's pictures.
    fs::create_directories("output");
    const TemporaryFolder copy("output");
    const fs::path shader = copy.path() / "path_trace.glsl";
    fs::copy_file(project_folder() / "chapters" / chapter_.name / "path_trace.glsl", shader);
    chapter_.name = fs::absolute(copy.path()).string();
    chapter_.title = "Russian roulette: dim paths end early, without bias";
    Options options = make_options();
    options.image.width = options.image.height = 256;
    options.appearance.sample_count = 16;
    options.light.max_path_length = 6;  // as in the reference
    open(options);
    wait_until("all samples", [&] { return session().samples() >= 16; });
    take_screenshot("window");

    const auto press_tab = [&] { press(GLFW_KEY_TAB), press(GLFW_KEY_TAB, false), run_frames(1); };
    const auto expect_picture = [&] {
        press_tab();  // nothing covers the picture
        take_screenshot("window_without_controls");
        const Texture& shown = viewer_->screen().captured();
        const Texture picture = to_display(saved_film("picture.exr"), DisplayTransform::exposure, 0);
        const Rectangle where = viewer_->picture_rectangle();
        ASSERT_GT(where.size.x, 256);  // so pixels are enlarged
        size_t different = 0;
        for (int y = 0; y < where.size.y; ++y)
            for (int x = 0; x < where.size.x; ++x) {
                const auto scaled = [&](int i, int size) { return static_cast<size_t>((2 * i + 1) * 256 / (2 * size)); };
                const size_t from = 4 * (256 * scaled(y, where.size.y) + scaled(x, where.size.x));
                const size_t to =
                    4 * (shown.width * static_cast<size_t>(where.corner.y + y) + static_cast<size_t>(where.corner.x + x));
                for (size_t channel = 0; channel < 3; ++channel)
                    different += std::abs(int{shown.pixels[to + channel]} - int{picture.pixels[from + channel]}) > 1;
            }
        // Where exactly an enlarged pixel ends is a matter of rounding.
        EXPECT_LT(different, picture.pixels.size() / 100);
        press_tab();
    };
    expect_picture();

    const std::string text = text_of(shader);
    const size_t mistake = text.find("survival_probability");
    ASSERT_NE(mistake, std::string::npos);
    write(shader, text.substr(0, mistake) + "x" + text.substr(mistake));
    wait_until("an error", [&] { return !session().message().empty(); });
    EXPECT_EQ(session().message().find("output/"), 0u) << session().message();
    take_screenshot("window_broken_shader");
    expect_picture();

    // Repaired, but differently from before: it must be compiled.
    const auto start = Clock::now();
    const std::string division = "/= survival_probability";
    ASSERT_NE(text.find(division), std::string::npos);
    std::string repaired = text;
    repaired.replace(text.find(division), division.size(), "/= survival_probability + 1e-20");
    write(shader, repaired);
    wait_until("repaired", [&] { return session().message().empty() && session().samples() > 0; });
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    RecordProperty("chapter_reload_seconds", std::to_string(seconds));
}

TEST_F(ViewerTest, ClosesWhileSomethingIsBuilt) {
    open(make_options());
    drop(scenes / "torus.json");
    run_frames(1);
    EXPECT_TRUE(session().is_building());
    glfwSetWindowShouldClose(window_->handle(), GLFW_TRUE);
    EXPECT_FALSE(viewer_->frame());
    EXPECT_GE(saved_film("closed.exr").min_samples(), 1u);
}

TEST_F(ViewerTest, PausesAndRestarts) {
    open(make_options());
    wait_until("samples", [&] { return session().samples() >= 2; });
    press(GLFW_KEY_SPACE);
    run_frames(1);
    const double samples = session().samples();
    run_frames(3);
    EXPECT_EQ(session().samples(), samples);
    press(GLFW_KEY_SPACE, false);
    press(GLFW_KEY_R);
    run_frames(1);
    EXPECT_LT(session().samples(), samples);
    wait_until("a first sample of the paused picture", [&] { return session().samples() >= 1; });
    press(GLFW_KEY_TAB);  // without the controls
    run_frames(2);
}

}  // namespace
}  // namespace lab
