#include "tracing/limited_loops.h"

#include "files/file.h"
#include "files/project_folder.h"
#include "gpu/shader_editor.h"

namespace lab {
namespace {

// A place in a number: the line, and above it a part of the file's hash.
constexpr uint32_t line_bits = 16;
constexpr uint32_t last_line = (1u << line_bits) - 1;

uint32_t file_bits(const std::string& file) { return static_cast<uint32_t>(hash_text(file)) << line_bits; }

class LoopLimiter : ShaderEditor {
  public:
    using ShaderEditor::ShaderEditor;

    std::string run() {
        while (at_ < text_.size()) {
            const std::string_view rest = std::string_view(text_).substr(at_);
            if (rest.starts_with("#line ")) read_line_directive(rest.substr(0, rest.find('\n')));
            if (rest.starts_with("#define"))
                limit_directive();
            else if (const size_t skipped = comment_or_directive(at_); skipped > 0)
                copy(skipped);
            else if (is_word(text_[at_]))
                copy_word();
            else
                copy(1);
        }
        return result_;
    }

  private:
    // #line 12 "file", as the compiler of shaders inserts it
    void read_line_directive(std::string_view directive) {
        first_line_ = static_cast<size_t>(std::strtoul(directive.data() + 6, nullptr, 10));
        line_start_ = at_ + directive.size() + 1;
        const size_t quote = directive.find('"');
        if (quote != std::string_view::npos) set_file(directive.substr(quote + 1, directive.rfind('"') - quote - 1));
    }

    void set_file(const std::filesystem::path& file) {
        const std::filesystem::path real = std::filesystem::weakly_canonical(file);
        file_ = real.generic_string();
        is_limited_ = std::mismatch(shared_.begin(), shared_.end(), real.begin(), real.end()).first != shared_.end();
    }

    // A macro may hold a whole head of a loop, but nothing outside of it belongs to that.
    void limit_directive() {
        size_t end = at_;
        do end = std::min(text_.find('\n', end + 1), text_.size());
        while (end < text_.size() && text_[end - 1] == '\\');
        const size_t whole = std::exchange(end_, end);
        copy(1);
        while (at_ < end) is_word(text_[at_]) ? copy_word() : copy(1);
        end_ = whole;
    }

    void copy_word() {
        const std::string_view word = word_at(at_);
        copy(word.size());
        if ((word != "for" && word != "while") || !is_limited_) return;
        const size_t open = skip_space_and_comments(at_), close = closing_parenthesis(open);
        if (close == 0) return;
        const std::string is_stuck = "is_loop_stuck(" + std::to_string(place()) + "u)";
        // Behind the head of a `do` nothing can follow, so that the condition is extended. A variable can be declared in that of
        // a `while` alone.
        if (word == "for" || word_at(skip_space_and_comments(open + 1)) == "bool") {
            copy(close + 1 - at_);
            result_ += " if (" + is_stuck + ") break; else";
        } else {
            copy(open + 1 - at_);
            result_ += "!" + is_stuck + " && (";
            copy(close - at_);
            result_ += ")";
        }
    }

    size_t skip_space_and_comments(size_t at) const {
        for (at = skip_space(at); at < end_ && text_[at] == '/' && comment_or_directive(at) > 0; at = skip_space(at))
            at += comment_or_directive(at);
        return at;
    }

    // Where the parenthesis closes that opens here; 0 if there is none.
    size_t closing_parenthesis(size_t at) const {
        if (at >= end_ || text_[at] != '(') return 0;
        for (int depth = 0; at < end_;) {
            if (const size_t skipped = comment_or_directive(at); skipped > 0) {
                at += skipped;
                continue;
            }
            if (text_[at] == '(') ++depth;
            if (text_[at] == ')' && --depth == 0) return at;
            ++at;
        }
        return 0;
    }

    uint32_t place() const {
        const auto start = text_.begin() + static_cast<std::ptrdiff_t>(std::min(line_start_, at_));
        const size_t line = first_line_ + std::count(start, text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
        return file_bits(file_) | static_cast<uint32_t>(std::min<size_t>(line, last_line));
    }

    const std::filesystem::path shared_ = std::filesystem::weakly_canonical(project_folder() / "shaders");
    std::string file_;  // of the text at this place
    bool is_limited_ = false;
    size_t first_line_ = 0, line_start_ = 0;
    size_t end_ = text_.size();  // of what belongs together
};

}  // namespace

std::string limit_loops(const std::string& text) { return LoopLimiter(text).run(); }

Estimator with_limited_loops(Estimator estimator) {
    estimator.defines.emplace_back("LIMITED_LOOPS");
    estimator.edit = [before = estimator.edit](const std::string& text) { return limit_loops(before ? before(text) : text); };
    return estimator;
}

void check_loops(std::span<const uint32_t> ray_counters, const Estimator& estimator) {
    const uint32_t place = ray_counters[RAY_COUNTER_COUNT];
    if (place == 0) return;
    std::string where;
    for (const auto& file : shader_files(estimator))
        if (const std::string name = file.generic_string(); file_bits(name) == (place & ~last_line))
            where = name + ":" + std::to_string(place & last_line) + ": ";
    throw StuckLoop(where + "this loop, or one around it, does not end: it needs a condition that becomes false, or a break");
}

}  // namespace lab
