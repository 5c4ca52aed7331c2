// Operates a chapter's window as a user would: on a virtual display in continuous integration.
#pragma once
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <cstdlib>
#include <fstream>
#include <functional>

#include "app/all_backends.h"
#include "files/project_folder.h"
#include "support/chapters.h"
#include "support/temporary_folder.h"
#include "viewer/viewer.h"

namespace lab {

namespace fs = std::filesystem;

inline const fs::path scenes = project_folder() / "assets" / "scenes";

inline std::string text_of(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

class ViewerTest : public testing::Test {
  protected:
    void SetUp() override {
        if (window_systems().empty()) GTEST_SKIP() << "there is no display: use tests/support/with_display.sh";
    }

    void TearDown() override {
        viewer_.reset();
        if (!device_) return;
        for (const auto& message : device_->validation_messages()) ADD_FAILURE() << "validation layer: " << message;
        device_.reset();
        window_.reset();
    }

    // A small picture, so that many samples take no time.
    Options make_options() const {
        Options options;
        options.scene.file = scenes / "cornell_box.json";
        options.image.width = 48;
        options.image.height = 40;
        options.run.backends = all_backends;
        options.run.backend = "compute";
        options.samples.chapter_values.resize(chapter_.options.size());
        return options;
    }

    // With the size and path length of a reference.
    Options options_with_reference() const {
        Options options = make_options();
        options.image.width = options.image.height = 128;
        options.light.max_path_length = 6;
        return options;
    }

    void open(const Options& options, uvec2 window_size = {900, 640}) {
        window_ = std::make_unique<Window>("test", window_size);
        // A virtual display may be inaccessible to a GPU, but not to the CPU.
        for (const char* choice : {"", "llvmpipe"}) {
            device_ = std::make_unique<Device>(
                DeviceOptions{.choice = choice,
                              .validation = true,
                              .instance_extensions = window_->instance_extensions(),
                              .make_surface = [&](VkInstance instance) { return window_->make_surface(instance); }});
            if (*device_->surface()) break;
        }
        ASSERT_TRUE(*device_->surface());
        viewer_ = std::make_unique<Viewer>(*window_, *device_, chapter_,
                                           make_job(chapter_, options, load_scene_for(chapter_, options.scene)));
        glfwFocusWindow(window_->handle());
        run_frames(2);
    }

    Session& session() { return viewer_->session(); }

    void run_frames(int count) {
        for (int i = 0; i < count; ++i) ASSERT_TRUE(viewer_->frame());
    }

    // Runs frames until a condition holds; fails if it never does, however busy the machine is.
    void wait_until(const char* what, const std::function<bool()>& is_so) {
        const auto start = Clock::now();
        while (!is_so()) {
            ASSERT_TRUE(viewer_->frame());
            ASSERT_LT(std::chrono::duration<double>(Clock::now() - start).count(), 600) << "still not: " << what;
        }
    }

    void finish_build() {
        run_frames(1);
        wait_until("built", [&] { return !session().is_building(); });
    }

    // Events as GLFW would report them, through the installed callbacks.
    void press(int key, bool is_down = true) {
        GLFWwindow* window = window_->handle();
        const auto callback = glfwSetKeyCallback(window, nullptr);
        glfwSetKeyCallback(window, callback);
        callback(window, key, 0, is_down ? GLFW_PRESS : GLFW_RELEASE, 0);
    }
    // Holds a key down for some frames.
    void hold(int key, int frames = 1) {
        press(key);
        run_frames(frames);
        press(key, false);
    }
    void drop(const fs::path& file) {
        GLFWwindow* window = window_->handle();
        const auto callback = glfwSetDropCallback(window, nullptr);
        glfwSetDropCallback(window, callback);
        const std::string name = file.string();
        const char* names[] = {name.c_str()};
        callback(window, 1, names);
    }
    void press_mouse(bool is_down) {
        GLFWwindow* window = window_->handle();
        const auto callback = glfwSetMouseButtonCallback(window, nullptr);
        glfwSetMouseButtonCallback(window, callback);
        callback(window, GLFW_MOUSE_BUTTON_LEFT, is_down ? GLFW_PRESS : GLFW_RELEASE, 0);
    }
    // GLFW reports no motion caused by a program, but Dear ImGui from 1.87 on relies on such reports; before, it polled the
    // position every frame.
    void move_pointer(float x, float y) {
        GLFWwindow* window = window_->handle();
        glfwSetCursorPos(window, x, y);
        const auto callback = glfwSetCursorPosCallback(window, nullptr);
        glfwSetCursorPosCallback(window, callback);
        if (callback) callback(window, x, y);
    }
    // Moves the pointer and waits until the window has noticed.
    void point_at(float x, float y) {
        move_pointer(x, y);
        wait_until("pointed at", [&] { return std::abs(ImGui::GetIO().MousePos.x - x) < 1.5f; });
    }

    void click(float x, float y) {
        point_at(x, y);
        press_mouse(true);
        run_frames(2);
        press_mouse(false);
        run_frames(2);
    }

    // Clicks a control once it has kept its place for some frames: controls move as long as lines above them change, and a click
    // beside it may open a list that hides it, and choose another scene there.
    void click_at_rest(const std::function<vec2()>& place) {
        vec2 at = place();
        wait_until("at rest", [&, frames = 0]() mutable {
            frames = place() == at ? frames + 1 : 0;
            at = place();
            return frames > 5;
        });
        click(at.x, at.y);
    }

    // Clicks a control until that has had its effect.
    void click_until(const std::function<vec2()>& place, const std::function<bool()>& is_done) {
        for (int attempt = 0; attempt < 5 && !is_done(); ++attempt) click_at_rest(place);
        EXPECT_TRUE(is_done());
    }

    // Moves the pointer with the button held down. GLFW reports a button once, but Dear ImGui before 1.87 polls its state every
    // frame.
    void drag(const vec2& from, const vec2& to) {
        point_at(from.x, from.y);
        for (int step = 0; step <= 10; ++step) {
            const vec2 position = glm::mix(from, to, static_cast<float>(step) / 10);
            move_pointer(position.x, position.y);
            press_mouse(true);
            run_frames(1);
        }
        press_mouse(false);
        run_frames(2);
    }

    FilmImage saved_film(const char* name) {
        const fs::path file = folder_.path() / name;
        session().save({file});
        return read_film(file).image;
    }

    // Saves the window's contents as a picture.
    void take_screenshot(const std::string& name) {
        viewer_->screen().capture_next();
        run_frames(1);
        const Texture& shown = viewer_->screen().captured();
        ASSERT_EQ(uvec2(shown.width, shown.height), window_->framebuffer_size());
        fs::create_directories("output");
        write_png(fs::path("output") / (name + ".png"), shown);
    }

    TemporaryFolder folder_;
    Chapter chapter_ = load_chapter(chapter_named("russian_roulette"));
    std::unique_ptr<Window> window_;
    std::unique_ptr<Device> device_;
    std::unique_ptr<Viewer> viewer_;
};

}  // namespace lab
