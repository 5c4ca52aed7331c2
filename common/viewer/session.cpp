#include "viewer/session.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "error.h"
#include "platform.h"
#include "rendering/outputs.h"
#include "rendering/settings.h"
#include "tracing/limited_loops.h"

namespace lab {
Session::Session(const Device& device, Chapter chapter, std::unique_ptr<WindowBuild> first_build)
    : device_(device),
      chapter_(std::move(chapter)),
      first_options_(first_build->job.options),
      wanted_(first_options_),
      build_(std::move(first_build)),
      shaders_(build_->shader_files, build_->shader_hash),
      needs_restart_(!build_->job.resumed) {}

CameraPose Session::camera() const { return camera_of(chapter_, *build_->job.scene, wanted_); }

vec3 Session::background() const { return background_of(*build_->job.scene, wanted_); }

void Session::set_camera(const CameraPose& pose) {
    const CameraPose before = this->camera();
    CameraOptions& camera = wanted_.camera;
    camera.position = pose.position;
    camera.target = pose.target;
    camera.up = pose.up;
    camera.vertical_fov = pose.vertical_fov;
    // A value of the scene stays one: another number would need a build.
    if (pose.aperture_diameter != before.aperture_diameter) camera.aperture_diameter = pose.aperture_diameter;
    if (pose.focus_distance != before.focus_distance) camera.focus_distance = pose.focus_distance;
}

void Session::focus_on(const vec3& point) {
    CameraPose pose = camera();
    pose.focus_distance = glm::dot(point - pose.position, build_->job.parameters.camera.forward);
    set_camera(pose);
}

// Flags apply to the scene on the command line only.
CameraOptions Session::first_camera() const {
    return wanted_.scene.file == first_options_.scene.file ? first_options_.camera : CameraOptions{};
}

void Session::open_scene(const std::filesystem::path& file) {
    wanted_.scene.file = file;
    wanted_.camera = {};
    wanted_.light.background.reset();
    reloads_scene_ = true;
}

void Session::update(double dispatch_seconds, bool is_moving) {
    const bool had_failed = shaders_.have_failed();
    shaders_.look([&] { return shader_files(make_estimator(chapter_, wanted_)); });
    if (had_failed && !shaders_.have_failed()) message_.clear();
    adopt_finished_build();
    start_build_if_needed();
    const Options& shown = build_->job.options;
    if ((needs_restart_ || first_difference(shown, keep_built(shown, wanted_)) == BuildStage::samples) && !is_loading_scene())
        begin(find_reduction(dispatch_seconds));
    else if (reduction_ > 1 && !is_moving && build_->renderer->samples() >= 1)
        begin(1);
    // The build matters more than the picture it replaces; both may need the same processor.
    if (is_stuck_) return;
    try {
        render(is_building() ? 0.1 * dispatch_seconds : dispatch_seconds);
    } catch (const StuckLoop& loop) {
        begin(reduction_);  // the film holds wrong samples
        is_stuck_ = true;
        message_ = window_message(loop);
        verdict_ = "a loop of the shader does not end";
    }
}

void Session::start_build_if_needed() {
    if (is_building()) return;
    work_stage_ = reloads_scene_ ? BuildStage::scene : first_difference(build_->job.options, wanted_);
    BuildStage first = work_stage_;
    if (shaders_.have_changed()) first = std::min(first, BuildStage::renderer);
    if (first >= BuildStage::samples) return;
    reloads_scene_ = false;
    work_shader_hash_ = shaders_.hash();
    Options options = wanted_;
    options.run.resume.clear();
    work_.start([this, options, first, before = build_.get()] {
        auto scene = before->job.scene;
        if (first == BuildStage::scene) scene = load_scene_for(chapter_, options.scene);
        return make_window_build(device_, chapter_, make_job(chapter_, options, scene), first, before);
    });
}

void Session::adopt_finished_build() {
    if (!work_.is_done()) return;
    try {
        build_ = work_.take();
    } catch (const std::exception& error) {
        return take_back(window_message(error));
    }
    message_.clear();
    shaders_ = {build_->shader_files, build_->shader_hash};
    paths_per_second_ = 0;
    needs_restart_ = true;
}

void Session::take_back(const std::string& why) {
    message_ = why;
    // Blame the shaders only if nothing else changed and they are still the compiled ones.
    if (work_stage_ >= BuildStage::samples) shaders_.blame(work_shader_hash_);
    wanted_ = build_->job.options;
}

void Session::begin(uint32_t reduction) {
    needs_restart_ = false;
    if (std::exchange(is_stuck_, false)) message_.clear();
    const Options before = build_->job.options;
    try {
        set_options(build_->job, chapter_, keep_built(before, wanted_));
    } catch (const UserError& error) {
        wanted_ = before;
        message_ = error.what();
        set_options(build_->job, chapter_, before);
    }
    RenderParameters parameters = build_->job.parameters;
    reduction_ = reduction;
    parameters.image_size = glm::max(parameters.image_size / reduction_, uvec2(1));
    build_->renderer->restart(parameters);
    if (build_->denoiser) {
        build_->denoiser->restart(parameters);
        build_->filtered->resize(parameters.image_size.x, parameters.image_size.y);
    }
    seconds_ = 0;
    snapshot_ = {};
    verdict_ = find_verdict();
    verdict_settings_.reset();
    const RenderJob& job = build_->job;
    if (!verdict() && reduction_ == 1 && job.header.shows.empty())
        verdict_settings_ = lab::settings_for_verdict(*job.scene, job.parameters);
}

void Session::change_for_verdict() {
    wanted_.light.max_path_length = verdict_settings_->max_path_length;
    wanted_.image.width = verdict_settings_->image_size.x;
    wanted_.image.height = verdict_settings_->image_size.y;
}

// Starts a live verdict, or says why there is none.
std::variant<LiveVerdict, std::string> Session::find_verdict() const {
    const RenderJob& job = build_->job;
    if (reduction_ > 1) return "the picture is reduced";
    if (!job.header.shows.empty()) return "the picture shows " + job.header.shows;
    try {
        auto reference = find_reference(*job.scene, job.parameters);
        if (const auto* why = std::get_if<std::string>(&reference)) return *why;
        return LiveVerdict(std::get<Reference>(std::move(reference)), job.parameters.image_size);
    } catch (const UserError& error) {
        return window_message(error);
    }
}

VerdictState Session::verdict_state() const {
    if (!latest_verdict()) return VerdictState::none;
    if (shaders_.have_failed()) return VerdictState::outdated;
    return latest_verdict()->is_biased ? VerdictState::biased : VerdictState::agrees;
}

std::string Session::verdict_text() const {
    if (!verdict()) return "no verdict: " + std::get<std::string>(verdict_);
    return (verdict_state() == VerdictState::outdated ? "before the mistake: " : "") + verdict()->text();
}

uint32_t Session::find_reduction(double seconds) const {
    constexpr uint32_t largest = 16;
    if (paths_per_second_ <= 0) return 4;  // nothing measured yet
    const uvec2 size = build_->job.parameters.image_size;
    const double affordable = std::max(paths_per_second_ * seconds, 1.0);
    const double pixels = static_cast<double>(size.x) * size.y;
    return static_cast<uint32_t>(std::clamp(std::ceil(std::sqrt(pixels / affordable)), 1.0, double{largest}));
}

void Session::render(double seconds) {
    Renderer& renderer = *build_->renderer;
    const auto start = Clock::now();
    const double first_samples = renderer.samples();
    double elapsed = 0;
    // A reduced picture should be complete when shown, unless that takes far too long.
    const auto goes_on = [&] {
        // Changes must show even while paused.
        if ((is_paused || waits) && renderer.samples() >= 1) return false;
        return elapsed < 0.75 * seconds || (reduction_ > 1 && renderer.samples() < 1 && elapsed < 2 * seconds);
    };
    while (renderer.samples() < target_samples() && goes_on()) {
        auto next = static_cast<uint32_t>(
            std::min<uint64_t>(std::bit_ceil(static_cast<uint64_t>(renderer.samples()) + 1), target_samples()));
        if (verdict()) next = std::min(next, verdict()->next_samples());
        renderer.set_dispatch_seconds(std::max(seconds - elapsed, 0.1 * seconds));
        const bool is_complete = !renderer.advance(next);
        elapsed = seconds_since(start);
        if (is_complete && build_->denoiser) show_filtered(next);
        if (is_complete && reduction_ == 1) take_snapshots(next, seconds_ + elapsed);
    }
    seconds_ += elapsed;
    const double pixels = static_cast<double>(renderer.film().width()) * renderer.film().height();
    if (elapsed > 0 && renderer.samples() > first_samples)
        paths_per_second_ = (renderer.samples() - first_samples) * pixels / elapsed;
}

// Filtering takes time: the picture is filtered anew whenever its samples have doubled.
void Session::show_filtered(uint32_t samples) {
    if (!std::has_single_bit(samples) && samples != target_samples()) return;
    FilmHeader ignored;
    build_->filtered->write(read_picture(ignored));
}

// The picture as it is now, filtered if there is a filter and there are enough samples for it.
FilmImage Session::read_picture(FilmHeader& header) {
    FilmImage film = build_->renderer->film().read();
    if (!build_->denoiser) return film;
    build_->denoiser->keep(film);
    if (!build_->denoiser->can_filter(film)) return film;
    header.filter = build_->job.filter.name;
    return build_->denoiser->filter(film);
}

void Session::take_snapshots(uint32_t samples, double seconds) {
    // Reading the film back takes time: skip the first powers of two.
    constexpr double seconds_of_first_snapshot = 0.25;
    auto* live_verdict = std::get_if<LiveVerdict>(&verdict_);
    const bool is_for_verdict = live_verdict && samples == live_verdict->next_samples();
    const bool is_for_error =
        seconds > seconds_of_first_snapshot && (std::has_single_bit(samples) || samples == target_samples());
    if (!is_for_verdict && !is_for_error) return;
    FilmImage film = build_->renderer->film().read();
    if (is_for_verdict) live_verdict->add(film);
    if (!is_for_error) return;
    if (build_->denoiser && build_->denoiser->can_filter(film))  // show_filtered() has filtered it
        snapshot_.relative_error = estimate_filter_error(build_->filtered->read(), film).error.rel_rmse;
    else if (const auto error = estimate_error(film))
        snapshot_.relative_error = error->rel_rmse;
    snapshot_.film = std::move(film);
    snapshot_.header = header(seconds);
}

uint32_t Session::target_samples() const {
    return wanted_.appearance.sample_count.value_or(UINT32_MAX - build_->job.header.first_sample);
}

double Session::samples() const { return reduction_ == 1 ? build_->renderer->samples() : 0; }

std::optional<double> Session::relative_error() const {
    if (!snapshot_.relative_error || samples() <= 0) return std::nullopt;
    if (build_->denoiser) return snapshot_.relative_error;  // the picture that is shown
    return *snapshot_.relative_error * std::sqrt(snapshot_.film.min_samples() / samples());
}

void Session::save(const std::vector<std::filesystem::path>& files) {
    if (samples() < 1) {  // closed right away, or while the camera moved
        begin(1);
        while (build_->renderer->advance(1) && !is_interrupted()) {
        }
    }
    FilmHeader made = header(seconds_);
    const FilmImage film = read_picture(made);
    if (!film.exceeds(0)) throw UserError("stopped before the first sample: nothing was written");
    write(files, film, made);
}

void Session::write(const std::vector<std::filesystem::path>& files, const FilmImage& film, const FilmHeader& header) const {
    Options options = build_->job.options;
    options.appearance = wanted_.appearance;
    write_each(files, [&](const std::filesystem::path& file) { write_picture(file, film, header, options); });
}

FilmHeader Session::header(double seconds) const {
    FilmHeader header = build_->job.header;
    header.seconds += seconds;
    header.rays += rays();
    return header;
}

void Session::keep_snapshot_after(const std::exception& error, const std::vector<std::filesystem::path>& files) const {
    write_after_failure(error, snapshot_.film, [&] { write(files, snapshot_.film, snapshot_.header); });
}

std::unique_ptr<WindowBuild> make_window_build(const Device& device, const Chapter& chapter, RenderJob job, BuildStage first,
                                               const WindowBuild* before) {
    auto build = std::make_unique<WindowBuild>();
    // Hash before compiling, so that changes made meanwhile are noticed.
    build->shader_files = shader_files(job.estimator);
    build->shader_hash = hash_of(build->shader_files);
    job.estimator = with_limited_loops(std::move(job.estimator));
    static_cast<Build&>(*build) = make_build(device, chapter, std::move(job), first, before);
    const uvec2 size = build->job.parameters.image_size;
    std::shared_ptr<StorageImage> picture = before ? before->display->shared_picture() : nullptr;
    if (!picture || picture->width() != size.x || picture->height() != size.y)
        picture = std::make_shared<StorageImage>(device, size.x, size.y);
    if (build->denoiser) build->filtered = std::make_unique<Film>(device, size.x, size.y);
    build->display =
        std::make_unique<DisplayPass>(device, build->filtered ? *build->filtered : build->renderer->film(), std::move(picture));
    return build;
}

}  // namespace lab
