// A render in a window, which the user may change at any time.
#pragma once
#include <variant>

#include "clock.h"
#include "rendering/build.h"
#include "rendering/scene_reference.h"
#include "statistics/live_verdict.h"
#include "viewer/background_work.h"
#include "viewer/screen.h"
#include "viewer/watched_shaders.h"

namespace lab {

// A build and its display pass, made in the background because it takes long.
struct WindowBuild : Build {
    ShaderFiles shader_files;
    uint64_t shader_hash = 0;        // of their contents
    std::unique_ptr<Film> filtered;  // what is shown if there is a filter
    std::unique_ptr<DisplayPass> display;
};

// Calls make_build() and adds a pass that displays the film.
std::unique_ptr<WindowBuild> make_window_build(const Device& device, const Chapter& chapter, RenderJob job,
                                               BuildStage first = BuildStage::scene, const WindowBuild* before = nullptr);

// State of the live verdict. Outdated: the shader does not compile, so the previous one is being rendered.
enum class VerdictState { none, agrees, biased, outdated };

class Session {
  public:
    // The device must outlive the session.
    Session(const Device& device, Chapter chapter, std::unique_ptr<WindowBuild> first_build);

    const Chapter& chapter() const { return chapter_; }
    const WindowBuild& build() const { return *build_; }
    // What is wanted. build().job.options is what is shown, and follows at the next update(), or when a build is done.
    const Options& options() const { return wanted_; }
    CameraPose camera() const;
    vec3 background() const;

    // Changes what is wanted. Parameters take effect at the next update(); anything that needs a build is built in the background
    // while the picture stays. Impossible changes are reverted, and message() says why.
    void change(const Options& options) { wanted_ = options; }
    void set_camera(const CameraPose& pose);
    void focus_on(const vec3& point);  // in front of the camera
    void reset_camera() { wanted_.camera = first_camera(); }
    bool has_moved() const { return wanted_.camera != first_camera(); }
    void open_scene(const std::filesystem::path& file);  // with its own camera and background
    void restart() { needs_restart_ = true; }

    // Does one frame's work: takes over finished builds, checks for changed shaders, and renders for about this many seconds.
    // After a restart and while the camera moves, the image is reduced so that one sample per pixel fits into that time.
    void update(double dispatch_seconds, bool is_moving);

    bool is_paused = false;
    bool waits = false;  // for the other session of a comparison
    bool is_building() const { return work_.is_under_way(); }
    // Whether the session can end without waiting for a build.
    bool can_end() const { return !is_building() || work_.is_done(); }
    // Whether another scene is being loaded, although camera and background are already the new ones.
    bool is_loading_scene() const { return reloads_scene_ || wanted_.scene.file != build_->job.options.scene.file; }
    const std::string& message() const { return message_; }  // the last failure, or empty
    // Whether rendering has ended because of a loop that does not. It is tried again after any change.
    bool is_stuck() const { return is_stuck_; }

    // --- Progress since the last restart.
    uint32_t target_samples() const;             // per pixel; UINT32_MAX without --samples
    double samples() const;                      // per pixel; 0 for a reduced image
    double seconds() const { return seconds_; }  // spent on rendering
    uint64_t rays() const { return build_->renderer->rays(); }
    uint32_t reduction() const { return reduction_; }  // width of a rendered pixel in pixels of the picture
    // Relative error (root of rel_mse), estimated from the halves of the samples.
    std::optional<double> relative_error() const;
    bool is_filtered() const { return build_->denoiser != nullptr; }

    // The test against the scene's reference; null without one, and verdict_text() says why.
    const LiveVerdict* verdict() const { return std::get_if<LiveVerdict>(&verdict_); }
    // The test's latest verdict, or null.
    const Verdict* latest_verdict() const { return verdict() && verdict()->verdict() ? &*verdict()->verdict() : nullptr; }
    VerdictState verdict_state() const;
    std::string verdict_text() const;
    // Where there is no verdict: the nearest settings that give one, if any, and a change to them.
    const std::optional<VerdictSettings>& settings_for_verdict() const { return verdict_settings_; }
    void change_for_verdict();

    // Writes the current picture in the formats given by the files' extensions.
    void save(const std::vector<std::filesystem::path>& files);
    const FilmImage& last_snapshot() const { return snapshot_.film; }
    // After a failure: calls write_after_failure() with the last snapshot.
    [[noreturn]] void keep_snapshot_after(const std::exception& error, const std::vector<std::filesystem::path>& files) const;

  private:
    CameraOptions first_camera() const;
    void start_build_if_needed();
    void adopt_finished_build();
    void begin(uint32_t reduction);
    void render(double seconds);
    void take_snapshots(uint32_t samples, double seconds);
    void show_filtered(uint32_t samples);
    FilmImage read_picture(FilmHeader& header);
    std::variant<LiveVerdict, std::string> find_verdict() const;
    void write(const std::vector<std::filesystem::path>& files, const FilmImage& film, const FilmHeader& header) const;
    FilmHeader header(double seconds) const;  // after this many seconds of rendering
    uint32_t find_reduction(double seconds) const;
    void take_back(const std::string& why);

    // A picture that was read back, at the last power of two of its samples.
    struct Snapshot {
        FilmImage film;
        FilmHeader header;
        std::optional<double> relative_error;
    };

    const Device& device_;
    const Chapter chapter_;
    const Options first_options_;
    Options wanted_;
    std::unique_ptr<WindowBuild> build_;  // what is shown
    BackgroundWork<std::unique_ptr<WindowBuild>> work_;
    BuildStage work_stage_ = BuildStage::nothing;  // of the build in progress, apart from changed shaders
    uint64_t work_shader_hash_ = 0;                // at its start
    bool reloads_scene_ = false;                   // even if its name is the same
    WatchedShaders shaders_;
    std::string message_;

    bool needs_restart_ = true;
    bool is_stuck_ = false;
    uint32_t reduction_ = 1;
    double paths_per_second_ = 0;  // camera paths, measured
    double seconds_ = 0;
    Snapshot snapshot_;
    std::variant<LiveVerdict, std::string> verdict_ = "the render goes on from an earlier one";
    std::optional<VerdictSettings> verdict_settings_;
};

}  // namespace lab
