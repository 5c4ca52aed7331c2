// A folder that exists while a test needs it.
#pragma once
#include <atomic>
#include <filesystem>
#include <string>

#include "platform.h"

namespace lab {

// A new empty folder in `parent`, removed with its contents when it goes out of scope.
class TemporaryFolder {
  public:
    explicit TemporaryFolder(const std::filesystem::path& parent = std::filesystem::temp_directory_path()) {
        static std::atomic<int> count = 0;
        do path_ = parent / ("lab_test_" + std::to_string(process_id()) + "_" + std::to_string(count++));
        while (!std::filesystem::create_directory(path_));
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace lab
