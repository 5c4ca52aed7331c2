#include "viewer/comparison.h"

#include <cmath>

#include "error.h"
#include "statistics/error_metrics.h"

namespace lab {
namespace {

// The options `own`, but with the scene and view of `shown`.
Options with_same_view(Options own, const Options& shown) {
    own.scene = shown.scene;
    own.image = shown.image;
    own.camera = shown.camera;
    own.light = shown.light;
    own.appearance = shown.appearance;
    return own;
}

}  // namespace

Comparison::Comparison(const Device& device) : device_(device), chapters_(chapter_folders()) {}

void Comparison::start(const Session& first, const std::string& chapter) {
    stop();
    Options options = first.options();
    if (chapter == first.chapter().name) {
        chapter_ = first.chapter();
    } else {
        try {
            chapter_ = load_chapter(chapter);
        } catch (const UserError& error) {
            message_ = error.what();
            return;
        }
        options.samples.chapter_values.assign(chapter_.options.size(), std::nullopt);
        const auto& strategies = chapter_.strategies;
        if (options.estimator.strategy &&
            std::find(strategies.begin(), strategies.end(), *options.estimator.strategy) == strategies.end())
            options.estimator.strategy.reset();
        options.estimator.choices.clear();
    }
    // With equal random numbers, differences would look smaller than they are.
    ++options.samples.seed;
    options.run.resume.clear();
    work_.start([&device = device_, of = chapter_, options, scene = first.build().job.scene] {
        return make_window_build(device, of, make_job(of, options, scene));
    });
}

void Comparison::stop() {
    work_.abandon();
    if (second_) ending_.push_back(std::move(second_));
    message_.clear();
}

void Comparison::adopt_finished_build() {
    if (!work_.is_done()) return;
    try {
        second_ = std::make_unique<Session>(device_, chapter_, work_.take());
    } catch (const std::exception& error) {
        message_ = window_message(error);
    }
}

void Comparison::update(Session& first, double seconds, bool is_moving) {
    const bool had_second = is_active();
    adopt_finished_build();
    std::erase_if(ending_, [](const auto& session) { return session->can_end(); });
    first.waits = false;
    if (!second_) return first.update(seconds, is_moving);
    if (!had_second) first.restart();  // start both at the same time
    second_->change(with_same_view(second_->options(), first.options()));
    second_->is_paused = first.is_paused;
    const auto progress = [&](const Session& session) { return equal == Equal::time ? session.seconds() : session.samples(); };
    // Reduced pictures are about to be replaced.
    const bool are_complete = first.reduction() == 1 && second_->reduction() == 1 && !first.is_stuck() && !second_->is_stuck();
    first.waits = are_complete && progress(first) > progress(*second_);
    second_->waits = are_complete && progress(*second_) > progress(first);
    const bool is_one_waiting = first.waits || second_->waits;
    first.update(is_one_waiting ? seconds : 0.5 * seconds, is_moving);
    second_->update(is_one_waiting ? seconds : 0.5 * seconds, is_moving);
}

std::vector<Layer> Comparison::layers(const Session& first, const Rectangle& where) const {
    const auto layer = [&](const Session& session, float from, float to) {
        return Layer{.pass = session.build().display.get(),
                     .transform = session.build().job.options.image.display(),
                     .exposure = session.options().appearance.exposure,
                     .where = where,
                     .from = from,
                     .to = to};
    };
    if (!second_) return {layer(first, 0, 1)};
    return {layer(first, 0, split), layer(*second_, split, 1)};
}

std::optional<Difference> Comparison::difference(const Session& first) const {
    if (!second_ || first.last_snapshot().min_samples() < 2) return std::nullopt;
    // Images of different sizes are about to be replaced.
    const FilmImage &a = first.last_snapshot(), &b = second_->last_snapshot();
    if (a.pixels.size() != b.pixels.size()) return std::nullopt;
    const glm::uvec2 size(a.width, a.height);
    const NoiseEstimate noise_a = estimate_noise(a, {0, 0}, size), noise_b = estimate_noise(b, {0, 0}, size);
    const auto mean = [](const NoiseEstimate& noise) { return (noise.mean[0] + noise.mean[1] + noise.mean[2]) / 3; };
    if (!(mean(noise_b) > 0)) return std::nullopt;
    // Pixels are independent; the channels of a pixel are not.
    const double pixels = static_cast<double>(a.pixels.size());
    const Difference difference{mean(noise_a) - mean(noise_b),
                                std::hypot(noise_a.standard_error, noise_b.standard_error) / std::sqrt(pixels), pixels};
    return difference.relative_to(mean(noise_b));
}

std::optional<double> Comparison::speedup(const Session& first) const {
    if (!second_) return std::nullopt;
    const auto error_a = first.relative_error(), error_b = second_->relative_error();
    if (!error_a || !error_b) return std::nullopt;
    // The squared error falls like 1/time.
    return *error_b * *error_b * second_->seconds() / (*error_a * *error_a * first.seconds());
}

}  // namespace lab
