#include "inspection/recording_calls.h"

#include <cctype>
#include <string_view>

#include "gpu/shader_editor.h"

namespace lab {
namespace {

class Scanner : ShaderEditor {
  public:
    using ShaderEditor::ShaderEditor;

    std::string run() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (const size_t skipped = comment_or_directive(at_); skipped > 0) {
                copy(skipped);
            } else if (is_word(c)) {
                if (!(begins_statement_ && copy_recorded_statement())) copy_word();
            } else {
                if (c == '(') ++parentheses_;
                if (c == ')') --parentheses_;
                if (c == '{') ++braces_;
                if (c == '}') --braces_;
                if (!std::isspace(static_cast<unsigned char>(c)))
                    begins_statement_ = parentheses_ == 0 && std::string_view("{};)").find(c) != std::string::npos;
                copy(1);
            }
        }
        return result_;
    }

  private:
    void copy_word() {
        const std::string_view word = word_at(at_);
        copy(word.size());
        begins_statement_ = word == "else" || word == "do";
    }

    // The variable that a statement here starts with, or a member to be recorded, like path.throughput.
    std::string_view variable_at(size_t at) const {
        const std::string_view word = word_at(at);
        const size_t dot = at + word.size();
        if (dot >= text_.size() || text_[dot] != '.') return word;
        const std::string_view member = word_at(dot + 1);
        if (member != "throughput" && member != "radiance") return word;
        return std::string_view(text_).substr(at, word.size() + 1 + member.size());
    }

    // Length up to the semicolon, or 0 if the block ends before one.
    size_t statement_length(size_t at) const {
        for (size_t end = at; end < text_.size();) {
            if (const size_t skipped = comment_or_directive(end)) {
                end += skipped;
                continue;
            }
            if (text_[end] == '{' || text_[end] == '}') return 0;
            if (text_[end++] == ';') return end - at;
        }
        return 0;
    }

    // Copies the statement that starts here, with its recording call, if it is to be recorded.
    bool copy_recorded_statement() {
        if (braces_ == 0) return false;
        const std::string_view first = word_at(at_);
        std::string_view variable = variable_at(at_);
        const bool is_declaration = first == "vec3" || first == "float";
        if (is_declaration) {
            const size_t name = skip_space(at_ + first.size());
            variable = word_at(name);
            if (first == "float" && variable == "flight") has_flight_ = true;
            const size_t after = skip_space(name + variable.size());
            if (after >= text_.size() || text_[after] != '=') return false;
        }
        const std::string call = recording_call(variable, is_declaration);
        const size_t length = call.empty() ? 0 : statement_length(at_);
        if (length == 0) return false;
        // In braces, since the statement may be the whole body of an if.
        if (!is_declaration) result_ += "{ ";
        copy(length);
        result_ += call;
        if (!is_declaration) result_ += " }";
        begins_statement_ = true;
        return true;
    }

    std::string recording_call(std::string_view variable, bool is_declaration) {
        const std::string starts = is_declaration ? "_STARTS, " : ", ", expression(variable);
        const std::string_view name = variable.substr(variable.find('.') + 1);
        if (name == "throughput") return " record_throughput(EVENT_THROUGHPUT" + starts + expression + ");";
        if (name == "radiance") {
            if (is_declaration) ++radiances_;
            const int number = name == variable ? radiances_ : 0;
            if (name == variable && number == 0) return "";  // not declared by the estimator
            return " record_radiance(EVENT_RADIANCE" + starts + expression + ", " + std::to_string(number) + "u);";
        }
        if (variable == "survival_probability" && is_declaration) return " record_survival(survival_probability);";
        if (name == variable && name == "flight" && has_flight_) return " record_flight(flight);";
        return "";
    }

    bool begins_statement_ = false;
    int parentheses_ = 0, braces_ = 0;
    int radiances_ = 0;        // declared so far
    bool has_flight_ = false;  // declared as a float
};

}  // namespace

std::string add_recording_calls(const std::string& text) { return Scanner(text).run(); }

}  // namespace lab
