// A second render beside the first: another chapter, or the same with other settings.
#pragma once
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

// What both renders have in common.
enum class Equal { time, samples };

class Comparison {
  public:
    explicit Comparison(const Device& device);

    const std::vector<std::string>& chapters() const { return chapters_; }  // names of their folders

    // Starts a second render of the first one's view and current settings, by this chapter.
    void start(const Session& first, const std::string& chapter);
    void stop();  // without waiting
    bool is_active() const { return second_ != nullptr; }
    bool is_building() const { return work_.is_under_way(); }
    const std::string& message() const { return message_; }  // why there is no second render, or empty
    const Session& second() const { return *second_; }

    // Does a frame's work of both in about so many seconds. The second follows the first in scene, camera, path length and view;
    // the one that is ahead waits.
    void update(Session& first, double seconds, bool is_moving);

    Equal equal = Equal::time;
    float split = 0.5f;  // fraction of the picture's width for the first render

    // Both pictures in this rectangle.
    std::vector<Layer> layers(const Session& first, const Rectangle& where) const;

    // Mean of the first image minus that of the second, relative to the latter; none without enough samples.
    std::optional<Difference> difference(const Session& first) const;
    // Ratio of times to equal error, second to first; none while an error is unknown.
    std::optional<double> speedup(const Session& first) const;

  private:
    void adopt_finished_build();

    const Device& device_;
    std::vector<std::string> chapters_;
    Chapter chapter_;  // of the second render
    std::unique_ptr<Session> second_;
    BackgroundWork<std::unique_ptr<WindowBuild>> work_;
    std::vector<std::unique_ptr<Session>> ending_;  // former second renders whose builds still run
    std::string message_;
};

}  // namespace lab
