// What the JavaScript of the book's pages answers, to be compared with the same in C++.
#pragma once
#include <sys/wait.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "files/project_folder.h"
#include "tests/support/temporary_folder.h"

namespace lab {

inline bool has_node() { return WEXITSTATUS(std::system("node --version > /dev/null 2>&1")) == 0; }

// What tests/browser/SCRIPT.js prints about a task; null if it fails.
inline nlohmann::json answer_of_page(const std::string& script, const nlohmann::json& task) {
    const TemporaryFolder folder;
    const auto question = folder.path() / "task.json", answer = folder.path() / "answer.json";
    std::ofstream(question) << task.dump();
    const std::string root = project_folder().string();
    const std::string command = "node '" + root + "/tests/browser/" + script + ".js' '" + root + "/tools/book/live' < '" +
                                question.string() + "' > '" + answer.string() + "'";
    if (std::system(command.c_str()) != 0) return {};
    return nlohmann::json::parse(std::ifstream(answer));
}

}  // namespace lab
