#include "viewer/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <cstdio>

#include "platform.h"
#include "rendering/numbers_text.h"
#include "viewer/comparison_panel.h"

namespace lab {
namespace {

// Exponential moving average over about ten values.
double smooth(double average, double number) { return average + 0.1 * (number - average); }

// Makes the first build in the background while the window says so.
std::unique_ptr<WindowBuild> build_while_waiting(Window& window, Screen& screen, const Device& device, const Chapter& chapter,
                                                 const RenderJob& job) {
    BackgroundWork<std::unique_ptr<WindowBuild>> work;
    work.start([&] { return make_window_build(device, chapter, job); });
    while (!work.is_done()) {
        work.wait(std::chrono::milliseconds(20));
        window.poll_events();
        screen.begin_frame();
        ImGui::GetBackgroundDrawList()->AddText({20, 20}, IM_COL32_WHITE, "Building what traces the rays and the shaders ...");
        screen.show({});
    }
    return work.take();
}

}  // namespace

Viewer::Viewer(Window& window, const Device& device, const Chapter& chapter, const RenderJob& job)
    : window_(window),
      screen_(device, window),
      session_(device, chapter, build_while_waiting(window, screen_, device, chapter, job)),
      inspection_panel_(device),
      comparison_(device) {}

bool Viewer::frame() {
    const bool has_work =
        !session_.is_paused && !session_.is_stuck() && !session_.is_building() && session_.samples() < session_.target_samples();
    window_.poll_events(has_work ? 0 : 0.02);
    if (window_.should_close() || is_interrupted()) return false;
    const auto start = Clock::now();
    const double seconds = seconds_since(last_frame_);
    last_frame_ = start;
    if (seconds > 0) frames_per_second_ = smooth(frames_per_second_, 1 / seconds);

    const double budget = rendering_seconds(window_.refresh_seconds(), interface_seconds_);
    screen_.begin_frame();
    for (const auto& file : window_.dropped_files()) session_.open_scene(file);
    if (shows_controls_) {
        const Session* beside = comparison_.is_active() ? &comparison_.second() : nullptr;
        inspection_panel_.draw(session_, beside, beside ? comparison_.split : 1, picture_rectangle(), path_rectangle(),
                               0.15 * budget);
        draw_halves(comparison_, session_, picture_rectangle());
        controls_.draw(session_, camera_control_, controls_rectangle(), frames_per_second_, [&] {
            inspection_panel_.draw_controls(session_);
            draw_controls(comparison_, session_);
        });
    }
    handle_keys();
    move_camera(std::min(seconds, 0.2));
    window_.clear_events();

    const auto rendering = Clock::now();
    constexpr double rest = 0.2;  // seconds without motion before rendering at full size
    comparison_.update(session_, budget, seconds_since(last_motion_) < rest);
    const double rendered = seconds_since(rendering);

    const double waited = screen_.show(comparison_.layers(session_, picture_rectangle()));
    interface_seconds_ = smooth(interface_seconds_, seconds_since(start) - rendered - waited);
    return true;
}

bool Viewer::is_narrow() const { return static_cast<int>(screen_.size().x) < 5 * controls_.width() / 3; }

Rectangle Viewer::controls_rectangle() const {
    const glm::ivec2 window(screen_.size());
    if (!is_narrow()) return {{0, 0}, {controls_.width(), window.y}};
    const glm::dvec2 picture(session_.build().job.parameters.image_size);
    const int top = std::min(static_cast<int>(window.x * picture.y / picture.x), window.y / 2);
    return {{0, top}, {window.x, window.y - top}};
}

Rectangle Viewer::path_rectangle() const {
    const glm::ivec2 window(screen_.size());
    if (shows_controls_ && is_narrow()) {  // over the controls
        Rectangle whole = controls_rectangle();
        if (!inspection_panel_.inspection().selection()) whole.size.y = 0;
        return whole;
    }
    const int left = shows_controls_ ? controls_.width() : 0;
    const int height = shows_controls_ ? std::min(inspection_panel_.height(), window.y * 2 / 5) : 0;
    return {{left, window.y - height}, {window.x - left, height}};
}

Rectangle Viewer::picture_rectangle() const {
    const Rectangle path = path_rectangle();
    const glm::dvec2 free(std::max(path.size.x, 1), std::max(path.corner.y, 1));
    const glm::dvec2 size(session_.build().job.parameters.image_size);
    const double scale = std::min(free.x / size.x, free.y / size.y);
    Rectangle picture;
    picture.size = glm::ivec2(scale * size);
    picture.corner = glm::ivec2(path.corner.x, 0) + (glm::ivec2(free) - picture.size) / 2;
    return picture;
}

void Viewer::move_camera(double seconds) {
    if (session_.is_loading_scene()) return;
    const std::shared_ptr<const Scene>& scene = session_.build().job.scene;
    if (fitted_scene_ != scene) {
        fitted_scene_ = scene;
        camera_control_.fit_to(world_bounds(*scene));
    }
    const ImGuiIO& io = ImGui::GetIO();
    CameraMotion motion;
    if (!io.WantCaptureKeyboard && !io.WantTextInput) {
        const auto pull = [&](int forth, int back) {
            return static_cast<float>(window_.is_key_down(forth)) - static_cast<float>(window_.is_key_down(back));
        };
        motion.steps = static_cast<float>(seconds) *
                       vec3(pull(GLFW_KEY_D, GLFW_KEY_A), pull(GLFW_KEY_E, GLFW_KEY_Q), pull(GLFW_KEY_W, GLFW_KEY_S));
    }
    if (!io.WantCaptureMouse) {
        if (ImGui::IsMouseDragging(ImGuiMouseButton_Left)) {
            const float height = static_cast<float>(picture_rectangle().size.y) / io.DisplayFramebufferScale.y;
            motion.drag = vec2(io.MouseDelta.x, io.MouseDelta.y) / std::max(height, 1.0f);
        }
        motion.zoom = io.MouseWheel;
    }
    if (motion.is_none()) return;
    const CameraPose pose = session_.camera(), moved = camera_control_.move(pose, motion);
    if (moved.position == pose.position && moved.target == pose.target) return;  // the wheel only changed the speed
    session_.set_camera(moved);
    last_motion_ = Clock::now();
}

void Viewer::handle_keys() {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureKeyboard || io.WantTextInput) return;
    if (window_.was_key_pressed(GLFW_KEY_TAB)) shows_controls_ = !shows_controls_;
    if (window_.was_key_pressed(GLFW_KEY_SPACE)) session_.is_paused = !session_.is_paused;
    if (window_.was_key_pressed(GLFW_KEY_R)) session_.restart();
    if (window_.was_key_pressed(GLFW_KEY_F)) session_.reset_camera();
    if (window_.was_key_pressed(GLFW_KEY_T)) inspection_panel_.show_next_overlay();
}

void run_viewer(Window& window, const Device& device, const Chapter& chapter, const RenderJob& job) {
    install_interrupt_handler();
    Viewer viewer(window, device, chapter, job);
    const Session& session = viewer.session();
    const RunOptions& options = job.options.run;
    try {
        while (viewer.frame()) {
        }
        viewer.session().save(options.outputs);
    } catch (const std::exception& error) {
        session.keep_snapshot_after(error, options.outputs);
    }
    if (options.quiet) return;
    std::printf("samples        %s a pixel\n", samples_text(session.samples()).c_str());
    for (const auto& file : options.outputs) std::printf("picture        %s\n", file.string().c_str());
}

}  // namespace lab
