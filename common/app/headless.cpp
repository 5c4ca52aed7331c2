#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/run_chapter.h"
#include "clock.h"
#include "error.h"
#include "platform.h"
#include "rendering/build.h"
#include "rendering/numbers_text.h"
#include "rendering/outputs.h"
#include "rendering/scene_reference.h"

namespace lab {
namespace {

// Prints the progress of a render to the terminal.
class Progress {
  public:
    // In samples per pixel. With `quiet` nothing is printed.
    Progress(uint32_t target_samples, double first_samples, bool quiet)
        : target_samples_(target_samples), first_samples_(first_samples), quiet_(quiet) {}
    ~Progress() {
        if (printed_ && terminal_) std::fputs("\r\033[K", stderr);
    }

    // `samples` per pixel and `rays`, both of this run so far. Prints a few times per second.
    void update(double samples, uint64_t rays) {
        // Log files get a line every ten seconds, terminals one line that is overwritten.
        if (quiet_ || seconds_since(last_) < (terminal_ ? 0.2 : 10.0)) return;
        last_ = Clock::now();
        const double seconds = seconds_since(start_);
        const double rate = (samples - first_samples_) / seconds;
        const double fraction = std::min(samples / target_samples_, 1.0);
        constexpr int bar_width = 24;
        const int filled = static_cast<int>(fraction * bar_width);
        std::fprintf(stderr, "%s[%s%s] %.4g/%u samples  %s samples/s  %s rays/s  %s left%s", terminal_ ? "\r\033[K" : "",
                     std::string(filled, '#').c_str(), std::string(bar_width - filled, '.').c_str(), samples, target_samples_,
                     short_number(rate).c_str(), short_number(static_cast<double>(rays) / seconds).c_str(),
                     rate > 0 ? duration_text((target_samples_ - samples) / rate).c_str() : "?", terminal_ ? "" : "\n");
        std::fflush(stderr);
        printed_ = true;
    }

  private:
    const uint32_t target_samples_;
    const double first_samples_;
    const bool quiet_;
    const bool terminal_ = is_terminal(stderr);
    bool printed_ = false;
    const Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

class HeadlessRender {
  public:
    explicit HeadlessRender(Build& build)
        : job_(build.job),
          options_(job_.options.run),
          renderer_(*build.renderer),
          denoiser_(build.denoiser.get()),
          scene_backend_(*build.scene_backend) {
        if (!options_.reference.empty()) {
            reference_ = read_reference(options_.reference);
            const uvec2 size(reference_->mean.width, reference_->mean.height);
            if (size != job_.parameters.image_size)
                throw UserError(options_.reference.string() + ": has " + size_text(size) + " pixels, the image has " +
                                size_text(job_.parameters.image_size) + ": they must agree");
            const std::string difference = mismatch(*reference_, job_);
            if (!difference.empty() && !options_.quiet)
                std::fprintf(stderr, "note: %s: %s\n", options_.reference.string().c_str(), difference.c_str());
        }
        if (!job_.resumed) return;
        take_snapshot();
        if (denoiser_) denoiser_->keep(snapshot_);
    }

    void run() {
        install_interrupt_handler();
        start_ = last_save_ = Clock::now();
        unmeasured_cpu_seconds_ = processor_seconds();
        try {
            sample();
        } catch (const std::exception& error) {
            // Only the last snapshot is left.
            write_after_failure(error, snapshot_, [&] { write_outputs(); });
        }
        // A student's loop may finish no sample at all: its picture is black.
        if (is_interrupted() && !snapshot_.exceeds(0)) throw UserError("stopped before the first sample: nothing was written");
        filter_snapshot();
        write_outputs();
        remove_interrupt_handler();
        if (!options_.quiet)
            print_summary();
        else if (picture().invalid_samples() > 0)  // never silent
            std::fprintf(stderr, "note: %s\n", invalid_samples_text().c_str());
    }

  private:
    // Ends with a snapshot of everything that was rendered.
    void sample() {
        Progress progress(job_.samples, renderer_.samples(), options_.quiet);
        uint32_t done = snapshot_.min_samples();
        while (done < job_.samples) {
            const uint32_t next = next_sample_count(done, job_.samples, growth());
            for (bool more = true; more;) {
                if (is_interrupted() || is_time_over()) return take_snapshot();
                more = renderer_.advance(next);
                progress.update(renderer_.samples(), renderer_.rays());
                save_if_due();
            }
            done = next;
            if (!options_.report.empty() || options_.target_error || done == job_.samples)
                add_row(done);
            else if (denoiser_)
                take_snapshot();
            if (is_accurate()) return;
            if (denoiser_) denoiser_->keep(snapshot_);
        }
    }

