// A second render beside the window's: another chapter, or the same with other settings.
#pragma once
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

// What both renders get the same of.
enum class Equal { time, samples };

class Comparison {
  public:
    explicit Comparison(const Device& device);

    const std::vector<std::string>& chapters() const { return chapters_; }  // names of their folders

    // Starts the second render of what the first one shows, with the settings that it has now, by this
    // chapter.
    void start(const Session& first, const std::string& chapter);
    void stop();  // waits for nothing
    bool is_active() const { return second_ != nullptr; }
    bool is_building() const { return work_.is_under_way(); }
    const std::string& message() const { return message_; }  // why there is no second render; may be empty
    const Session& second() const { return *second_; }

    // One frame's work of both within about so many seconds. The second one follows the first in scene,
    // camera and path length, and in what is seen of it; the one that is ahead waits.
    void update(Session& first, double seconds, bool is_moving);

    Equal equal = Equal::time;
    float split = 0.5f;  // the first render fills this part of the picture's width, the second one the rest

    // Both pictures in this rectangle.
    std::vector<Layer> layers(const Session& first, const Rectangle& where) const;

    // Mean of the first image minus that of the second, as part of the latter, with its standard error; none
    // without enough samples.
    std::optional<Difference> difference(const Session& first) const;
    // How many times longer the second render takes to the error of the first; none while an error is
    // unknown.
    std::optional<double> speedup(const Session& first) const;

  private:
    void adopt_finished_build();

    const Device& device_;
    std::vector<std::string> chapters_;
    Chapter chapter_;  // of the second render
    std::unique_ptr<Session> second_;
    BackgroundWork<std::unique_ptr<WindowBuild>> work_;
    std::vector<std::unique_ptr<Session>> ending_;  // former second renders, until their builds are done
    std::string message_;
};

}  // namespace lab
