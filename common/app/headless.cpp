#include "app/headless.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "app/progress.h"
#include "clock.h"
#include "error.h"
#include "rendering/interrupt.h"
#include "rendering/numbers_text.h"
#include "rendering/outputs.h"

namespace lab {
namespace {

class HeadlessRender {
  public:
    HeadlessRender(const RenderJob& job, Renderer& renderer)
        : job_(job), options_(*job.options), renderer_(renderer), last_save_(start_) {
        if (!options_.reference.empty()) {
            reference_ = read_reference(options_.reference);
            const Image& image = reference_->mean;
            if (image.width != renderer.film().width() || image.height != renderer.film().height())
                throw UserError(options_.reference.string() + ": has " + std::to_string(image.width) + "x" +
                                std::to_string(image.height) + " pixels, the image has " +
                                std::to_string(renderer.film().width()) + "x" +
                                std::to_string(renderer.film().height()) + ": they must agree");
        }
        if (job.resumed) renderer.resume(job.resumed->image);
        snapshot_ = renderer.film().read();
        last_row_film_ = snapshot_;
    }

    void run() {
        install_interrupt_handler();
        // If the device fails, what was last read from it is all there is.
        const auto keep = [&](const std::string& why) {
            if (snapshot_.min_samples() == 0 && snapshot_.has_equal_sample_counts())
                throw DeviceFailure(why + ": there was nothing to write yet");
            try {
                write_outputs();
            } catch (const UserError& error) {
                throw DeviceFailure(why + "; " + error.what());
            }
            throw DeviceFailure(why + ": the outputs hold " + std::to_string(snapshot_.min_samples()) +
                                " samples a pixel; --resume continues");
        };
        try {
            sample();
            snapshot_ = renderer_.film().read();
        } catch (const vk::SystemError& error) {
            keep(std::string("the device failed: ") + error.what());
        } catch (const DeviceFailure& error) {
            keep(error.what());
        } catch (const std::bad_alloc&) {
            keep("out of memory");
        }
        if (renderer_.samples() == 0) throw UserError("stopped before the first sample: nothing was written");
        write_outputs();
        if (!options_.quiet)
            print_summary();
        else if (snapshot_.invalid_samples() > 0)  // never silent
            std::fprintf(stderr, "note: %s\n", invalid_samples_text().c_str());
    }

  private:
    // Stops at 1, 2, 4, … samples for a row of the report: errors are compared at powers of two, and a test
    // for the target error at every dispatch would prefer images that look converged by chance.
    void sample() {
        Progress progress(job_.samples, renderer_.samples(), options_.quiet);
        uint32_t done = snapshot_.min_samples();
        while (done < job_.samples && !is_interrupted()) {
            uint32_t next = 1;
            while (next <= done) next = next > job_.samples / 2 ? job_.samples : 2 * next;
            next = std::min(next, job_.samples);
            bool more = true;
            while (more && !is_interrupted() && !is_time_over()) {
                more = renderer_.advance(next);
                progress.update(renderer_.samples(), renderer_.rays());
                save_if_due();
            }
            if (more) return;
            done = next;
            add_row(done);
            if (is_accurate()) return;
        }
    }

    double seconds() const { return job_.record.seconds + seconds_since(start_); }

    bool is_time_over() const {
        return options_.time_limit && renderer_.samples() > 0 &&
               seconds() - job_.record.seconds >= *options_.time_limit;
    }

    bool is_accurate() const {
        return options_.target_error && !rows_.empty() && rows_.back().error &&
               std::sqrt(rows_.back().error->rel_mse) <= *options_.target_error;
    }

    void save_if_due() {
        // A snapshot is also what remains if the device is lost.
        constexpr double seconds_between_snapshots = 10;
        const double interval = options_.save_every.value_or(seconds_between_snapshots);
        if (seconds_since(last_save_) < interval) return;
        last_save_ = std::chrono::steady_clock::now();
        snapshot_ = renderer_.film().read();
        if (!options_.save_every) return;
        try {
            write_outputs();
        } catch (const UserError& error) {
            // The disk may have room again when the render ends.
            std::fprintf(stderr, "\nnote: %s\n", error.what());
        }
    }

