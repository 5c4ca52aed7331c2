// What a window renders, and the changes that its user makes to it.
#pragma once
#include <set>
#include <variant>

#include "clock.h"
#include "rendering/build.h"
#include "statistics/live_verdict.h"
#include "viewer/background_work.h"
#include "viewer/display_pass.h"

namespace lab {

// What a window renders with: everything that takes long to make, so that a thread of its own makes it.
struct WindowBuild : Build {
    std::set<std::filesystem::path> shader_files;
    uint64_t shader_hash = 0;  // of their contents
    std::unique_ptr<DisplayPass> display;
};

// As make_build(), and what shows the film.
std::unique_ptr<WindowBuild> make_window_build(const Device& device, const Chapter& chapter, RenderJob job,
                                               BuildStage first = BuildStage::scene,
                                               const WindowBuild* before = nullptr);

// Hash of the contents of all files; 0 if one cannot be read now, as while an editor replaces it.
uint64_t hash_of(const std::set<std::filesystem::path>& files);

// What the live verdict is worth. Outdated: the shader has a mistake, and what is rendered is the one before.
enum class VerdictState { none, agrees, biased, outdated };

class Session {
  public:
    // The device must outlive the session.
    Session(const Device& device, Chapter chapter, std::unique_ptr<WindowBuild> first_build);

    const Chapter& chapter() const { return chapter_; }
    const WindowBuild& build() const { return *build_; }
    // What is wanted, which is what is rendered unless a build is in progress.
    const Options& options() const { return options_; }
    CameraPose camera() const;
    vec3 background() const;

    // Asks for other options. Parameters of the estimator hold from the next update() on; what has to be
    // built for others is built in the background while the picture stays. What turns out to be impossible is
    // taken back, and message() says why.
    void change(const Options& options);
    void set_camera(const CameraPose& pose);
    void reset_camera();  // to the one it began with
    bool has_moved() const { return options_.camera != first_camera(); }
    void open_scene(const std::filesystem::path& file);  // with its own camera and background
    void restart() { needs_restart_ = true; }

    // One frame's work: takes over what was built, looks for changed shaders, and renders for about so many
    // seconds. After a restart, and as long as the camera moves, the image is reduced until a sample of every
    // pixel fits into that time.
    void update(double dispatch_seconds, bool is_moving);

    bool is_paused = false;
    bool waits = false;  // for another session that is to keep up
    bool is_building() const { return work_.is_under_way(); }
    // The session can end without waiting for a build.
    bool can_end() const { return !is_building() || work_.is_done(); }
    // Another scene is on its way: camera and background are its own already.
    bool is_loading_scene() const {
        return reloads_scene_ || options_.scene.file != build_->job.options.scene.file;
    }
    const std::string& message() const { return message_; }  // the last failure; empty if there is none

    // --- Progress since the last restart.
    uint32_t target_samples() const;             // of a pixel; UINT32_MAX without --samples
    double samples() const;                      // of a pixel; 0 of a reduced image
    double seconds() const { return seconds_; }  // spent on rendering
    uint64_t rays() const { return build_->renderer->rays(); }
    uint32_t reduction() const { return reduction_; }  // pixels of the picture a rendered one, in a row
    // Relative error (root of rel_mse) estimated from two halves of the samples, from 2 samples on.
    std::optional<double> relative_error() const;

    // Whether the picture will be the scene's reference: null where there is nothing to compare with, and
    // why in verdict_text().
    const LiveVerdict* verdict() const { return std::get_if<LiveVerdict>(&verdict_); }
    // The latest of it; null before the first.
    const Verdict* latest_verdict() const {
        return verdict() && verdict()->verdict() ? &*verdict()->verdict() : nullptr;
    }
    VerdictState verdict_state() const;
    std::string verdict_text() const;

    // Writes what there is so far, each file in the format of its ending, as a run without a window does.
    void save(const std::vector<std::filesystem::path>& files);
    const FilmImage& last_snapshot() const { return snapshot_; }
    // The snapshot before that, mostly of half as many samples; without pixels if there is only one.
    const FilmImage& earlier_snapshot() const { return earlier_snapshot_; }
    // After an error of the device or of memory: writes what was last read from the device and throws, as
    // keep_after() says.
    [[noreturn]] void keep_snapshot_after(const std::exception& error,
                                          const std::vector<std::filesystem::path>& files) const;

  private:
    CameraOptions first_camera() const;
    void look_for_changed_shaders();
    void start_build_if_needed();
    void adopt_finished_build();
    void begin(uint32_t reduction);
    void render(double seconds);
    void take_snapshots(uint32_t samples, double seconds);
    std::variant<LiveVerdict, std::string> find_verdict() const;
    void write(const std::vector<std::filesystem::path>& files, const FilmImage& film,
               const FilmRecord& record) const;
    FilmRecord record(double seconds) const;  // after so many of rendering
    uint32_t find_reduction(double seconds) const;
    void take_back(const std::string& why);

    const Device& device_;
    const Chapter chapter_;
    Options options_;
    const Options first_options_;
    std::unique_ptr<WindowBuild> build_;
    BackgroundWork<std::unique_ptr<WindowBuild>> work_;
    BuildStage work_stage_ = BuildStage::nothing;  // that the build in progress begins at, but for shaders
    bool reloads_scene_ = false;                   // although its name stays the same
    std::set<std::filesystem::path> watched_shaders_;
    uint64_t shader_hash_ = 0;         // of their contents when last looked at
    uint64_t work_shader_hash_ = 0;    // the same when the build in progress was started
    uint64_t failed_shader_hash_ = 0;  // contents that did not compile; 0 if the last ones did
    Clock::time_point last_look_{};
    std::string message_;

    bool needs_restart_ = true;
    uint32_t reduction_ = 1;
    double paths_per_second_ = 0;  // camera paths, measured
    double seconds_ = 0;
    FilmImage snapshot_;  // at the last power of two
    FilmRecord snapshot_record_;
    FilmImage earlier_snapshot_;  // at the one before
    std::variant<LiveVerdict, std::string> verdict_ = "the render goes on from an earlier one";
    std::optional<double> snapshot_error_;
};

}  // namespace lab
