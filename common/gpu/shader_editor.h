// Copies the text of a shader bit by bit, so that something can be inserted on the way.
#pragma once
#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace lab {

class ShaderEditor {
  public:
    explicit ShaderEditor(const std::string& text) : text_(text) {}

  protected:
    static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

    void copy(size_t count) {
        result_.append(text_, at_, count);
        at_ += count;
    }

    std::string_view word_at(size_t at) const {
        size_t end = at;
        while (end < text_.size() && is_word(text_[end])) ++end;
        return std::string_view(text_).substr(at, end - at);
    }

    size_t skip_space(size_t at) const {
        while (at < text_.size() && std::isspace(static_cast<unsigned char>(text_[at]))) ++at;
        return at;
    }

    // Length of the comment or preprocessor line that starts here, or 0.
    size_t comment_or_directive(size_t at) const {
        const std::string_view rest = std::string_view(text_).substr(at);
        if (rest.starts_with("//") || rest.starts_with("#")) return std::min(rest.find('\n'), rest.size());
        if (rest.starts_with("/*")) return std::min(rest.find("*/"), rest.size() - 2) + 2;
        return 0;
    }

    const std::string& text_;
    std::string result_;
    size_t at_ = 0;  // what has been copied
};

}  // namespace lab