    void add_row(uint32_t samples) {
        if (options_.report.empty() && !options_.target_error && samples < job_.samples) return;
        ReportRow row{.samples = samples,
                      .seconds = seconds(),
                      .device_seconds = renderer_.device_seconds(),
                      .rays = job_.record.rays + renderer_.rays(),
                      .error = std::nullopt};
        const FilmImage film = renderer_.film().read();
        row.mean = film.mean_radiance();
        if (reference_) {
            row.error = compare(film.mean(), *reference_);
        } else if (const uint32_t before = last_row_film_.min_samples();
                   before > 0 && samples == 2 * before) {
            row.error = estimate_error(last_row_film_.mean(), samples_after(last_row_film_, film).mean());
        }
        rows_.push_back(row);
        last_row_film_ = film;
        snapshot_ = film;
    }

    void write_outputs() {
        FilmRecord record = job_.record;
        record.seconds = seconds();
        record.rays += renderer_.rays();
        auto files = options_.outputs;
        if (!options_.report.empty()) files.push_back(options_.report);
        write_each(files, [&](const std::filesystem::path& file) {
            if (file == options_.report)
                write_report(file, snapshot_, record, job_.acceleration,
                             reference_ ? ErrorSource::reference : ErrorSource::halves, rows_);
            else
                write_picture(file, snapshot_, record, options_);
        });
    }

    double paths() const {
        double paths = 0;
        for (const auto& pixel : snapshot_.pixels) paths += pixel.sample_count;
        return paths;
    }

    std::string invalid_samples_text() const {
        return std::to_string(snapshot_.invalid_samples()) + " of " + short_number(paths()) +
               " samples infinite or not a number: they count as 0 and their pixels are magenta";
    }

    void print_summary() const {
        const auto mean = snapshot_.mean_radiance();
        const double new_seconds = seconds() - job_.record.seconds;
        std::printf("mean radiance  %.5g %.5g %.5g (red, green, blue)\n", mean[0], mean[1], mean[2]);
        std::printf("samples        %u a pixel, %s paths%s\n", snapshot_.min_samples(),
                    short_number(paths()).c_str(),
                    snapshot_.min_samples() < job_.samples ? " (stopped early; --resume continues)" : "");
        std::printf(
            "time           %s, %s rays/s\n", duration_text(new_seconds).c_str(),
            short_number(static_cast<double>(renderer_.rays()) / std::max(new_seconds, 1e-9)).c_str());
        std::printf("acceleration   structure of %s bytes, built in %s\n",
                    short_number(static_cast<double>(job_.acceleration.bytes)).c_str(),
                    duration_text(job_.acceleration.build_seconds).c_str());
        if (!rows_.empty() && rows_.back().error)
            std::printf("error          %.3g %% (root of the relative mean squared error, %s)\n",
                        100 * std::sqrt(rows_.back().error->rel_mse),
                        reference_ ? "against the reference" : "estimated");
        if (snapshot_.invalid_samples() > 0)
            std::printf("invalid        %s\n", invalid_samples_text().c_str());
        for (const auto& file : options_.outputs) std::printf("picture        %s\n", file.string().c_str());
        if (!options_.report.empty()) std::printf("report         %s\n", options_.report.string().c_str());
    }

    RenderJob job_;
    const Options& options_;
    Renderer& renderer_;
    std::optional<Reference> reference_;
    FilmImage snapshot_;       // last read from the device
    FilmImage last_row_film_;  // at the last row of the report
    std::vector<ReportRow> rows_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point last_save_;
};

}  // namespace

void render_headless(const Device& device, const AccelerationStructure& acceleration_structure,
                     const Estimator& estimator, const RenderJob& job) {
    Renderer renderer(device, acceleration_structure, estimator, job.parameters);
    HeadlessRender(job, renderer).run();
}

}  // namespace lab
