// A render in a window, which the user may change at any time.
#pragma once
#include <set>
#include <variant>

#include "clock.h"
#include "rendering/build.h"
#include "statistics/live_verdict.h"
#include "viewer/background_work.h"
#include "viewer/screen.h"

namespace lab {

// A build and its display: made in the background, because it takes long.
struct WindowBuild : Build {
    std::set<std::filesystem::path> shader_files;
    uint64_t shader_hash = 0;  // of their contents
    std::unique_ptr<DisplayPass> display;
};

// make_build(), and a pass that shows the film.
std::unique_ptr<WindowBuild> make_window_build(const Device& device, const Chapter& chapter, RenderJob job,
                                               BuildStage first = BuildStage::scene, const WindowBuild* before = nullptr);

// Hash of all contents; 0 if a file cannot be read, as while an editor replaces it.
uint64_t hash_of(const std::set<std::filesystem::path>& files);

// State of the live verdict. Outdated: the shader does not compile, so the one before is rendered.
enum class VerdictState { none, agrees, biased, outdated };

class Session {
  public:
    // The device must outlive the session.
    Session(const Device& device, Chapter chapter, std::unique_ptr<WindowBuild> first_build);

    const Chapter& chapter() const { return chapter_; }
    const WindowBuild& build() const { return *build_; }
    // The wanted options: those of the render unless a build is in progress.
    const Options& options() const { return options_; }
    CameraPose camera() const;
    vec3 background() const;

    // Changes options. Parameters take effect at the next update(); what must be built is built in the background while the
    // picture stays. Impossible changes are reverted, and message() says why.
    void change(const Options& options);
    void set_camera(const CameraPose& pose);
    void reset_camera();  // to the first one
    bool has_moved() const { return options_.camera != first_camera(); }
    void open_scene(const std::filesystem::path& file);  // with its own camera and background
    void restart() { needs_restart_ = true; }

    // Does a frame's work: adopts finished builds, looks for changed shaders, and renders for about so many seconds. After a
    // restart and while the camera moves, the image is reduced so that a sample per pixel fits into that time.
    void update(double dispatch_seconds, bool is_moving);

    bool is_paused = false;
    bool waits = false;  // for the other session of a comparison
    bool is_building() const { return work_.is_under_way(); }
    // Whether the session can end without waiting for a build.
    bool can_end() const { return !is_building() || work_.is_done(); }
    // Another scene is being loaded; camera and background are its own already.
    bool is_loading_scene() const { return reloads_scene_ || options_.scene.file != build_->job.options.scene.file; }
    const std::string& message() const { return message_; }  // the last failure, or empty

    // --- Progress since the last restart.
    uint32_t target_samples() const;             // per pixel; UINT32_MAX without --samples
    double samples() const;                      // per pixel; 0 of a reduced image
    double seconds() const { return seconds_; }  // spent on rendering
    uint64_t rays() const { return build_->renderer->rays(); }
    uint32_t reduction() const { return reduction_; }  // width of a rendered pixel in pixels of the picture
    // Relative error (root of rel_mse) estimated from the halves of the samples.
    std::optional<double> relative_error() const;

    // Test against the scene's reference; null without one, and verdict_text() says why.
    const LiveVerdict* verdict() const { return std::get_if<LiveVerdict>(&verdict_); }
    // Its latest verdict, or null.
    const Verdict* latest_verdict() const { return verdict() && verdict()->verdict() ? &*verdict()->verdict() : nullptr; }
    VerdictState verdict_state() const;
    std::string verdict_text() const;

    // Writes the picture so far in the formats of the files' extensions.
    void save(const std::vector<std::filesystem::path>& files);
    const FilmImage& last_snapshot() const { return snapshot_; }
    // After a failure: keep_after() with the last snapshot.
    [[noreturn]] void keep_snapshot_after(const std::exception& error, const std::vector<std::filesystem::path>& files) const;

  private:
    CameraOptions first_camera() const;
    void look_for_changed_shaders();
    void start_build_if_needed();
    void adopt_finished_build();
    void begin(uint32_t reduction);
    void render(double seconds);
    void take_snapshots(uint32_t samples, double seconds);
    std::variant<LiveVerdict, std::string> find_verdict() const;
    void write(const std::vector<std::filesystem::path>& files, const FilmImage& film, const FilmRecord& record) const;
    FilmRecord record(double seconds) const;  // after so many seconds of rendering
    uint32_t find_reduction(double seconds) const;
    void take_back(const std::string& why);

    const Device& device_;
    const Chapter chapter_;
    Options options_;
    const Options first_options_;
    std::unique_ptr<WindowBuild> build_;
    BackgroundWork<std::unique_ptr<WindowBuild>> work_;
    BuildStage work_stage_ = BuildStage::nothing;  // of the build in progress, changed shaders aside
    bool reloads_scene_ = false;                   // even if its name stays the same
    std::set<std::filesystem::path> watched_shaders_;
    uint64_t shader_hash_ = 0;         // of their contents, when last looked at
    uint64_t work_shader_hash_ = 0;    // at the start of the build in progress
    uint64_t failed_shader_hash_ = 0;  // contents that did not compile; 0 if the last ones did
    Clock::time_point last_look_{};
    std::string message_;

    bool needs_restart_ = true;
    uint32_t reduction_ = 1;
    double paths_per_second_ = 0;  // camera paths, measured
    double seconds_ = 0;
    FilmImage snapshot_;  // at the last power of two
    FilmRecord snapshot_record_;
    std::variant<LiveVerdict, std::string> verdict_ = "the render goes on from an earlier one";
    std::optional<double> snapshot_error_;
};

}  // namespace lab