    // Rendering time as the user sees it, earlier runs included.
    double seconds() const { return job_.header.seconds + seconds_since(start_) - measuring_seconds_ - saving_seconds_; }

    bool is_time_over() const {
        return options_.time_limit && renderer_.samples() > 0 &&
               seconds_since(start_) - measuring_seconds_ >= *options_.time_limit;
    }

    // The factor by which the sample count must grow to reach the target error, at the rate of random sampling.
    double growth() const {
        if (!options_.target_error || rows_.empty() || !rows_.back().error) return 2;
        return std::pow(rows_.back().error->rel_rmse / *options_.target_error, 2);
    }

    bool is_accurate() const { return growth() <= 1; }

    void save_if_due() {
        // If the device is lost, the last snapshot is what remains.
        constexpr double seconds_between_snapshots = 10;
        // Rendering gets at least half of the time, however slow the disk is.
        if (seconds_since(last_save_) < std::max(options_.save_every.value_or(seconds_between_snapshots), last_save_seconds_))
            return;
        const auto start = Clock::now();
        const double cpu_start = processor_seconds();
        take_snapshot();
        if (options_.save_every) try {
                filter_snapshot();
                write_outputs();
            } catch (const UserError& error) {
                // By the time the render ends the disk may have room again.
                std::fprintf(stderr, "\nnote: %s\n", error.what());
            }
        last_save_ = Clock::now();
        last_save_seconds_ = seconds_since(start);
        saving_seconds_ += last_save_seconds_;
        unmeasured_cpu_seconds_ += processor_seconds() - cpu_start;
    }

    // Reads the film back, so that something is left if the device is lost.
    void take_snapshot() {
        const double seconds_so_far = seconds();
        snapshot_ = renderer_.film().read();
        header_ = job_.header;
        header_.seconds = seconds_so_far;
        header_.rays += renderer_.rays();
        if (denoiser_) header_.shows.clear();  // until it is filtered
        filtered_.reset();
        filter_error_.reset();
    }

    // Makes the filtered picture of the snapshot, if --filter asks for it. What remains after a failure is not filtered.
    void filter_snapshot() {
        if (!denoiser_ || filtered_ || !denoiser_->can_filter(snapshot_)) return;
        filtered_ = denoiser_->filter(snapshot_);
        filter_error_ =
            reference_ ? measure_filter_error(*filtered_, snapshot_, *reference_) : estimate_filter_error(*filtered_, snapshot_);
        header_.seconds += denoiser_->cost().seconds;
        header_.filter = job_.filter.name;
        header_.shows = job_.header.shows;
    }

    const FilmImage& picture() const { return filtered_ ? *filtered_ : snapshot_; }

    void add_row(uint32_t samples) {
        const auto start = Clock::now();
        const double cpu_start = processor_seconds();
        take_snapshot();
        filter_snapshot();
        const Denoiser::Cost filtering = filtered_ ? denoiser_->cost() : Denoiser::Cost{};
        rows_.push_back({.samples = samples,
                         .seconds = header_.seconds,
                         .device_seconds = renderer_.device_seconds() + filtering.device_seconds,
                         .cpu_seconds = cpu_start - unmeasured_cpu_seconds_ + filtering.cpu_seconds,
                         .rays = header_.rays,
                         .mean = picture().mean_radiance(),
                         .difference = picture().mean_difference(),
                         .error = find_error(),
                         .filter_error = filter_error_});
        measuring_seconds_ += seconds_since(start);
        unmeasured_cpu_seconds_ += processor_seconds() - cpu_start;
    }

    std::optional<ErrorMetrics> find_error() const {
        if (filter_error_) return filter_error_->error;
        return reference_ ? compare(snapshot_.mean(), *reference_) : estimate_error(snapshot_);
    }

    void write_outputs() {
        auto files = options_.outputs;
        if (!options_.report.empty()) files.push_back(options_.report);
        write_each(files, [&](const std::filesystem::path& file) {
            if (file == options_.report)
                write_report(file, picture(), header_, scene_backend_, reference_ ? ErrorSource::reference : ErrorSource::halves,
                             rows_);
            else
                write_picture(file, picture(), header_, job_.options);
        });
    }

