// A second render next to the first: another chapter, or the same one with other settings.
#pragma once
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

// What both renders get the same amount of.
enum class Equal { time, samples };

class Comparison {
  public:
    explicit Comparison(const Device& device);

    const std::vector<std::string>& chapters() const { return chapters_; }  // names of their folders

    // Starts a second render, by this chapter, with the first one's view and current settings.
    void start(const Session& first, const std::string& chapter);
    void stop();  // without waiting
    bool is_active() const { return second_ != nullptr; }
    bool is_building() const { return work_.is_under_way(); }
    const std::string& message() const { return message_; }  // why there is no second render, or empty
    const Session& second() const { return *second_; }

    // Does one frame's work on both renders in about this many seconds. The second one follows the first in scene, camera, path
    // length and view; whichever is ahead waits.
    void update(Session& first, double seconds, bool is_moving);

    Equal equal = Equal::time;
    float split = 0.5f;  // fraction of the picture's width for the first render

    // Both pictures inside this rectangle.
    std::vector<Layer> layers(const Session& first, const Rectangle& where) const;

    // Mean of the first image minus that of the second, relative to the latter; empty without enough samples.
    std::optional<Difference> difference(const Session& first) const;
    // Ratio of the times to equal error, second to first; empty while an error is unknown.
    std::optional<double> speedup(const Session& first) const;

  private:
    void adopt_finished_build();

    const Device& device_;
    std::vector<std::string> chapters_;
    Chapter chapter_;  // of the second render
    std::unique_ptr<Session> second_;
    BackgroundWork<std::unique_ptr<WindowBuild>> work_;
    std::vector<std::unique_ptr<Session>> ending_;  // former second renders whose builds are still running
    std::string message_;
};

}  // namespace lab