    double paths() const { return static_cast<double>(snapshot_.sum(&FilmPixel::sample_count)); }

    std::string invalid_samples_text() const {
        return std::to_string(picture().invalid_samples()) + " of " + short_number(paths()) +
               " samples infinite or not a number: they count as 0 and their pixels are magenta";
    }

    void print_summary() const {
        const auto mean = picture().mean_radiance();
        const double new_seconds = header_.seconds - job_.header.seconds;
        const bool shows_radiance = job_.header.shows.empty(), shows_light = !job_.options.image.view;
        const bool is_last_row = !rows_.empty() && rows_.back().rays == header_.rays;
        const std::optional<ErrorMetrics> error = is_last_row ? rows_.back().error : find_error();
        // Pixels are independent. Against a reference the error would include bias.
        const bool is_spread = error && !reference_ && !filtered_;
        std::printf("%-15s%.5g %.5g %.5g", shows_radiance ? "mean radiance" : "mean", mean[0], mean[1], mean[2]);
        if (is_spread) std::printf(" ± %.2g", std::sqrt(error->mse / static_cast<double>(snapshot_.pixels.size())));
        std::printf(" (red, green, blue%s)\n", is_spread ? "; standard error, on average" : "");
        std::printf("samples        %u a pixel, %s paths%s\n", snapshot_.min_samples(), short_number(paths()).c_str(),
                    snapshot_.min_samples() >= job_.samples ? ""
                    : filtered_                             ? " (stopped early)"
                                                            : " (stopped early; --resume continues)");
        std::printf("time           %s, %s rays/s\n", duration_text(new_seconds).c_str(),
                    short_number(static_cast<double>(renderer_.rays()) / std::max(new_seconds, 1e-9)).c_str());
        std::printf("acceleration   structure of %s bytes, built in %s\n",
                    short_number(static_cast<double>(scene_backend_.bytes())).c_str(),
                    duration_text(scene_backend_.build_seconds()).c_str());
        if (filter_error_)
            std::printf(
                "%-15s%.3g %% (root of the relative mean squared error, %s): noise %.3g %%, bias %.3g %%; unfiltered %.3g %%\n",
                "error", 100 * error->rel_rmse, reference_ ? "against the reference" : "estimated from the halves",
                100 * std::sqrt(filter_error_->variance), 100 * std::sqrt(filter_error_->squared_bias()),
                100 * std::sqrt(filter_error_->unfiltered));
        else if (job_.filter.passes > 0)
            std::printf("filter         none: it needs %s\n", snapshot_.min_samples() < 4
                                                                  ? "four samples a pixel or more"
                                                                  : "two new samples a pixel or more: raise --samples");
        else if (error && shows_light)
            std::printf("%-15s%.3g %% (root of the relative mean squared error, %s)\n", reference_ ? "error" : "noise",
                        100 * error->rel_rmse, reference_ ? "against the reference" : "estimated; a bias does not show in it");
        if (picture().invalid_samples() > 0) std::printf("invalid        %s\n", invalid_samples_text().c_str());
        for (const auto& file : options_.outputs) std::printf("picture        %s\n", file.string().c_str());
        if (!options_.report.empty()) std::printf("report         %s\n", options_.report.string().c_str());
    }

    const RenderJob& job_;
    const RunOptions& options_;
    Renderer& renderer_;
    Denoiser* denoiser_;  // null without a filter
    const SceneBackend& scene_backend_;
    std::optional<Reference> reference_;
    FilmImage snapshot_;                      // read back last
    std::optional<FilmImage> filtered_ = {};  // of that snapshot, and its error
    std::optional<FilterError> filter_error_ = {};
    FilmHeader header_;  // of that snapshot
    std::vector<ReportRow> rows_;
    Clock::time_point start_ = Clock::now();  // of rendering
    Clock::time_point last_save_;             // when it ended
    double last_save_seconds_ = 0;            // how long it took
    double saving_seconds_ = 0;               // all of them
    double measuring_seconds_ = 0;            // spent on the report's rows
    double unmeasured_cpu_seconds_ = 0;       // spent on both and before rendering
};

}  // namespace

void render_headless(Build& build) { HeadlessRender(build).run(); }

}  // namespace lab
